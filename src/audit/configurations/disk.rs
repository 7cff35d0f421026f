//! Circles of three knots, with rounded tests for where they certainly are not.

use super::Knots;
use crate::exact::plane::Xy;

/// Sizes between which no product underflows or overflows.
const LEAST: f64 = 1e-70;
const GREATEST: f64 = 1e70;
/// Bound on the relative rounding error of a sum of products.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The inside of a circle: where `slope y - curve y²` is positive, with `y = x - origin`.
///
/// For a circle through knots at one place, which are moved symbolically, these are the terms of lowest
/// order.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disk {
    origin: Xy,
    slope: Xy,
    curve: f64,
    /// Magnitudes of the products that slope and curve are sums of; `None` if out of range.
    sizes: Option<[f64; 2]>,
}

impl Disk {
    /// The disk of knots, counterclockwise.
    pub(super) fn of(knots: &Knots, boundary: [u32; 3]) -> Disk {
        let at = boundary.map(|id| knots.points()[id as usize]);
        // Knots at one place come first.
        let first = (0..3).find(|&i| at[i] == at[(i + 1) % 3]).unwrap_or(0);
        let turned = |i: usize| (first + i) % 3;
        let (origin, rank) = (at[turned(0)], |i: usize| f64::from(knots.rank(boundary[turned(i)])));
        let moved = |i: usize| [rank(i) - rank(0), rank(i) * rank(i) - rank(0) * rank(0)];
        let to = |i: usize| [0, 1].map(|axis| at[turned(i)][axis] - origin[axis]);
        let is_same = |i: usize| at[turned(i)] == origin;
        let (p, q) = (if is_same(1) { moved(1) } else { to(1) }, if is_same(2) { moved(2) } else { to(2) });
        // Squares of lengths; zero for symbolic moves, whose squares are of higher order.
        let (k, l) = (if is_same(1) { 0.0 } else { square(p) }, if is_same(2) { 0.0 } else { square(q) });
        let slope = [q[1] * k - p[1] * l, p[0] * l - q[0] * k];
        let curve = p[0] * q[1] - p[1] * q[0];
        let lengths = [p, q].map(|[x, y]| x.hypot(y));
        let is_sure = lengths.iter().all(|length| (LEAST..GREATEST).contains(length));
        let sizes = [lengths[1] * k + lengths[0] * l, lengths[0] * lengths[1]];
        Disk { origin, slope, curve, sizes: is_sure.then_some(sizes) }
    }

    /// Whether a point of a box, from least to greatest coordinates, may be inside of the circle or on it.
    pub(super) fn may_meet(&self, [low, high]: [Xy; 2]) -> bool {
        let Some([slope_size, curve_size]) = self.sizes else { return true };
        let (mut greatest, mut far) = (0.0, 0.0);
        for axis in 0..2 {
            let ends = [low, high].map(|corner| corner[axis] - self.origin[axis]);
            let value = |y: f64| (self.slope[axis] - self.curve * y) * y;
            let top = self.slope[axis] / (2.0 * self.curve);
            let is_between = self.curve > 0.0 && ends[0] < top && top < ends[1];
            let inner = if is_between { value(top) } else { f64::NEG_INFINITY };
            greatest += value(ends[0]).max(value(ends[1])).max(inner);
            far += ends[0].abs().max(ends[1].abs());
        }
        let lost = ROUNDING * (slope_size + curve_size * far) * far;
        // NaN compares false.
        let is_outside = far < GREATEST && greatest < -lost;
        !is_outside
    }
}

fn square([x, y]: Xy) -> f64 {
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_away_from_the_circle_are_told() {
        let knots = Knots::new(vec![[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0], [0.0, 0.0]]).unwrap();
        let unit = |x: f64, y: f64| [[x, y], [x + 0.5, y + 0.5]];
        let whole = Disk::of(&knots, [0, 1, 2]);
        for (x, y, meets) in [(0.5, 0.5, true), (2.0, 2.0, true), (2.1, 2.1, false), (-1.0, 1.0, false)] {
            assert_eq!(whole.may_meet(unit(x, y)), meets, "{x}, {y}");
        }
        assert!(whole.may_meet([[-9.0; 2], [9.0; 2]]));
        // The tangent at the origin is the diagonal, where copies move to: from 0 to 3, and on to the knot.
        let tangent = Disk::of(&knots, [0, 1, 3]);
        assert!(tangent.may_meet(unit(1.0, -0.6)) && !tangent.may_meet(unit(1.0, 1.6)));
        assert!(!tangent.may_meet(unit(-1.0, 0.2)));
        let point = Disk::of(&knots, [0, 3, 4]);
        assert!(point.may_meet(unit(-0.1, -0.1)) && !point.may_meet(unit(0.1, 0.1)));
        let tiny = Knots::new(vec![[0.0, 0.0], [2e-200, 0.0], [0.0, 2e-200]]).unwrap();
        assert!(Disk::of(&tiny, [0, 1, 2]).may_meet(unit(5.0, 5.0)));
    }
}
