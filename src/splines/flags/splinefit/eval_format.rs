//! What `splinefit eval` writes: the values of its flags, and the formats that endings of outputs stand for.

use std::path::Path;

use crate::splinefit::Attribute;
use spmesh_base::error::{Error, Result};
use spmesh_base::places::is_device;
use spmesh_formats::raster::RasterFormat;
use spmesh_formats::sink::MatrixFormat;
use spmesh_shell::{Names, cells, endings, of_ending};

/// Values of `--kind`.
pub(super) const KINDS: Names<Attribute> = &[
    ("value", Attribute::Value),
    ("slope", Attribute::Slope),
    ("aspect", Attribute::Aspect),
    ("profile-curvature", Attribute::ProfileCurvature),
    ("tangential-curvature", Attribute::TangentialCurvature),
    ("standard-error: The standard error of the value, with --points", Attribute::StandardError),
    ("prediction-error: The same, with the noise of a point", Attribute::PredictionError),
    ("interval: What holds 95 % of points there: lower, upper, with --points", Attribute::Interval),
    ("slope-error: The standard error of the slope, in degrees, with --points", Attribute::SlopeError),
    ("gradient: Both derivatives: dx, dy", Attribute::Gradient),
    ("hessian: The second derivatives: dxx, dxy, dyy", Attribute::Hessian),
];

/// Values of `--format`.
pub(super) const FORMATS: Names<Form> = &[
    ("tif", Form::Raster(RasterFormat::GeoTiff)),
    ("asc", Form::Raster(RasterFormat::Ascii)),
    ("npy", Form::Array),
    ("text", Form::Text),
    ("mtx", Form::Matrix(MatrixFormat::MatrixMarket)),
    ("npz", Form::Matrix(MatrixFormat::Npz)),
];

/// The form of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// A table.
    Text,
    /// An array of numpy.
    Array,
    Raster(RasterFormat),
    Matrix(MatrixFormat),
}

/// The form that `--format` asks for, or else the ending of the output.
pub(super) fn format_of(
    output: &Path,
    format: Option<Form>,
    has_sites: bool,
    is_collocation: bool,
) -> Result<Form> {
    let form = match format {
        Some(form) => form,
        None => match form_of(output) {
            Some(form @ Form::Matrix(_)) => form,
            of_ending if is_collocation => {
                endings::check(output, &[endings::MATRIX])?;
                of_ending.unwrap_or(Form::Matrix(MatrixFormat::MatrixMarket))
            }
            of_ending => {
                let rasters = if has_sites { &[] } else { endings::RASTER };
                endings::check(output, &[rasters, endings::ARRAY, endings::NUMBERS])?;
                of_ending.unwrap_or(Form::Text)
            }
        },
    };
    match form {
        Form::Matrix(_) if !is_collocation => Err(only_for_collocation(form, output)),
        Form::Raster(_) if has_sites => {
            Err(Error::usage("sites are no raster: take --format text or npy, or --step for a raster"))
        }
        Form::Matrix(_) => Ok(form),
        _ if is_collocation => Err(Error::usage("a collocation matrix is sparse: take --format mtx or npz")),
        form => Ok(form),
    }
}

fn form_of(output: &Path) -> Option<Form> {
    const ENDINGS: Names<Form> = &[
        ("npy", Form::Array),
        ("npz", Form::Matrix(MatrixFormat::Npz)),
        ("mtx", Form::Matrix(MatrixFormat::MatrixMarket)),
    ];
    // A device such as /dev/fd/3.npy has no format.
    let raster = || of_ending(cells::ENDINGS, output).map(Form::Raster);
    if is_device(output) { None } else { of_ending(ENDINGS, output).or_else(raster) }
}

fn only_for_collocation(form: Form, output: &Path) -> Error {
    let ending = if form == Form::Matrix(MatrixFormat::Npz) { ".npz" } else { ".mtx" };
    let what = format!("{ending} is for sparse matrices (--collocation): values go to .npy, or to text");
    Error::usage(what).of_input(output.display().to_string())
}
