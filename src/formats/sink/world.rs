//! World coordinates of stored points, and their text.

use std::io::Write;

use crate::sink::write_error;
use spmesh_base::error::Result;
use spmesh_stream::Header;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::decimal::Decimal;

/// World coordinates of a stored point, as the numbers with the shortest decimals that stand for it; z is 0
/// where points have none, whatever scale and offset say.
pub(crate) fn world_of(header: &Header, stored: Point) -> Point {
    let mut world = header.coordinates.to_decimal(stored);
    if header.coordinates_per_point() == 2 {
        world[2] = 0.0;
    }
    world
}

/// World coordinates of a box of stored points.
pub(crate) fn world_bounds(header: &Header, bounds: &Bounds) -> Bounds {
    Bounds { min: world_of(header, bounds.min), max: world_of(header, bounds.max) }
}

/// A line of `start` and numbers, each the shortest decimal that reads back as the same f64.
pub(crate) fn write_numbers(output: &mut impl Write, start: &str, numbers: &[f64]) -> Result<()> {
    output.write_all(start.as_bytes()).map_err(write_error)?;
    for number in numbers {
        write!(output, " {}", Decimal(*number)).map_err(write_error)?;
    }
    output.write_all(b"\n").map_err(write_error)
}
