//! Anisotropy: values that vary more slowly along one direction than across it.
//!
//! Fits are made in stretched coordinates, in which values vary alike in all directions: knots, distances and
//! energies are those of there. The spline is then moved back. Configurations stay what they are, because
//! splines over stretched knots are stretched splines.
//!
//! That holds for the numbers, too: knots are on a grid so coarse, and ratios and directions have so few
//! digits, that the coordinates of a knot in the world and its stretched coordinates are both exact. So three
//! knots turn the same way in both, and what was convex or on a line stays so. Knots at one place are
//! displaced as they are in the world.

use std::str::FromStr;

use spmesh_base::error::{Error, Result};
use spmesh_configurations::Displacement;
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::Point2;

/// The greatest ratio of sides of the box of points whose coordinates are taken as they are.
pub(super) const ASPECT_MAX: f64 = 100.0;
/// Ratios beyond this one, or its inverse, would lose the digits of coordinates.
const RATIO_MAX: f64 = 1e12;
/// The same for directions that are not along an axis: their own digits are too few for more.
const RATIO_ALONG_MAX: f64 = 100.0;
/// Digits of ratios to base 2, and of the cosines of directions.
const RATIO_DIGITS: i32 = 14;
const DIRECTION_DIGITS: i32 = 10;
/// Digits of the coordinates of knots, as multiples of the steps of their grid. Together with those of the
/// ratio there are three fewer than in f64, for knots far outside.
const KNOT_DIGITS: i32 = 36;

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
                let most = if angle.rem_euclid(90.0) == 0.0 { RATIO_MAX } else { RATIO_ALONG_MAX };
                match (1.0 / most..=most).contains(&ratio) {
                    true => Ok(Anisotropy::Ratio(ratio, angle)),
                    false => Err(format!(
                        "{ratio} along a direction: expected at most {most} to 1; scale the coordinates first"
                    )),
                }
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
    /// About the cosine and the sine of the angle.
    along: [f64; 2],
    origin: Point2,
    /// The steps of the grid of knots along the direction and across it, in units of the world.
    steps: [f64; 2],
}

impl Stretch {
    /// No stretch.
    pub const NONE: Stretch =
        Stretch { ratio: 1.0, angle: 0.0, along: [1.0, 0.0], origin: [0.0; 2], steps: [0.0; 2] };

    /// A stretch of points in a box. Knots may be around it, as far as its longer side and `margin`, both in
    /// stretched coordinates.
    pub(super) fn new(ratio: f64, angle: f64, [low, high]: [Point2; 2], margin: f64) -> Stretch {
        // Along an axis, coordinates are only scaled.
        let along = match angle.rem_euclid(180.0) {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            _ => {
                let unit = 0.5f64.powi(DIRECTION_DIGITS);
                [angle.to_radians().cos(), angle.to_radians().sin()].map(|x| (x / unit).round() * unit)
            }
        };
        let unit = power_of_two(ratio) * 0.5f64.powi(RATIO_DIGITS);
        let ratio = (ratio / unit).round() * unit;
        let middle = [0, 1].map(|axis| low[axis].midpoint(high[axis]));
        let stretch = Stretch { ratio, angle, along, origin: middle, steps: [0.0; 2] };
        let corners = [low, high, [low[0], high[1]], [high[0], low[1]]].map(|corner| stretch.apply(corner));
        let reach = [0, 1].map(|axis| corners.iter().fold(0.0, |most, c| f64::max(most, c[axis].abs())));
        let around = 2.0 * reach[0].max(reach[1]) + margin;
        let digits = 0.5f64.powi(KNOT_DIGITS);
        let least = [0, 1].map(|axis| power_of_two(low[axis].abs().max(high[axis].abs())) * f64::EPSILON);
        let whole = [0, 1].map(|axis| power_of_two((reach[axis] + around) / [1.0, ratio][axis]) * digits);
        let steps = match along {
            [1.0, _] => [0, 1].map(|axis| whole[axis].max(least[axis])),
            [_, 1.0] => [0, 1].map(|axis| whole[axis].max(least[1 - axis])),
            // The digits of directions are below those of steps.
            _ => {
                let step = least[0].max(least[1]) * 2f64.powi(DIRECTION_DIGITS);
                [whole[0].max(whole[1]).max(step); 2]
            }
        };
        let step = steps[0].max(steps[1]);
        Stretch { steps, origin: middle.map(|x| (x / step).round() * step), ..stretch }
    }

