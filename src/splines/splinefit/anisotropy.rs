//! Anisotropy: values that vary more slowly along one direction than across it.
//!
//! Fits are made in stretched coordinates, in which values vary alike in all directions: knots, distances and
//! energies are those of there. The spline is then moved back. Configurations stay what they are, because
//! splines over stretched knots are stretched splines.

use std::str::FromStr;

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;

/// The greatest ratio of sides of the box of points whose coordinates are taken as they are.
pub(super) const ASPECT_MAX: f64 = 100.0;
/// Ratios beyond this one, or its inverse, would lose the digits of coordinates.
const RATIO_MAX: f64 = 1e12;

/// How values vary with directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anisotropy {
    /// So many times more slowly along a direction, in degrees counterclockwise from the x axis, than across.
    Ratio(f64, f64),
    /// As the sides of the box of the points.
    Rescale,
    /// As cross-validation tells.
    Auto,
}

impl FromStr for Anisotropy {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Anisotropy, String> {
        match text {
            "auto" => return Ok(Anisotropy::Auto),
            "rescale" => return Ok(Anisotropy::Rescale),
            _ => (),
        }
        let (ratio, angle) = text.split_once(':').unwrap_or((text, "0"));
        match (ratio.parse::<f64>(), angle.parse::<f64>()) {
            (Ok(ratio), Ok(angle)) if (1.0 / RATIO_MAX..=RATIO_MAX).contains(&ratio) && angle.is_finite() => {
                Ok(Anisotropy::Ratio(ratio, angle))
            }
            _ => Err("expected RATIO above zero, RATIO:ANGLE in degrees, auto or rescale".into()),
        }
    }
}

/// A map to coordinates in which values vary alike in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// How many times more slowly values vary along the direction than across it.
    pub ratio: f64,
    /// The direction, in degrees counterclockwise from the x axis.
    pub angle: f64,
    /// Cosine and sine of the angle.
    turn: [f64; 2],
}

impl Stretch {
    /// No stretch.
    pub const NONE: Stretch = Stretch { ratio: 1.0, angle: 0.0, turn: [1.0, 0.0] };

    pub(super) fn new(ratio: f64, angle: f64) -> Stretch {
        // Along an axis, coordinates are only scaled.
        let turn = match angle.rem_euclid(180.0) {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            _ => [angle.to_radians().cos(), angle.to_radians().sin()],
        };
        Stretch { ratio, angle, turn }
    }

    /// The stretch that makes a box square.
    ///
    /// # Errors
    /// Usage, if its sides are too different.
    pub(super) fn of_box([low, high]: [Point2; 2]) -> Result<Stretch> {
        let ratio = (high[0] - low[0]) / (high[1] - low[1]);
        if !(1.0 / RATIO_MAX..=RATIO_MAX).contains(&ratio) {
            return Err(Error::usage(format!(
                "points are on a line, nearly: x and y have ranges of {ratio} to 1"
            )));
        }
        Ok(Stretch::new(ratio, 0.0))
    }

    /// Distances along the direction stay as they are; those across it are multiplied by the ratio.
    pub(super) fn apply(&self, [x, y]: Point2) -> Point2 {
        let [c, s] = self.turn;
        [c * x + s * y, self.ratio * (c * y - s * x)]
    }

    pub(super) fn undo(&self, [along, across]: Point2) -> Point2 {
        let ([c, s], across) = (self.turn, across / self.ratio);
        [c * along - s * across, s * along + c * across]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_undone() {
        for (ratio, angle) in [(1.0, 0.0), (3.0, 90.0), (1e-6, 0.0), (4.0, 30.0), (0.5, -75.0)] {
            let stretch = Stretch::new(ratio, angle);
            let [x, y] = stretch.undo(stretch.apply([3.0, -7.0]));
            assert!((x - 3.0).abs() < 1e-14 && (y + 7.0).abs() < 1e-14, "{ratio} {angle}: {x} {y}");
        }
        // Along 30 degrees, nothing changes.
        let [x, y] = Stretch::new(5.0, 30.0).apply([3f64.sqrt(), 1.0]);
        assert!((x - 2.0).abs() < 1e-15 && y.abs() < 1e-15);
        assert_eq!(Stretch::of_box([[1.0, 0.0], [3.0, 8.0]]).unwrap().apply([2.0, 8.0]), [2.0, 2.0]);
        assert!(Stretch::of_box([[0.0, 0.0], [1e-3, 1e10]]).is_err());
    }

    #[test]
    fn flags_are_read() {
        assert_eq!("4:30".parse(), Ok(Anisotropy::Ratio(4.0, 30.0)));
        assert_eq!("0.5".parse(), Ok(Anisotropy::Ratio(0.5, 0.0)));
        assert_eq!("auto".parse(), Ok(Anisotropy::Auto));
        for text in ["0", "-1", "nan", "4:", "4:x", "automatic", "1e300"] {
            assert!(text.parse::<Anisotropy>().is_err(), "{text}");
        }
    }
}
