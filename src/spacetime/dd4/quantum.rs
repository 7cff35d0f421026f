//! Replaces coordinates that are multiples of a number by integers.

use std::str::FromStr;

use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::Point4;

/// Largest multiple. Up to it, the f64 nearest to a multiple differs from it by less than [`TOLERANCE`].
const MULTIPLE_MAX: f64 = 2_147_483_648.0;

/// Tolerance of a multiple, relative to the quantum.
const TOLERANCE: f64 = 1e-6;

/// The quantum of coordinates: positive and finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantum(f64);

impl Quantum {
    /// Divides each coordinate by the quantum, and rounds it to the integer it must be.
    ///
    /// Multiples of a number like 0.1 are rounded in f64, so that points of a grid are not exactly
    /// cospherical; integers are exact.
    ///
    /// # Errors
    /// Usage, at the first coordinate that differs from a multiple by more than a millionth of the quantum,
    /// or is too large to tell.
    pub fn divide(self, points: &mut [Point4]) -> Result<()> {
        for point in points {
            *point = self.whole(*point).map_err(|error| error.at(format!("point {point:?}")))?;
        }
        Ok(())
    }

    fn whole(self, point: Point4) -> Result<Point4> {
        let mut whole = [0.0; 4];
        for (axis, name) in ["x", "y", "z", "t"].into_iter().enumerate() {
            let (x, Quantum(quantum)) = (point[axis], self);
            let multiple = x / quantum;
            // A negated `<=` instead of `>`, because NaN must fail too.
            let is_below = multiple.abs() <= MULTIPLE_MAX;
            if !is_below {
                let message = format!(
                    "{name} = {x} is more than 2^31 times {quantum}: --quantum needs coordinates near the origin"
                );
                return Err(Error::usage(message));
            }
            whole[axis] = multiple.round() + 0.0;
            if (multiple - whole[axis]).abs() > TOLERANCE {
                let message = format!(
                    "{name} = {x} is no multiple of {quantum}, but {multiple} times as much: choose another --quantum"
                );
                return Err(Error::usage(message));
            }
        }
        Ok(whole)
    }
}

impl FromStr for Quantum {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let quantum = text.parse().ok().filter(|quantum: &f64| quantum.is_normal() && *quantum > 0.0);
        quantum.map(Quantum).ok_or_else(|| format!("{text:?} is not a number above 0, like 0.1"))
    }
}
