//! The elevations that have lines, and the rank of a vertex among them.

use super::decimals::Decimals;
use spmesh_base::error::{Error, Result};

/// The limit on numbers of levels. Below it, a rounded quotient is off by at most [`OFF_MAX`].
const LEVEL_MAX: f64 = (1u64 << 50) as f64;

/// The greatest error of the quotient.
const OFF_MAX: i64 = 4;

/// Evenly spaced elevations, numbered.
#[derive(Debug, Clone, Copy)]
pub struct Levels {
    base: f64,
    interval: f64,
    decimals: Decimals,
}

impl Levels {
    /// Levels at `base` and multiples of `interval` from it. Both stand for the shortest decimals that denote
    /// them: the third level of 0.1 is the f64 nearest to 0.3.
    ///
    /// Units: those of elevations.
    ///
    /// # Errors
    /// Usage, if the interval is not positive, or one of them is not finite.
    pub fn new(interval: f64, base: f64) -> Result<Levels> {
        if !(interval.is_finite() && interval > 0.0) {
            return Err(Error::usage(format!(
                "levels {interval:?} apart: the distance must be finite and above zero"
            )));
        }
        if !base.is_finite() {
            return Err(Error::usage(format!("levels from {base:?} on: the number must be finite")));
        }
        Ok(Levels { base, interval, decimals: Decimals::new(base, interval, 0) })
    }

    /// The elevation of a level.
    pub fn elevation(&self, level: i64) -> f64 {
        self.decimals.at(level)
    }

    /// The distance between levels.
    pub(super) fn interval(&self) -> f64 {
        self.interval
    }

    /// The highest level at or below an elevation. A vertex there counts as above this level and all lower
    /// ones.
    pub(super) fn rank(&self, elevation: f64) -> Result<i64> {
        let near = ((elevation - self.base) / self.interval).floor();
        if near.abs() < LEVEL_MAX {
            let near = near as i64;
            let is_below = |level: &i64| self.elevation(*level) <= elevation;
            let found = (near - OFF_MAX..=near + OFF_MAX).rev().find(is_below);
            let is_rank =
                |rank: &i64| *rank < near + OFF_MAX && self.elevation(rank - 1) < self.elevation(*rank);
            if let Some(rank) = found.filter(is_rank) {
                return Ok(rank);
            }
        }
        Err(Error::usage(format!(
            "levels {:?} apart cannot be told apart at elevation {elevation:?}: take a larger distance",
            self.interval
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_on_a_level_is_above_it() {
        for (interval, base) in [(0.1, 0.0), (0.3, 0.05), (5.0, 0.0), (1.0 / 3.0, -7.1), (1e-9, 0.0)] {
            let levels = Levels::new(interval, base).unwrap();
            for level in (-2000..2000).chain([-1_000_000, 1_000_000]) {
                let elevation = levels.elevation(level);
                assert_eq!(levels.rank(elevation).unwrap(), level, "{interval} {base}");
                assert_eq!(levels.rank(elevation.next_down()).unwrap(), level - 1, "{interval} {base}");
            }
        }
    }

    #[test]
    fn levels_that_are_not_apart_are_refused() {
        for (interval, base) in
            [(0.0, 0.0), (-1.0, 0.0), (f64::NAN, 0.0), (f64::INFINITY, 0.0), (1.0, f64::NAN)]
        {
            assert_eq!(Levels::new(interval, base).unwrap_err().exit_code(), 2, "{interval} {base}");
        }
        for (interval, base, elevation) in
            [(1.0, 1e300, 1e300), (1.0, 1e17, 1e17), (5e-324, 0.0, 1.0), (1e-14, 0.0, 1e3), (1.0, 0.0, 1e308)]
        {
            let error = Levels::new(interval, base).unwrap().rank(elevation).unwrap_err();
            assert!(
                error.exit_code() == 2 && error.to_string().contains("take a larger distance"),
                "{error}"
            );
        }
        // The interval may be larger than all elevations.
        assert_eq!(Levels::new(1e308, 0.0).unwrap().rank(-1.0).unwrap(), -1);
    }
}