    /// The stretch that makes a box square.
    ///
    /// # Errors
    /// Usage, if its sides are too different.
    pub(super) fn of_box([low, high]: [Point2; 2], margin: f64) -> Result<Stretch> {
        let ratio = (high[0] - low[0]) / (high[1] - low[1]);
        if !(1.0 / RATIO_MAX..=RATIO_MAX).contains(&ratio) {
            return Err(Error::usage(format!(
                "points are on a line, nearly: x and y have ranges of {ratio} to 1"
            )));
        }
        Ok(Stretch::new(ratio, 0.0, [low, high], margin))
    }

    /// Distances along the direction stay as they are, nearly; those across it are multiplied by the ratio.
    pub(super) fn apply(&self, [x, y]: Point2) -> Point2 {
        let ([c, s], [x, y]) = (self.along, [x - self.origin[0], y - self.origin[1]]);
        let square = c * c + s * s;
        [(c * x + s * y) / square, self.ratio * ((c * y - s * x) / square)]
    }

    /// The nearest place of the grid of knots, in stretched coordinates.
    pub(super) fn on_grid(&self, [along, across]: Point2) -> Point2 {
        let [first, second] = self.steps;
        [(along / first).round() * first, self.ratio * ((across / self.ratio / second).round() * second)]
    }

    /// The distinct places of the grid of knots that are nearest to some places.
    pub(super) fn places(&self, mut places: Vec<Point2>) -> Vec<Point2> {
        places.iter_mut().for_each(|place| *place = self.on_grid(*place));
        let first = distinct(&places);
        let mut id = 0..;
        places.retain(|_| id.next().is_some_and(|id| first[id as usize] == id));
        places
    }

    /// How knots are displaced in stretched coordinates if they are pulled apart in the world: the map, times
    /// a factor that makes it one of integers.
    pub(super) fn displacement(&self) -> Displacement {
        let [c, s] = self.along;
        let digits = if c * s == 0.0 { 0 } else { DIRECTION_DIGITS };
        let [c, s] = [c, s].map(|x| x * 2f64.powi(digits));
        let unit = (power_of_two(self.ratio) * 0.5f64.powi(RATIO_DIGITS)).min(1.0);
        let rows = [[c / unit, s / unit], [-s * self.ratio / unit, c * self.ratio / unit]];
        Displacement(rows.map(|row| row.map(|entry| entry as i64)))
    }

    /// The world coordinates of a place; exact for places of the grid.
    pub(super) fn undo(&self, [along, across]: Point2) -> Point2 {
        let ([c, s], across) = (self.along, across / self.ratio);
        [self.origin[0] + (c * along - s * across), self.origin[1] + (s * along + c * across)]
    }

    /// The longer side of cells of the grid, in stretched coordinates.
    pub(super) fn step(&self) -> f64 {
        self.steps[0].max(self.ratio * self.steps[1])
    }
}

