//! `configgen`: computes configurations of knots, of all degrees up to a given one.
//!
//! `sites` reads knots and the triangulation over them, if there is one. `options` holds the options of a
//! run. `start` turns both into the input of [`spmesh_configurations`]. `special` sets up special
//! configurations, also from text. `mesh` writes centroid triangulations.

mod counts;
mod mesh;
mod options;
mod sites;
mod special;
mod start;

pub use counts::{DegreeCounts, FunctionCounts};
pub use mesh::write_centroids;
pub use options::{Border, Flips, Options, Places, RuleName};
pub use sites::{Frame, Sites, read_sites};
pub use special::{BoxName, SpecialKind, read_features, read_patches};

use std::io::Write;
use std::time::{Duration, Instant};

use self::start::{Origin, Setup};
use spmesh_base::error::Result;
use spmesh_configurations::special::{Function, functions};
use spmesh_configurations::{self as configurations, CentroidMesh, Configurations, Knots};
use spmesh_stream::{Content, Header, configurations_header, write_content};

/// The result of a run.
#[derive(Debug)]
pub struct Made {
    /// All knots: those of the input, then the copies that borders and pulling apart add.
    pub knots: Knots,
    /// Coordinates and elevations of the knots.
    pub frame: Frame,
    /// Configurations of the degrees from 0 on.
    pub degrees: Vec<Configurations>,
    /// The functions that quadratic splines are made of, as sums of B-splines. Empty if every B-spline of a
    /// link is a function of its own (no special configurations, no added copies), and without degree 1,
    /// whose links they come from.
    pub functions: Vec<Function>,
    /// Counts and times.
    pub report: Report,
}

/// Counts and times of a run.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// Points, or vertices, of the input.
    pub points: u64,
    /// Points that coincide with an earlier one.
    pub repeated: u64,
    /// Knots, with the copies that were added.
    pub knots: u64,
    /// Whether the triangles of the input were the start.
    pub own_start: bool,
    /// Flips of the start triangulation.
    pub flips: u64,
    /// Time to compute the start triangulation.
    pub start_time: Duration,
    /// Time to compute all degrees.
    pub degrees_time: Duration,
}

/// Computes the configurations of knots up to the degree of the options.
///
/// # Errors
/// Usage, if there are too few knots for the degree, all on one line, or options do not fit them or each
/// other; as [`configurations::generate`].
pub fn make(sites: Sites, options: &Options) -> Result<Made> {
    let name = sites.name.clone();
    make_unnamed(sites, options).map_err(|e| e.of_input(name))
}

fn make_unnamed(sites: Sites, options: &Options) -> Result<Made> {
    let started = Instant::now();
    let setup = start::set_up(sites, options)?;
    let start_time = started.elapsed();
    let started = Instant::now();
    let Setup { knots, frame, origin, rule, report } = setup;
    let (degrees, special) = match origin {
        Origin::Start(start) => (configurations::generate(&knots, start, &rule, options.degree)?, None),
        Origin::Special(special) => (special.generate(&rule, options.degree)?, Some(special)),
    };
    let has_copies = knots.len() as u64 > report.points;
    let functions = match (special, degrees.get(1)) {
        (Some(special), Some(first)) => special.functions(&configurations::links(&knots, first)?)?,
        (None, Some(first)) if has_copies => functions(&knots, &configurations::links(&knots, first)?)?,
        _ => Vec::new(),
    };
    let report = Report { start_time, degrees_time: started.elapsed(), ..report };
    Ok(Made { knots, frame, degrees, functions, report })
}

impl Made {
    /// Writes the configurations of all degrees, with their knots; blocks may be compressed.
    ///
    /// # Errors
    /// As [`write_content`].
    pub fn write(&self, compress: bool, output: impl Write) -> Result<()> {
        let content = Content {
            heights: self.frame.elevations.as_deref(),
            functions: &self.functions,
            ..Content::of(self.knots.points(), &self.degrees)
        };
        write_content(Header { compressed: compress, ..self.header() }, content, output)
    }

    fn header(&self) -> Header {
        let Frame { coordinates, crs, elevations } = &self.frame;
        let mut header = Header {
            has_elevation: elevations.is_some(),
            producer: concat!("configgen ", env!("CARGO_PKG_VERSION")).to_string(),
            ..configurations_header(self.knots.points(), *coordinates, crs.clone())
        };
        if let (Some(bounds), Some(elevations)) = (&mut header.bounds, elevations) {
            bounds.min[2] = elevations.iter().copied().fold(f64::INFINITY, f64::min);
            bounds.max[2] = elevations.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        }
        header
    }

    /// The centroid triangulation of the highest two degrees; without flat triangles, where knots are
    /// repeated.
    ///
    /// # Errors
    /// As [`CentroidMesh::of`].
    pub fn centroids(&self) -> Result<CentroidMesh> {
        let (upper, lower) = self.degrees.split_last().expect("there is at least degree 0");
        let mesh = CentroidMesh::of(&self.knots, lower.last(), upper)?;
        Ok(if self.knots.has_copies() { mesh.without_flat(&self.knots) } else { mesh })
    }
}
