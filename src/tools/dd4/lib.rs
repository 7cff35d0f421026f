//! `dd4`: points of four dimensions in, their Delaunay diagram out.

mod figures;
mod files;
mod product;
mod quantum;
mod write;

pub use figures::Figures;
pub use files::{Form, write_slice, write_surface, write_values};
pub use product::Product;
pub use quantum::Quantum;
pub use write::{write_diagram, write_simplices};

use std::time::{Duration, Instant};

use spmesh_core::error::{Error, Result};
use spmesh_geometry::diagram4::{Route, Stats, diagram_by};
use spmesh_io::source::points4::Selected4;
use spmesh_model::diagram4::Diagram4;

/// What is made of points.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Options {
    /// What coordinates are multiples of, if they are to be made whole numbers.
    pub quantum: Option<Quantum>,
    /// How the diagram is found.
    pub route: Route,
}

/// What a run did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Points that were wanted.
    pub points: u64,
    /// Those that are equal to an earlier one.
    pub merged: u64,
    /// What the engine did.
    pub stats: Stats,
    /// The size of the diagram.
    pub figures: Figures,
    /// Making the diagram.
    pub diagram_time: Duration,
    /// Writing.
    pub write_time: Duration,
    /// Bytes written.
    pub output_bytes: u64,
}

/// Makes the diagram of points, of which a product is wanted.
///
/// # Errors
/// As [`diagram_by`] and [`Product::check`]; usage, if a coordinate is no multiple of the quantum; malformed,
/// if a value is infinite.
pub fn make(points: Selected4, product: &Product, options: &Options) -> Result<(Diagram4, Report)> {
    let name = points.name.clone();
    let started = Instant::now();
    let mut report = Report { points: points.points.len() as u64, ..Report::default() };
    let (diagram, stats) = diagram_of(points, product, options).map_err(|e| e.of_input(name))?;
    report.diagram_time = started.elapsed();
    report.merged = diagram.merged;
    report.stats = stats;
    report.figures = Figures::of(&diagram.cells);
    Ok((diagram, report))
}

fn diagram_of(points: Selected4, product: &Product, options: &Options) -> Result<(Diagram4, Stats)> {
    let Selected4 { mut points, values, .. } = points;
    // Known before the work, rather than when it is to be written.
    let infinite = values.iter().flatten().position(|value| value.is_infinite());
    if let Some(number) = infinite {
        let message = "the value is infinite, which no stream holds: leave such points out with --where";
        return Err(Error::malformed(message).at(format!("point {:?}", points[number])));
    }
    if let Some(quantum) = options.quantum {
        quantum.make_whole(&mut points)?;
    }
    product.check(&points, values.is_some())?;
    diagram_by(options.route, points, values)
}