/// The least power of two that is not less.
fn power_of_two(x: f64) -> f64 {
    2f64.powi(x.log2().ceil() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: [Point2; 2] = [[500_000.0, -7.5], [500_004.0, 0.25]];

    #[test]
    fn stretches_are_undone() {
        for (ratio, angle) in [(1.0, 0.0), (3.0, 90.0), (1e-6, 0.0), (4.0, 30.0), (0.5, -75.0)] {
            let stretch = Stretch::new(ratio, angle, [[-8.0; 2], [8.0; 2]], 0.0);
            let [x, y] = stretch.undo(stretch.apply([3.0, -7.0]));
            assert!((x - 3.0).abs() < 1e-14 && (y + 7.0).abs() < 1e-14, "{ratio} {angle}: {x} {y}");
        }
        // Along 30 degrees, nothing changes but by the digits of the direction.
        let stretch = Stretch::new(5.0, 30.0, [[-8.0; 2], [8.0; 2]], 0.0);
        let [origin, there] = [[0.0; 2], [3f64.sqrt(), 1.0]].map(|place| stretch.apply(place));
        assert!((there[0] - origin[0] - 2.0).abs() < 2e-3 && (there[1] - origin[1]).abs() < 2e-2);
        let square = Stretch::of_box([[1.0, 0.0], [3.0, 8.0]], 0.0).unwrap();
        let [low, high] = [[1.0, 0.0], [3.0, 8.0]].map(|corner| square.apply(corner));
        assert_eq!([high[0] - low[0], high[1] - low[1]], [2.0, 2.0]);
        assert!(Stretch::of_box([[0.0, 0.0], [1e-3, 1e10]], 0.0).is_err());
    }

    #[test]
    fn places_of_the_grid_are_exact_in_both_coordinates() {
        use spmesh_base::random::Random;
        use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
        let (mut random, mut predicates) = (Random::new(6), FiniteFloatPredicates::default());
        for (ratio, angle) in [(3.3, 0.0), (1e7, 90.0), (1e-6, 180.0), (7.7, 30.0), (0.03, -75.0)] {
            let stretch = Stretch::new(ratio, angle, BOX, 1.0);
            assert!((stretch.ratio / ratio - 1.0).abs() < 1e-4);
            let corners = BOX.map(|corner| stretch.apply(corner));
            let extent = (corners[1][0] - corners[0][0]).abs().max((corners[1][1] - corners[0][1]).abs());
            assert!(stretch.step() < 1e-7 * extent, "{ratio} {angle}: {}", stretch.step());
            let mut place = || {
                let world = [0, 1].map(|axis| BOX[0][axis] + random.unit() * (BOX[1][axis] - BOX[0][axis]));
                let stretched = stretch.apply(world);
                (stretched, stretch.on_grid(stretched))
            };
            for _ in 0..200 {
                let [(stretched, p), (_, q), (_, r)] = [place(), place(), place()];
                assert_eq!(stretch.on_grid(p), p);
                let far = [0, 1].map(|axis| (p[axis] - stretched[axis]).abs() / stretch.step());
                assert!(far[0] <= 0.5 && far[1] <= 0.5, "{ratio} {angle}: {far:?}");
                let back = stretch.apply(stretch.undo(p));
                let far = (back[0] - p[0]).hypot(back[1] - p[1]);
                assert!(far < 1e-7 * extent, "{ratio} {angle}: {far}");
                // The same line through two places, and the same sides of it.
                let middle = stretch.on_grid([0, 1].map(|axis| p[axis].midpoint(q[axis])));
                for r in [r, middle, [p[0], q[1]]] {
                    let own = predicates.orient2d(p, q, r);
                    let [p, q, r] = [p, q, r].map(|place| stretch.undo(place));
                    assert_eq!(predicates.orient2d(p, q, r), own, "{ratio} {angle}");
                }
                let row = [p, q, r].map(|place| stretch.undo([place[0], p[1]]));
                assert_eq!(predicates.orient2d(row[0], row[1], row[2]), Sign::Zero);
            }
        }
    }

    #[test]
    fn flags_are_read() {
        assert_eq!("4:30".parse(), Ok(Anisotropy::Ratio(4.0, 30.0)));
        assert_eq!("0.5".parse(), Ok(Anisotropy::Ratio(0.5, 0.0)));
        assert_eq!("auto".parse(), Ok(Anisotropy::Auto));
        for text in ["0", "-1", "nan", "4:", "4:x", "automatic", "1e300", "101:30"] {
            assert!(text.parse::<Anisotropy>().is_err(), "{text}");
        }
    }
}
