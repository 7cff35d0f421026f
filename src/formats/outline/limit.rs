//! A limit on the length of edges.

use spmesh_stream::Coordinates;
use spmesh_stream::model::decimal::digits;
use spmesh_stream::model::points::Point2;

/// Relative tolerance of lengths that are computed in f64, so that edges exactly at the limit pass however
/// their length is rounded.
const TOLERANCE: f64 = 1e-12;

/// The greatest length of an edge that is not long. Edges are given in stored coordinates.
///
/// Integer coordinates are compared exactly: the limit and the step of the grid stand for the shortest decimals
/// that denote them, and squares of lengths are integers. Lengths of other coordinates are computed in f64, and
/// edges within 10^-12 of the limit are not long.
#[derive(Debug, Clone, Copy)]
pub struct EdgeLimit(Longest);

#[derive(Debug, Clone, Copy)]
enum Longest {
    /// No edge is long.
    Unlimited,
    /// The greatest square. Units: squares of steps.
    Steps(u128),
    /// The greatest length in the world, with the scale of each axis.
    World(f64, Point2),
}

impl EdgeLimit {
    /// Edges longer than `length` are long; none are if it is `None`. Units: those of the world.
    pub fn new(length: Option<f64>, coordinates: &Coordinates) -> EdgeLimit {
        let Some(length) = length.filter(|length| length.is_finite()) else {
            return EdgeLimit(Longest::Unlimited);
        };
        let rounded = length * (1.0 + TOLERANCE);
        EdgeLimit(match coordinates {
            Coordinates::F64 => Longest::World(rounded, [1.0; 2]),
            Coordinates::I32 { scale: [x, y, _], .. } => {
                let steps = if x == y { squared_steps(length, *x) } else { None };
                steps.map_or(Longest::World(rounded, [*x, *y]), Longest::Steps)
            }
        })
    }

    /// Whether there is a limit.
    pub fn is_limited(&self) -> bool {
        !matches!(self.0, Longest::Unlimited)
    }

    /// The greatest length of an edge that is not long, in stored units of x; 0 without a limit.
    pub fn stored_length(&self) -> f64 {
        match self.0 {
            Longest::Unlimited => 0.0,
            // Rounded up, so that its square is not less.
            Longest::Steps(most) => (most as f64).sqrt().next_up(),
            Longest::World(longest, [scale, _]) => (longest / scale).min(f64::MAX),
        }
    }

    /// Whether an edge is long.
    #[inline]
    pub fn is_long(&self, a: Point2, b: Point2) -> bool {
        match self.0 {
            Longest::Unlimited => false,
            Longest::Steps(most) => {
                // Differences of 32-bit integers are exact in f64.
                let [x, y] = [0, 1].map(|axis| u128::from((b[axis] - a[axis]).abs() as u64));
                x * x + y * y > most
            }
            Longest::World(longest, scale) => {
                let [x, y] = [0, 1].map(|axis| (b[axis] - a[axis]) * scale[axis]);
                x.hypot(y) > longest
            }
        }
    }

    /// Which edges of a triangle are long; edge i leads from corner i to the next.
    #[inline]
    pub fn long_edges(&self, [a, b, c]: [Point2; 3]) -> [bool; 3] {
        [self.is_long(a, b), self.is_long(b, c), self.is_long(c, a)]
    }

    /// Whether a triangle has a long edge.
    #[inline]
    pub fn is_exceeded(&self, corners: [Point2; 3]) -> bool {
        self.is_limited() && self.long_edges(corners).contains(&true)
    }
}

/// The square of a length in steps, rounded down, which leaves comparisons with integers exact; `None` if there
/// are too many digits.
fn squared_steps(length: f64, step: f64) -> Option<u128> {
    let ((length, length_power), (step, step_power)) = (digits(length)?, digits(step.abs())?);
    let power = length_power.checked_sub(step_power)?;
    let shifted = |digits: i128, by: i32| -> Option<u128> {
        10u128.checked_pow(u32::try_from(by.max(0)).ok()?)?.checked_mul(u128::try_from(digits).ok()?)
    };
    let [length, step] = [shifted(length, power)?, shifted(step, -power)?];
    let [length, step] = [length.checked_mul(length)?, step.checked_mul(step)?];
    length.checked_div(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_at_the_limit_are_not_long_and_longer_ones_are() {
        for (length, step) in [(5.0, 0.01), (0.5, 0.001), (1.1, 0.1), (7.0, 0.25), (3.0, 1e-7)] {
            let coordinates = Coordinates::I32 { scale: [step; 3], offset: [0.0; 3] };
            let limit = EdgeLimit::new(Some(length), &coordinates);
            assert!(matches!(limit.0, Longest::Steps(_)));
            let at = (length / step).round();
            // Three, four, five.
            for end in [[at, 0.0], [0.0, -at], [0.6 * at, 0.8 * at]].map(|end| end.map(f64::round)) {
                let is_at = end[0] * end[0] + end[1] * end[1] <= at * at;
                assert_eq!(limit.is_long([0.0; 2], end), !is_at, "{length} {step} {end:?}");
            }
            assert!(limit.is_long([0.0; 2], [at, 1.0]));
        }
    }

    #[test]
    fn distances_of_the_whole_grid_are_exact() {
        let coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
        let [least, greatest] = [f64::from(i32::MIN), f64::from(i32::MAX)];
        // The square of the diagonal is 2 (2^32 - 1)^2, which has no f64.
        let limit = EdgeLimit::new(Some(f64::from(u32::MAX)), &coordinates);
        assert!(!limit.is_long([least, 0.0], [greatest, 0.0]));
        assert!(limit.is_long([least, 0.0], [greatest, 1.0]));
        assert!(!EdgeLimit::new(None, &coordinates).is_long([least; 2], [greatest; 2]));
    }

    #[test]
    fn numbers_with_many_digits_are_rounded() {
        let coordinates = Coordinates::I32 { scale: [1.0 / 3.0; 3], offset: [0.0; 3] };
        let limit = EdgeLimit::new(Some(1e30 + 1.0), &coordinates);
        assert!(!limit.is_long([0.0; 2], [3.0, 4.0]));
        let limit = EdgeLimit::new(Some(0.1), &Coordinates::F64);
        assert!(!limit.is_long([0.3, 0.0], [0.4, 0.0]) && limit.is_long([0.3, 0.0], [0.4001, 0.0]));
    }
}
