//! Simplex splines of degrees 0 and 1 in closed form.
//!
//! That of degree 1 is the length of the vertical chords of a tetrahedron, a concave function on its support: the least of
//! linear functions, one for each edge ab of the hull of its four knots,
//!
//! ```text
//! area(x, a, b) / (area(a, b, c) area(a, b, d)),    c and d the other knots,
//! ```
//!
//! because next to ab only the triangles abc and abd are left of the recurrence. It is greatest over the fourth knot or over
//! the crossing of the diagonals, and there it is one over the area of the hull. If c or d is on ab, there is no such
//! function: the edge is a *wall*, at which the spline jumps to zero. A triangle has three walls, and is capped by a
//! constant.

use super::approach::Approach;
use super::area::{area, exact_area};
use super::elements::{HullEdge, hull_area, hull_edges};
use crate::predicates::{Point2, Sign};

/// Relative to the greatest value, the error from which on linear functions are not good enough. It is a bound: errors that
/// occur are a tenth of it, and less.
const TOLERATED: f64 = f64::EPSILON * 512.0;
/// A linear function is off by six roundings of 2^-53 at most, if its constant is off by two; and some more.
const ROUNDINGS: f64 = 4.0 * f64::EPSILON;

/// A linear function of the offset from some origin: constant, and factors of x and y.
pub(super) type Line = [f64; 3];

#[inline(always)]
pub(super) fn value(line: &Line, offset: Point2) -> f64 {
    line[0] + line[1] * offset[0] + line[2] * offset[1]
}

/// A simplex spline of degree 0 or 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tent {
    /// Middle of the box of the support.
    pub(super) origin: Point2,
    /// Half the sides of the box, rounded up.
    pub(super) reach: Point2,
    /// Positive inside; an infinite constant takes the place of a fourth edge.
    lines: [Line; 4],
    /// Which of these are walls.
    is_wall: [bool; 4],
    /// What the value is at most: it has no meaning for degree 1.
    cap: f64,
    /// How far values of lines may be from the truth in the box.
    error: f64,
    /// Whether lines are good enough for values, and not just as a filter for the sides of edges.
    pub(super) is_exact_enough: bool,
}

/// Whether a point is in the support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    Outside,
    /// With the value in plain arithmetic.
    Inside(f64),
    /// Too near to an edge for plain arithmetic; with the value if it is inside.
    Unclear(f64),
}

impl Tent {
    /// Domain: three or four knots, not all on one line.
    pub(super) fn new(knots: &[Point2]) -> Tent {
        let edges = hull_edges(knots);
        let size = hull_area(&edges);
        let (origin, reach) = middle(knots);
        let greatest = 1.0 / size;
        let cap = if knots.len() == 3 { greatest } else { f64::INFINITY };
        let (mut lines, mut is_wall) = ([[f64::INFINITY, 0.0, 0.0]; 4], [false; 4]);
        let (mut error, mut error_of_values) = (0f64, 0f64);
        for (at, edge) in edges.iter().enumerate().take(4) {
            let factor = slope(edge);
            is_wall[at] = factor.is_none();
            lines[at] = scaled(line_of(edge.ends, origin), factor.unwrap_or(greatest / size));
            let bound = ROUNDINGS * magnitude(&lines[at], reach);
            error = error.max(bound);
            error_of_values = if is_wall[at] { error_of_values } else { error_of_values.max(bound) };
        }
        // The terms of the area of a triangle in the box sum to its area at most.
        let of_factors = ROUNDINGS * 4.0 * reach[0] * reach[1] * greatest;
        let is_exact_enough = error_of_values <= TOLERATED * greatest && of_factors <= TOLERATED;
        Tent { origin, reach, lines, is_wall, cap, error, is_exact_enough }
    }

    /// Where a point is, seen from the origin.
    #[inline(always)]
    pub(super) fn offset(&self, x: Point2) -> Point2 {
        [x[0] - self.origin[0], x[1] - self.origin[1]]
    }

