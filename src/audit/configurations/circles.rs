//! Checks that circles contain the right knots, with rounded tests for where circles certainly are not.

use std::cmp::Ordering;

use super::planar::Tree;
use super::{Configurations, Knots};
use crate::exact::dyadic::integers;
use crate::exact::plane::{Xy, in_circle, in_raised_circle, orientation};
use num_bigint::BigInt;
use spmesh_base::error::{Error, ErrorKind, Result};

/// Checks that the circle of every boundary has its interior set inside, and no other knot; ties are broken
/// as the canonical triangulation does, and the j-th knot at a place is taken to be at `p + e (j, j * j)` for
/// a small number e.
///
/// Infinite configurations are not checked.
///
/// Cost: for each configuration, the knots in boxes of a tree that its circle meets.
///
/// # Errors
/// The first violation (kind [`ErrorKind::Audit`]).
pub fn check_circles(knots: &Knots, configurations: &Configurations) -> Result<()> {
    let tree = Tree::of(knots.points());
    for (boundary, interior) in configurations.finite() {
        let fail = |what: String| {
            Err(Error::new(ErrorKind::Audit, what).at(format!("configuration {boundary:?}, {interior:?}")))
        };
        if boundary.iter().chain(interior).any(|&id| id as usize >= knots.len()) {
            return fail("a knot is unknown".into());
        }
        if turn(knots, boundary) != Ordering::Greater {
            return fail("the boundary is not counterclockwise".into());
        }
        let (mut inside, mut excess) = (0, None);
        tree.for_each_in(&Disk::of(knots, boundary), |id| {
            if !boundary.contains(&id) && is_inside(knots, boundary, id) {
                match interior.binary_search(&id) {
                    Ok(_) => inside += 1,
                    Err(_) => excess = Some(id),
                }
            }
            excess.is_none()
        });
        if let Some(id) = excess {
            return fail(format!("knot {id} is inside of the circle"));
        }
        if inside != interior.len() {
            return fail(format!("of the {} knots inside, only {inside} are", interior.len()));
        }
    }
    Ok(())
}

pub(super) fn turn(knots: &Knots, ids: [u32; 3]) -> Ordering {
    let [a, b, c] = ids.map(|id| knots.points()[id as usize]);
    match orientation(a, b, c).sign {
        Ordering::Equal => turn_of(&moved(knots, ids), [0, 1, 2]),
        sign => sign,
    }
}

fn is_inside(knots: &Knots, [a, b, c]: [u32; 3], d: u32) -> bool {
    let ids = [a, b, c, d];
    let [p, q, r, s] = ids.map(|id| knots.points()[id as usize]);
    let sign = match in_circle(p, q, r, s).sign {
        Ordering::Equal if ids.iter().any(|&id| knots.rank(id) > 0) => circle_of(&moved(knots, ids)),
        Ordering::Equal => in_raised_circle(p, q, r, s),
        sign => sign,
    };
    sign == Ordering::Greater
}

/// Positions scaled to integers, with e = 2^-shift: 1 / e exceeds all coefficients of a determinant of these
/// points, which are less than 2^(4 bits + 16) with ranks counted.
pub(super) fn moved<const N: usize>(knots: &Knots, ids: [u32; N]) -> [[BigInt; 2]; N] {
    let points = integers(ids.map(|id| knots.points()[id as usize]));
    let bits = points.as_flattened().iter().map(BigInt::bits).max().unwrap_or(0).max(64);
    let shift = 6 * bits + 400;
    std::array::from_fn(|i| {
        let rank = BigInt::from(knots.rank(ids[i]));
        [(&points[i][0] << shift) + &rank, (&points[i][1] << shift) + &rank * &rank]
    })
}

fn area<const N: usize>(points: &[[BigInt; 2]; N], [i, j, k]: [usize; 3]) -> BigInt {
    let [p, q, r] = [&points[i], &points[j], &points[k]];
    (&q[0] - &p[0]) * (&r[1] - &p[1]) - (&q[1] - &p[1]) * (&r[0] - &p[0])
}

fn turn_of<const N: usize>(points: &[[BigInt; 2]; N], places: [usize; 3]) -> Ordering {
    area(points, places).cmp(&BigInt::ZERO)
}

/// Side of the last point against the circle of the others, counterclockwise; by ranks if it is on it.
fn circle_of(points: &[[BigInt; 2]; 4]) -> Ordering {
    let coefficients = [[3, 1, 2], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
    let lift = |p: &[BigInt; 2]| &p[0] * &p[0] + &p[1] * &p[1];
    let sum: BigInt = (0..4).map(|i| lift(&points[i]) * area(points, coefficients[i])).sum();
    let mut ranked = [0, 1, 2, 3];
    ranked.sort_by(|&i, &j| points[j].cmp(&points[i]));
    let ties = ranked.iter().map(|&i| turn_of(points, coefficients[i]));
    let mut signs = std::iter::once(sum.cmp(&BigInt::ZERO)).chain(ties);
    signs.find(|&sign| sign != Ordering::Equal).unwrap_or(Ordering::Equal)
}

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
