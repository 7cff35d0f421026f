//! Flags that say what cells hold.

use clap::{Args, ValueEnum};

use crate::dem::{Interpolation, Method, Quantity, Sample};
use crate::points::Statistic;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::{Differences, Light, Shading};
use spmesh_shell::{Names, named, parse_numbers};

/// Flags that say what cells hold.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "What the cells hold")]
pub(super) struct QuantityFlags {
    /// Read points instead of a mesh, and draw the statistic of --kind of those in each cell: of their elevations, or of
    /// an --attribute
    #[arg(long, conflicts_with_all = ["contours", "OutlineFlags", "fill", "interpolation", "sample", "method", "z_factor", "light", "multidirectional", "range"])]
    pub(super) points: bool,

    /// The quantity in the cells; with --points, from count on [default: elevation; with --points, count]
    #[arg(long, value_enum, value_name = "KIND")]
    kind: Option<KindFlag>,

    /// The elevation of a cell: that of the surface at its centre, or the mean, the least or the greatest
    /// over the part of the cell that the mesh covers. Slopes and the like follow from it [default: centre]
    #[arg(long, value_name = "WHAT", conflicts_with_all = ["contours", "fill", "interpolation"])]
    #[arg(value_parser = named(SAMPLES))]
    sample: Option<Sample>,

    /// What slopes, aspects and hillshades are those of: the cells around (Horn, or Zevenbergen and Thorne), or the
    /// triangle at the centre [default: horn]
    #[arg(long, value_name = "METHOD", value_parser = named(METHODS))]
    method: Option<Method>,

    /// How many units of x and y one unit of elevations is, for slopes, aspects and hillshades [default: as
    /// the coordinate reference system states it, otherwise 1; necessary where x and y are angles]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    pub(super) z_factor: Option<f64>,

    /// Draw an attribute of the points instead of elevations: its name, with :1, :2 ... for one of several
    /// components; red, green and blue are those of rgb
    #[arg(long, value_name = "NAME", conflicts_with = "contours")]
    pub(super) attribute: Option<String>,

    /// How values vary between points: linearly in each triangle; of elevations, by natural neighbours
    /// (Sibson), which is smooth but at the points; of an attribute, the value of the nearest corner of the
    /// triangle, as classes need it [default: linear]
    #[arg(long, value_name = "HOW", conflicts_with = "contours", value_parser = named(INTERPOLATIONS))]
    interpolation: Option<Between>,

    /// Direction of the light of a hillshade, in degrees: clockwise from north, and above the horizon
    /// [default: 315,45]
    #[arg(long, value_name = "AZIMUTH,ALTITUDE", value_parser = parse_numbers::<2>, allow_hyphen_values = true)]
    light: Option<[f64; 2]>,

    /// Light a hillshade from four sides, from south-west to north: from no side is a slope flat
    #[arg(long)]
    multidirectional: bool,

    /// The elevations that the colours of a shaded relief span; those beyond have the colours of the ends [default: all]
    #[arg(long, value_name = "MIN,MAX", value_parser = parse_numbers::<2>, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
}

/// How values vary between points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Between {
    Linear,
    Natural,
    Nearest,
}

/// The values of `--interpolation`.
const INTERPOLATIONS: Names<Between> =
    &[("linear", Between::Linear), ("natural", Between::Natural), ("nearest", Between::Nearest)];

/// The values of `--kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum KindFlag {
    Elevation,
    Slope,
    Aspect,
    Hillshade,
    ShadedRelief,
    Count,
    Density,
    Min,
    Max,
    Range,
    Mean,
    Std,
}

impl KindFlag {
    /// What is said of the points in a cell, if it is that.
    fn statistic(self) -> Option<Statistic> {
        Some(match self {
            KindFlag::Count => Statistic::Count,
            KindFlag::Density => Statistic::Density,
            KindFlag::Min => Statistic::Min,
            KindFlag::Max => Statistic::Max,
            KindFlag::Range => Statistic::Range,
            KindFlag::Mean => Statistic::Mean,
            KindFlag::Std => Statistic::Std,
            _ => return None,
        })
    }
}

/// The values of `--sample`.
const SAMPLES: Names<Sample> =
    &[("centre", Sample::Centre), ("mean", Sample::Mean), ("min", Sample::Min), ("max", Sample::Max)];

/// The values of `--method`.
const METHODS: Names<Method> = &[
    ("horn", Method::Cells(Differences::Horn)),
    ("zevenbergen", Method::Cells(Differences::ZevenbergenThorne)),
    ("triangle", Method::Triangle),
];

