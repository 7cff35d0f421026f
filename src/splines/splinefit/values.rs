//! Splines at sites: a table of x, y and an attribute, an array of the attribute, or all functions of the
//! basis as a sparse matrix.

use std::io::Write;
use std::path::Path;

use super::attributes::Attribute;
use super::layout::{Layout, Spline};
use super::table;
use crate::bases::{Jet, Scratch};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::sink::{MatrixFormat, NpyRows, SparseRows};
use spmesh_formats::source::Input;

/// Writes a table with a line for each site, in their order. Outside of the domain, where a spline is not
/// extrapolated, the attribute is `nan`. Returns the number of sites, and the number of sites outside.
///
/// # Errors
/// If sites cannot be read, or lines cannot be written.
pub fn write_values(
    spline: &Spline,
    attribute: Attribute,
    sites: &Input,
    output: &mut impl Write,
    done: impl FnMut(u64),
) -> Result<[u64; 2]> {
    table::write_title(output, ["x", "y"].iter().chain(attribute.columns()))?;
    let (mut scratch, mut text) = (Scratch::default(), Vec::new());
    for_each_site(sites, done, |site| {
        let jet = spline.jet(site.world, attribute, &mut scratch);
        text.clear();
        line(&mut text, site.decimal, attribute, jet.as_ref());
        output.write_all(&text).map_err(table::write_error)?;
        Ok(jet.is_some())
    })
}

/// Writes an array of numpy: as [`write_values`], without x and y.
///
/// Shape: (sites,), or (sites, numbers) for attributes of several numbers. The numbers wait in a temporary
/// file in `temp_dir`, or in the system's folder.
///
/// # Errors
/// As [`write_values`].
pub fn write_value_array(
    spline: &Spline,
    attribute: Attribute,
    sites: &Input,
    temp_dir: Option<&Path>,
    output: &mut impl Write,
    done: impl FnMut(u64),
) -> Result<[u64; 2]> {
    let mut scratch = Scratch::default();
    let mut row = vec![f64::NAN; attribute.columns().len()];
    let mut array = NpyRows::new(row.len(), temp_dir)?;
    let counts = for_each_site(sites, done, |site| {
        let jet = spline.jet(site.world, attribute, &mut scratch);
        attribute.fill(jet.as_ref(), &mut row);
        array.push(&row)?;
        Ok(jet.is_some())
    })?;
    array.finish(output)?;
    Ok(counts)
}

/// Appends a line of a table.
pub(super) fn line(text: &mut Vec<u8>, [x, y]: Point2, attribute: Attribute, jet: Option<&Jet>) {
    let mut push = |word: String| text.extend_from_slice(word.as_bytes());
    push(format!("{x} {y}"));
    match jet {
        Some(jet) => attribute.all(jet).for_each(|number| push(format!(" {}", Number(number)))),
        None => attribute.columns().iter().for_each(|_| push(" nan".into())),
    }
    text.push(b'\n');
}

/// A number in a table.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_nan() { f.write_str("nan") } else { self.0.fmt(f) }
    }
}

impl Spline {
    /// The jet that an attribute needs at a world point, in world coordinates; `None` outside of the domain.
    pub(super) fn jet(&self, world: Point2, attribute: Attribute, scratch: &mut Scratch) -> Option<Jet> {
        let (basis, frame) = (&self.layout.basis, &self.layout.frame);
        let at = frame.to_stored(world);
        if self.beyond.is_far(world) {
            return None;
        }
        if !basis.is_in_domain(at) {
            let jet = self.jet_outside(at, scratch).filter(|_| !attribute.is_error())?;
            return Some(match attribute {
                Attribute::Gradient | Attribute::Hessian => frame.jet_to_world(jet),
                _ => frame.jet_in_one_unit(jet),
            });
        }
        Some(match attribute {
            Attribute::Value => Jet::constant(basis.value(&self.coefficients, at, scratch)),
            Attribute::StandardError | Attribute::PredictionError => {
                let certainty = self.certainty.as_ref()?;
                let error = certainty.standard_error(basis.at(at, scratch));
                let noise = if attribute == Attribute::PredictionError { certainty.noise } else { 0.0 };
                Jet::constant(error.hypot(noise))
            }
            Attribute::Interval => {
                let certainty = self.certainty.as_ref()?;
                let values = basis.at(at, scratch);
                let half = certainty.width * certainty.standard_error(values).hypot(certainty.noise);
                let value = basis.value(&self.coefficients, at, scratch);
                // The upper end has no place of its own.
                Jet { value: value - half, gradient: [value + half, 0.0], ..Jet::default() }
            }
            Attribute::SlopeError => Jet::constant(self.slope_error(at, scratch)?),
            Attribute::Gradient | Attribute::Hessian => {
                frame.jet_to_world(basis.jet(&self.coefficients, at, scratch))
            }
            _ => frame.jet_in_one_unit(basis.jet(&self.coefficients, at, scratch)),
        })
    }
}

