//! World coordinates of stored points, and their text.

use std::io::Write;

use crate::sink::{SinkOptions, write_error};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Header;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::decimal::{Decimal, digits};

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

/// What becomes of stored coordinates in an output: those of the world, or differences from a local origin.
pub(crate) struct Places {
    header: Header,
    origin: Option<Point>,
}

impl Places {
    /// # Errors
    /// Usage, if the header does not state the box that a local origin needs.
    pub(crate) fn new(header: &Header, options: &SinkOptions) -> Result<Self> {
        let header = header.clone();
        if !options.local_origin {
            return Ok(Places { header, origin: None });
        }
        let bounds = header.bounds.ok_or_else(|| {
            Error::usage("--local-origin needs the bounds of the stream, and its header does not state them")
        })?;
        let origin = Some(local_origin(&world_bounds(&header, &bounds)));
        Ok(Places { header, origin })
    }

    /// The header of the stream.
    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// What is subtracted from the coordinates of the world, if they are local.
    pub(crate) fn origin(&self) -> Option<Point> {
        self.origin
    }

    /// Coordinates of a stored point.
    pub(crate) fn of(&self, stored: Point) -> Point {
        self.of_world(world_of(&self.header, stored))
    }

    /// Coordinates of a place of the world.
    pub(crate) fn of_world(&self, world: Point) -> Point {
        let Some(origin) = self.origin else { return world };
        [0, 1, 2].map(|axis| shortest(world[axis], origin[axis]))
    }
}

/// The difference of two numbers with no more decimals than they have, so that 499000.1 minus 499000 is 0.1.
fn shortest(number: f64, origin: f64) -> f64 {
    let difference = number - origin;
    let (Some((_, a)), Some((_, b))) = (digits(number), digits(origin)) else { return difference };
    let places = a.min(b).min(0).unsigned_abs() as usize;
    format!("{difference:.places$}").parse().unwrap_or(difference) + 0.0
}

/// A place near the middle of a box, for differences that numbers of 32 bits hold with little loss. It has
/// whole coordinates, or as many decimals as a box with sides below 1 needs. It is zero where the box is so
/// near to zero that differences would gain less than two bits.
pub(crate) fn local_origin(bounds: &Bounds) -> Point {
    let Bounds { min, max } = bounds;
    let side = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
    let greatest = (0..3).map(|axis| min[axis].abs().max(max[axis].abs())).fold(0.0, f64::max);
    if greatest <= 2.0 * side {
        return [0.0; 3];
    }
    let places = (-side.log10().floor()).clamp(0.0, 17.0) as usize;
    [0, 1, 2].map(|axis| {
        let middle = 0.5 * min[axis] + 0.5 * max[axis];
        format!("{middle:.places$}").parse().unwrap_or(middle) + 0.0
    })
}

/// A line of `start` and numbers, each the shortest decimal that reads back as the same f64.
pub(crate) fn write_numbers(output: &mut impl Write, start: &str, numbers: &[f64]) -> Result<()> {
    output.write_all(start.as_bytes()).map_err(write_error)?;
    for number in numbers {
        write!(output, " {}", Decimal(*number)).map_err(write_error)?;
    }
    output.write_all(b"\n").map_err(write_error)
}