impl QuantityFlags {
    /// What is said of the points in a cell.
    pub(super) fn statistic(&self) -> Result<Statistic> {
        self.kind.unwrap_or(KindFlag::Count).statistic().ok_or_else(|| {
            Error::usage(
                "points are counted, or have a min, max, range, mean or std: triangulate them for others",
            )
        })
    }

    /// The quantity of a mesh.
    pub(super) fn quantity(&self) -> Result<Quantity> {
        let kind = self.kind.unwrap_or(KindFlag::Elevation);
        if kind.statistic().is_some() {
            return Err(Error::usage(
                "this --kind is one of points: add --points, and give a stream of spfinalize",
            ));
        }
        self.check(kind)?;
        let interpolation = match self.interpolation {
            Some(Between::Nearest) => Interpolation::Nearest,
            _ => Interpolation::Linear,
        };
        let [azimuth, altitude] = self.light.unwrap_or([315.0, 45.0]);
        let shading = match self.multidirectional {
            true => Shading::Many(altitude),
            false => Shading::One(Light::from(azimuth, altitude)),
        };
        Ok(match (&self.attribute, kind) {
            (Some(name), _) => Quantity::Attribute(name.clone(), interpolation),
            (None, KindFlag::Slope) => Quantity::Slope,
            (None, KindFlag::Aspect) => Quantity::Aspect,
            (None, KindFlag::Hillshade) => Quantity::Hillshade(shading),
            (None, KindFlag::ShadedRelief) => Quantity::ShadedRelief(shading, self.range),
            (None, _) => Quantity::Elevation,
        })
    }

    /// Whether elevations are interpolated by natural neighbours.
    pub(super) fn is_natural(&self) -> bool {
        self.interpolation == Some(Between::Natural)
    }

    /// What of the surface over a cell its elevation is.
    pub(super) fn sample(&self) -> Sample {
        self.sample.unwrap_or_default()
    }

    /// What slopes and the like are those of.
    pub(super) fn method(&self) -> Method {
        self.method.unwrap_or(Method::Cells(Differences::Horn))
    }

    /// Refuses flags that are for other kinds.
    fn check(&self, kind: KindFlag) -> Result<()> {
        if self.light.is_some_and(|light| !light.iter().all(|angle| angle.is_finite())) {
            return Err(Error::usage("--light takes two angles in degrees"));
        }
        let is_lit = matches!(kind, KindFlag::Hillshade | KindFlag::ShadedRelief);
        let is_relief = kind == KindFlag::ShadedRelief;
        if self.z_factor.is_some_and(|factor| !(factor > 0.0 && factor.is_finite())) {
            return Err(Error::usage("--z-factor takes a number above zero"));
        }
        let is_triangle = self.method == Some(Method::Triangle);
        let refusals = [
            (
                self.attribute.is_some() && self.kind.is_some(),
                "--attribute is drawn instead of a --kind: leave out one of them",
            ),
            (self.light.is_some() && !is_lit, "--light is for a hillshade: add --kind hillshade"),
            (self.multidirectional && !is_lit, "--multidirectional is for a hillshade: add --kind hillshade"),
            (self.range.is_some() && !is_relief, "--range is for a shaded relief: add --kind shaded-relief"),
            (
                self.method.is_some() && kind == KindFlag::Elevation,
                "--method is for slopes, aspects and hillshades: add --kind",
            ),
            (
                self.attribute.is_none() && self.interpolation == Some(Between::Nearest),
                "the nearest corner is for attributes: add --attribute, or leave out --interpolation",
            ),
            (
                self.attribute.is_some() && self.is_natural(),
                "natural neighbours are for elevations: leave out --attribute, or --interpolation natural",
            ),
            (
                is_triangle && self.is_natural(),
                "--method triangle takes the plane of a triangle: leave it out for natural neighbours",
            ),
            (
                self.z_factor.is_some() && (kind == KindFlag::Elevation || self.attribute.is_some()),
                "--z-factor is for slopes, aspects and hillshades: add --kind",
            ),
            (is_triangle && self.sample().is_whole(), "--sample is of cells: leave out --method triangle"),
            (is_triangle && is_relief, "a shaded relief follows from cells: leave out --method triangle"),
        ];
        match refusals.iter().find(|(is_wrong, _)| *is_wrong) {
            Some((_, what)) => Err(Error::usage(*what)),
            None => self.check_range(),
        }
    }

    fn check_range(&self) -> Result<()> {
        if self.range.is_some_and(|[low, high]| !(low < high && low.is_finite() && high.is_finite())) {
            return Err(Error::usage("--range takes the least elevation and the greatest"));
        }
        Ok(())
    }
}
