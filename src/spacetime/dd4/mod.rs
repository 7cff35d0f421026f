//! `dd4`: computes the Delaunay diagram of points in four dimensions.

mod counts;
mod files;
mod placement;
mod product;
mod quantum;
mod shelves;
mod streamed;
mod words;
mod write;

pub use counts::Counts;
pub use files::{write_slice, write_surface, write_values};
pub use placement::{Placement, TimeScale};
pub use product::Product;
pub use quantum::Quantum;
pub use streamed::write_streamed;
pub use write::{write_diagram, write_simplices};

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use crate::diagram4::{Route, Stats, diagram_by};
use spmesh_base::error::{Error, Result};
use spmesh_formats::volumes::Selected4;
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;

/// Options of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The quantum of the coordinates, if they are to be replaced by integers.
    pub quantum: Option<Quantum>,
    /// The factor of times, applied after the quantum.
    pub time_scale: TimeScale,
    /// How the diagram is found.
    pub route: Route,
    /// Threads of the engine.
    pub threads: NonZeroUsize,
}

impl Default for Options {
    fn default() -> Self {
        let (quantum, time_scale, route) = <_>::default();
        Options { quantum, time_scale, route, threads: NonZeroUsize::MIN }
    }
}

/// Counts and times of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Selected points.
    pub points: u64,
    /// Points that are equal to an earlier one.
    pub merged: u64,
    /// Times and counts of the engine.
    pub stats: Stats,
    /// Counts of the elements of the diagram.
    pub counts: Counts,
    /// Time to compute the diagram.
    pub diagram_time: Duration,
    /// Time to write.
    pub write_time: Duration,
    /// Bytes written.
    pub output_bytes: u64,
}

/// A diagram, and how its coordinates follow from those of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// The diagram.
    pub diagram: Diagram4,
    /// Its coordinates.
    pub placement: Placement,
    /// Counts and times.
    pub report: Report,
}

/// Computes the diagram of points for a product.
///
/// # Errors
/// As [`diagram_by`] and [`Product::check`]; usage, if a coordinate is no multiple of the quantum, a quantum
/// is given for an oblique grid, or a time overflows when it is scaled; malformed, if a value is infinite.
pub fn make(points: Selected4, product: &Product, options: &Options) -> Result<Made> {
    let name = points.name.clone();
    let placement = Placement { orientation: points.orientation, time_scale: options.time_scale };
    let started = Instant::now();
    let mut report = Report { points: points.points.len() as u64, ..Report::default() };
    let (diagram, stats) = diagram_of(points, product, options, &placement).map_err(|e| e.of_input(name))?;
    report.diagram_time = started.elapsed();
    report.merged = diagram.merged;
    report.stats = stats;
    report.counts = Counts::of(&diagram.cells);
    Ok(Made { diagram, placement, report })
}

fn diagram_of(
    points: Selected4,
    product: &Product,
    options: &Options,
    placement: &Placement,
) -> Result<(Diagram4, Stats)> {
    let (points, values) = checked(points, product, options, placement)?;
    diagram_by(options.route, options.threads, points, values)
}

/// Points in the coordinates of the diagram, and their values.
fn checked(
    points: Selected4,
    product: &Product,
    options: &Options,
    placement: &Placement,
) -> Result<(Vec<Point4>, Option<Vec<f64>>)> {
    let Selected4 { mut points, values, .. } = points;
    // Fail before the computation, rather than when writing.
    let infinite = values.iter().flatten().position(|value| value.is_infinite());
    if let Some(number) = infinite {
        let message = "the value is infinite, which no stream holds: leave such points out with --where";
        return Err(Error::malformed(message).at(format!("point {:?}", points[number])));
    }
    if let Some(quantum) = options.quantum {
        if placement.orientation.is_some() {
            let message = "the grid is oblique in the world, so that coordinates there are no multiples of a \
                           number: leave --quantum or --spacing world out";
            return Err(Error::usage(message));
        }
        quantum.divide(&mut points)?;
    }
    product.check(&points, values.is_some())?;
    placement.scale(&mut points)?;
    Ok((points, values))
}