impl Spline {
    /// The standard error of the slope at a stored place, in degrees: that of the gradient along itself, as
    /// far as slopes are linear in it. Where it is level, that of the gradient along any direction, on
    /// average.
    fn slope_error(&self, at: Point2, scratch: &mut Scratch) -> Option<f64> {
        let certainty = self.certainty.as_ref()?;
        let jets = self.layout.basis.jets_at(at, scratch);
        let gradient = jets.iter().fold([0.0; 2], |sum, (function, jet)| {
            [0, 1].map(|axis| sum[axis] + self.coefficients[*function as usize] * jet.gradient[axis])
        });
        let steepness = gradient[0].hypot(gradient[1]);
        let along = |[x, y]: [f64; 2]| -> f64 {
            let values: Vec<(u32, f64)> = jets
                .iter()
                .map(|(function, jet)| (*function, x * jet.gradient[0] + y * jet.gradient[1]))
                .collect();
            certainty.standard_error(&values)
        };
        let error = match steepness > 0.0 {
            true => along(gradient.map(|slope| slope / steepness)),
            false => along([1.0, 0.0]).hypot(along([0.0, 1.0])) / 2f64.sqrt(),
        };
        let both = Jet { gradient: [steepness, error], ..Jet::default() };
        let [steepness, error] = self.layout.frame.jet_in_one_unit(both).gradient;
        Some((error / (1.0 + steepness * steepness)).to_degrees())
    }
}

/// A site in world coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    /// For computations.
    pub(super) world: Point2,
    /// As users read it.
    pub(super) decimal: Point2,
}

/// Calls `take` with each site, in their order. `take` returns whether the site is in the domain. Returns the
/// number of sites, and the number of sites outside. `done` gets the number of sites so far.
pub(super) fn for_each_site(
    sites: &Input,
    mut done: impl FnMut(u64),
    mut take: impl FnMut(Site) -> Result<bool>,
) -> Result<[u64; 2]> {
    let (mut count, mut outside) = (0, 0);
    let (mut reader, mut batch) = (sites.read()?, Vec::new());
    let coordinates = sites.description().coordinates;
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            return Ok([count, outside]);
        }
        for &stored in &batch {
            let [world, decimal] = [coordinates.to_world(stored), coordinates.to_decimal(stored)];
            let [world, decimal] = [world, decimal].map(|[x, y, _]| [x, y]);
            outside += u64::from(!take(Site { world, decimal })?);
        }
        count += batch.len() as u64;
        done(count);
    }
}

/// What a collocation matrix has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CollocationCounts {
    /// Rows: the number of sites.
    pub sites: u64,
    /// Rows without entries: the number of sites outside of the domain.
    pub outside: u64,
    /// Columns: the number of functions.
    pub functions: usize,
    /// Entries that are not zero.
    pub entries: u64,
}

/// Writes the matrix with a row for each site, in their order, and a column for each function: the values of
/// functions at sites. Times the coefficients of a spline it is the values of the spline. Rows of sites
/// outside of the domain are empty.
///
/// Cost: one pass over the sites; the entries wait in temporary files in `temp_dir`, see
/// [`SparseRows`].
///
/// # Errors
/// If sites cannot be read, or the matrix cannot be written.
pub fn write_collocation(
    layout: &Layout,
    sites: &Input,
    format: MatrixFormat,
    temp_dir: Option<&Path>,
    output: &mut impl Write,
    done: impl FnMut(u64),
) -> Result<CollocationCounts> {
    let (basis, mut scratch) = (&layout.basis, Scratch::default());
    let mut matrix = SparseRows::new(basis.len() as u64, temp_dir)?;
    let [sites, outside] = for_each_site(sites, done, |site| {
        let at = layout.frame.to_stored(site.world);
        let is_inside = basis.is_in_domain(at);
        matrix.push(if is_inside { basis.at(at, &mut scratch) } else { &[] })?;
        Ok(is_inside)
    })?;
    let entries = matrix.entries();
    matrix.finish(format, output)?;
    Ok(CollocationCounts { sites, outside, functions: basis.len(), entries })
}