    /// Linear functions that are positive inside, one for each edge of the support; infinite ones for edges that are not.
    pub(super) fn edges(&self) -> [Line; 4] {
        self.lines
    }

    /// Linear functions of which the least, if it is less than the cap, is the value inside.
    pub(super) fn lines_of_values(&self) -> [Line; 4] {
        let line = |at: usize| if self.is_wall[at] { [f64::INFINITY, 0.0, 0.0] } else { self.lines[at] };
        [0, 1, 2, 3].map(line)
    }

    /// What the value is at most.
    pub(super) fn cap(&self) -> f64 {
        self.cap
    }

    /// How far edges may be from the truth in the box of the support.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// The linear function that the spline is in the neighbourhood of an offset, at which it is [`Found::Inside`]; nothing
    /// if rounding might confuse it with another one.
    pub(super) fn piece(&self, offset: Point2) -> Option<Line> {
        let (mut least, mut next, mut piece) = (self.cap, f64::INFINITY, [self.cap, 0.0, 0.0]);
        for line in self.lines_of_values() {
            let value = value(&line, offset);
            if value < least {
                (least, next, piece) = (value, least, line);
            } else {
                next = next.min(value);
            }
        }
        (next - least > 2.0 * self.error).then_some(piece)
    }

    /// The value at an offset from the origin.
    #[inline(always)]
    pub(super) fn find(&self, offset: Point2) -> Found {
        if offset[0].abs() > self.reach[0] || offset[1].abs() > self.reach[1] {
            return Found::Outside;
        }
        let (mut least, mut height) = (f64::INFINITY, self.cap);
        for (line, is_wall) in self.lines.iter().zip(self.is_wall) {
            let value = value(line, offset);
            least = least.min(value);
            height = if is_wall { height } else { height.min(value) };
        }
        if least > self.error {
            Found::Inside(height)
        } else if least < -self.error {
            Found::Outside
        } else {
            Found::Unclear(height.max(0.0))
        }
    }
}

/// Whether a point, as it is approached, is inside of the hull of knots.
#[cold]
pub(super) fn is_inside(at: &Approach, knots: &[Point2]) -> bool {
    hull_edges(knots).iter().all(|edge| at.side(edge.ends[0], edge.ends[1]) == Sign::Positive)
}

/// Middle of the bounding box and half of its sides, rounded up.
pub(super) fn middle(points: &[Point2]) -> (Point2, Point2) {
    let least = |axis: usize| points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
    let greatest = |axis: usize| points.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
    let origin = [0, 1].map(|axis| least(axis).midpoint(greatest(axis)));
    let reach = [0, 1].map(|axis| {
        let half = (greatest(axis) - origin[axis]).max(origin[axis] - least(axis));
        half + half * f64::EPSILON
    });
    (origin, reach)
}

/// What the area of x and the edge is multiplied by, unless the edge is a wall.
fn slope(edge: &HullEdge) -> Option<f64> {
    let &[c, d] = &edge.others[..] else { return None };
    let [a, b] = edge.ends;
    let product = area(a, b, c) * area(a, b, d);
    (product != 0.0).then(|| 1.0 / product)
}

/// `area(x, a, b)` as a function of the offset from an origin.
pub(super) fn line_of([a, b]: [Point2; 2], origin: Point2) -> Line {
    [exact_area(origin, a, b), 0.5 * (a[1] - b[1]), 0.5 * (b[0] - a[0])]
}

pub(super) fn scaled(line: Line, factor: f64) -> Line {
    line.map(|coefficient| coefficient * factor)
}

/// The sum of the magnitudes of terms, at most, in a box around the origin.
fn magnitude(line: &Line, reach: Point2) -> f64 {
    line[0].abs() + line[1].abs() * reach[0] + line[2].abs() * reach[1]
}
