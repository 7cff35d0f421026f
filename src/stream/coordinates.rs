//! How stored coordinates are encoded, and how they map to the world.

use super::decimals::Axis;
use crate::model::bounds::{Bounds, Point};

/// The most that sixteen roundings change a sum by, as a part of its terms. A conversion to the world and
/// back has fewer.
const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// How stored coordinates are encoded, and how they map to the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinates {
    /// World coordinates themselves.
    F64,
    /// Integers of 32 bits: world = stored * scale + offset, per axis.
    I32 {
        /// Step per axis in world units, positive.
        scale: [f64; 3],
        /// World coordinate of stored 0 per axis.
        offset: [f64; 3],
    },
}

impl Coordinates {
    /// World coordinates of a stored point, for computations; [`Coordinates::to_decimal`] is for what users
    /// read.
    pub fn to_world(&self, stored: Point) -> Point {
        match self {
            Coordinates::F64 => stored,
            Coordinates::I32 { scale, offset } => std::array::from_fn(|axis| {
                Axis { scale: scale[axis], offset: offset[axis] }.world(stored[axis])
            }),
        }
    }

    /// A box of the world, and what roundings may make of places in it on the way to stored coordinates and
    /// back.
    pub fn widened(&self, world: &Bounds) -> Bounds {
        let offset = match self {
            Coordinates::F64 => [0.0; 3],
            Coordinates::I32 { offset, .. } => *offset,
        };
        let slack = |axis: usize, side: f64| ROUNDINGS * (side.abs() + offset[axis].abs());
        Bounds {
            min: std::array::from_fn(|axis| world.min[axis] - slack(axis, world.min[axis])),
            max: std::array::from_fn(|axis| world.max[axis] + slack(axis, world.max[axis])),
        }
    }

    /// World coordinates of a stored point as the numbers with the shortest decimals that stand for it: 28016
    /// steps of 0.001 are 28.016, and not 28.016000000000002 (`formats/text.md`, section Numbers). All that
    /// is printed or exported goes through this function. [`Coordinates::to_stored`] recovers the point.
    pub fn to_decimal(&self, stored: Point) -> Point {
        match self {
            Coordinates::F64 => stored,
            Coordinates::I32 { scale, offset } => std::array::from_fn(|axis| {
                Axis { scale: scale[axis], offset: offset[axis] }.decimal(stored[axis])
            }),
        }
    }

    /// Whether a world coordinate that was read, as a decimal, stands for a stored one on this axis.
    pub fn is_decimal_of(&self, axis: usize, world: f64, stored: f64) -> bool {
        match self {
            Coordinates::F64 => world == stored,
            Coordinates::I32 { scale, offset } => {
                Axis { scale: scale[axis], offset: offset[axis] }.is_decimal_of(world, stored)
            }
        }
    }

    /// Stored coordinates of the grid point nearest to a world point. They may be out of the range of i32.
    pub fn to_stored(&self, world: Point) -> Point {
        match self {
            Coordinates::F64 => world,
            Coordinates::I32 { scale, offset } => {
                std::array::from_fn(|axis| ((world[axis] - offset[axis]) / scale[axis]).round())
            }
        }
    }

    /// The value nearest to a stored one, or to a sum or mean of such, that the grid has.
    pub fn rounded(&self, value: f64) -> f64 {
        match self {
            Coordinates::F64 => value,
            Coordinates::I32 { .. } => value.round(),
        }
    }

    /// Whether a stored value fits the encoding: a finite f64, or an integer that fits in i32.
    pub fn can_store(&self, value: f64) -> bool {
        match self {
            Coordinates::F64 => value.is_finite(),
            Coordinates::I32 { .. } => f64::from(value as i32) == value,
        }
    }

    /// Bytes of one stored coordinate.
    pub fn width(&self) -> usize {
        match self {
            Coordinates::F64 => 8,
            Coordinates::I32 { .. } => 4,
        }
    }
}

/// Whether every i32 has its own world coordinate, from which `to_stored` recovers it.
///
/// Proof, with errors in steps of `scale`: rounding the sum costs at most 2^-53 (2^51 + 2^31 + 1), about a
/// quarter. Rounding product, difference and quotient costs 2^-21 together. The total is below one half, so
/// rounding to the nearest integer removes it.
pub(super) fn is_grid(scale: f64, offset: f64) -> bool {
    let steps_max = 2f64.powi(51);
    scale > 0.0 && offset.abs() <= scale * steps_max && (scale * steps_max).is_finite()
}
