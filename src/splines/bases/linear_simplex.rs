//! Simplex splines of degrees 0 and 1 in closed form, and the linear factors of functions in them.
//!
//! A simplex spline of degree 1 is the length of the vertical chords of a tetrahedron, a concave function on
//! its support. It is the least of linear functions, one for each edge ab of the hull of its four knots,
//!
//! ```text
//! area(x, a, b) / (area(a, b, c) area(a, b, d)),    c and d the other knots,
//! ```
//!
//! because next to ab only the triangles abc and abd remain in the recurrence. It is greatest over the fourth
//! knot, or over the crossing of the diagonals, and there it is one over the area of the hull. If c or d is
//! on ab, there is no such function: the edge is a *wall*, at which the spline jumps to zero. A simplex
//! spline of degree 0 has three walls and a constant value.

use super::directional_limit::DirectionalLimit;
use super::elements::{Elements, hull_edges};
use spmesh_delaunay::predicates::{Extent, Point2, Sign, area, exact_area};

/// The error relative to the greatest value from which on closed forms are not accurate enough. It is a
/// bound: actual errors are at most a tenth of it.
const TOLERATED: f64 = f64::EPSILON * 512.0;
/// A linear function is off by at most six roundings of 2^-53 if its constant is off by two; the rest is
/// margin.
const ROUNDINGS: f64 = 4.0 * f64::EPSILON;

/// A linear function of the offset from some origin: constant, and factors of x and y.
pub(super) type Line = [f64; 3];

#[inline(always)]
pub(super) fn value(line: &Line, offset: Point2) -> f64 {
    line[0] + line[1] * offset[0] + line[2] * offset[1]
}

/// A simplex spline of degree 0 or 1, times the area of its support, so that it is at most one.
///
/// Shape: two cache lines, of which the first is enough for points outside of the box.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct LinearSimplex {
    /// Middle of the box of the support.
    pub(super) origin: Point2,
    /// Half the sides of the box, rounded up.
    reach: [f32; 2],
    /// Bound of the error of edges in the box, rounded up.
    error: f32,
    /// Bit mask of the lines that are walls.
    walls: u8,
    /// Whether the lines are accurate enough for values, not only as a filter for the sides of edges.
    pub(super) is_exact_enough: bool,
    /// Linear functions that are positive inside, one for each edge, stored coefficient by coefficient. With
    /// three edges, the fourth function is a constant.
    lines: [[f64; 4]; 3],
}

/// Whether a point is in the support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    Outside,
    /// The value in plain arithmetic.
    Inside(f64),
    /// Too near to an edge for plain arithmetic; holds the value for a point that is inside.
    Unclear(f64),
}

impl LinearSimplex {
    /// Domain: three or four knots, not all on one line, and the area of their hull.
    pub(super) fn new(knots: &[Point2], edges: &[[Point2; 2]], size: f64) -> LinearSimplex {
        let (origin, reach) = middle(knots);
        let wide = reach.map(f64::from);
        // With three edges, the fourth function is one for a triangle, and never the least for a tetrahedron.
        let mut all = [[if knots.len() == 3 { 1.0 } else { f64::INFINITY }, 0.0, 0.0]; 4];
        let (mut walls, mut error, mut error_of_values) = (0, ROUNDINGS, 0f64);
        for (at, &edge) in edges.iter().enumerate().take(4) {
            let factor = slope(knots, edge);
            all[at] = scaled(line_of(edge, origin), factor.map_or(1.0 / size, |factor| factor * size));
            let bound = ROUNDINGS * magnitude(&all[at], wide);
            error = error.max(bound);
            match factor {
                Some(_) => error_of_values = error_of_values.max(bound),
                None => walls |= 1 << at,
            }
        }
        // Inside the box, the terms of the area of a triangle sum to at most the area of the box.
        let of_factors = ROUNDINGS * 4.0 * wide[0] * wide[1] / size;
        let is_exact_enough = error_of_values <= TOLERATED && of_factors <= TOLERATED;
        let lines = [0, 1, 2].map(|coefficient| all.map(|line| line[coefficient]));
        LinearSimplex { origin, reach, error: rounded_up(error), walls, is_exact_enough, lines }
    }

    /// The offset of a point from the origin.
    #[inline(always)]
    pub(super) fn offset(&self, x: Point2) -> Point2 {
        [x[0] - self.origin[0], x[1] - self.origin[1]]
    }

    /// Abscissae that enclose the support.
    pub(super) fn range(&self) -> [f64; 2] {
        let half = f64::from(self.reach[0]);
        [self.origin[0] - half, self.origin[0] + half]
    }

    /// Linear functions that are positive inside, one for each edge of the support.
    pub(super) fn edges(&self) -> [Line; 4] {
        [0, 1, 2, 3].map(|at| self.lines.map(|coefficients| coefficients[at]))
    }

    /// Linear functions whose least value is the value of the spline inside; infinite for walls.
    pub(super) fn lines_of_values(&self) -> [Line; 4] {
        let edges = self.edges();
        [0, 1, 2, 3].map(|at| if self.is_wall(at) { [f64::INFINITY, 0.0, 0.0] } else { edges[at] })
    }

    #[inline(always)]
    fn is_wall(&self, at: usize) -> bool {
        self.walls >> at & 1 == 1
    }

    /// Bound of the error of edges in the box of the support.
    #[inline(always)]
    pub(super) fn error(&self) -> f64 {
        f64::from(self.error)
    }

    /// The linear function that the spline is next to an offset at which it is [`Found::Inside`]; `None` if
    /// rounding could confuse it with another one.
    pub(super) fn piece(&self, offset: Point2) -> Option<Line> {
        let values = self.values(offset);
        let (mut least, mut next, mut place) = (f64::INFINITY, f64::INFINITY, 0);
        for (at, &value) in values.iter().enumerate().filter(|&(at, _)| !self.is_wall(at)) {
            if value < least {
                (least, next, place) = (value, least, at);
            } else {
                next = lesser(next, value);
            }
        }
        (next - least > 2.0 * self.error()).then(|| self.lines.map(|coefficients| coefficients[place]))
    }

    #[inline(always)]
    fn values(&self, [right, up]: Point2) -> [f64; 4] {
        let [constants, along, across] = &self.lines;
        std::array::from_fn(|at| constants[at] + along[at] * right + across[at] * up)
    }

    /// The value at an offset from the origin.
    #[inline(always)]
    pub(super) fn find(&self, offset: Point2) -> Found {
        let [right, up] = offset;
        if right.abs() > f64::from(self.reach[0]) || up.abs() > f64::from(self.reach[1]) {
            return Found::Outside;
        }
        let values = self.values(offset);
        let least = lesser(lesser(values[0], values[1]), lesser(values[2], values[3]));
        if least < -self.error() {
            return Found::Outside;
        }
        let height = if self.walls == 0 { least } else { self.height(values) };
        if least > self.error() { Found::Inside(height) } else { Found::Unclear(height.max(0.0)) }
    }

    /// The least value of the edges that are not walls.
    #[inline]
    fn height(&self, values: [f64; 4]) -> f64 {
        let heights = values.into_iter().enumerate().filter(|&(at, _)| !self.is_wall(at));
        heights.fold(f64::INFINITY, |least, (_, value)| lesser(least, value))
    }
}

/// The lesser of two numbers. Unlike `f64::min` it has no rule for NaN, which saves instructions.
#[inline(always)]
pub(super) fn lesser(p: f64, q: f64) -> f64 {
    if p < q { p } else { q }
}

/// The least f32 that is not below an f64.
fn rounded_up(number: f64) -> f32 {
    let near = number as f32;
    if f64::from(near) < number { near.next_up() } else { near }
}

/// Whether a directional limit is inside the hull of knots.
#[cold]
pub(super) fn is_inside(at: &DirectionalLimit, knots: &[Point2]) -> bool {
    hull_edges(knots).iter().all(|&[p, q]| at.side(p, q) == Sign::Positive)
}

/// Middle of the bounding box and half of its sides, rounded up.
fn middle(points: &[Point2]) -> (Point2, [f32; 2]) {
    let Extent { lower, upper, .. } = Extent::of(points);
    let origin = [0, 1].map(|axis| lower[axis].midpoint(upper[axis]));
    let half = |axis: usize| (upper[axis] - origin[axis]).max(origin[axis] - lower[axis]);
    (origin, [0, 1].map(|axis| rounded_up(half(axis))))
}

/// For an edge, the factor of `area(x, a, b)` in its linear function; `None` for a wall.
pub(super) fn slope(knots: &[Point2], [a, b]: [Point2; 2]) -> Option<f64> {
    let [first, second] = [a, b].map(|end| knots.iter().position(|&knot| knot == end));
    let others = (0..knots.len()).filter(|&at| Some(at) != first && Some(at) != second);
    let product: f64 = others.map(|at| area(a, b, knots[at])).product();
    (knots.len() == 4 && product != 0.0).then(|| 1.0 / product)
}

/// `area(x, a, b)` as a function of the offset from an origin.
pub(super) fn line_of([a, b]: [Point2; 2], origin: Point2) -> Line {
    [exact_area(origin, a, b), 0.5 * (a[1] - b[1]), 0.5 * (b[0] - a[0])]
}

pub(super) fn scaled(line: Line, factor: f64) -> Line {
    line.map(|coefficient| coefficient * factor)
}

/// A bound of the sum of the magnitudes of terms in a box around the origin.
fn magnitude(line: &Line, reach: Point2) -> f64 {
    line[0].abs() + line[1].abs() * reach[0] + line[2].abs() * reach[1]
}

/// Linear factors of functions in elements, as functions of the offset from the origin of the closed form.
#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    pub(super) offsets: Vec<u32>,
    pub(super) all: Vec<(u32, Line)>,
}

impl Factors {
    /// The factors of elements that have closed forms; `sizes` are the areas of their supports.
    pub(super) fn of(
        elements: &Elements,
        linear_simplices: &[LinearSimplex],
        sizes: &[f64],
        points: &[Point2],
    ) -> Factors {
        let mut factors = Factors { offsets: vec![0], all: Vec::new() };
        for (at, (linear_simplex, size)) in linear_simplices.iter().zip(sizes).enumerate() {
            for shares in elements.shares(at).chunk_by(|a, b| a.function == b.function) {
                let mut sum = [0.0; 3];
                for share in shares {
                    let edge = share.edge.map(|id| points[id as usize]);
                    let line = scaled(line_of(edge, linear_simplex.origin), share.factor / size);
                    sum = [0, 1, 2].map(|place| sum[place] + line[place]);
                }
                factors.all.push((shares[0].function, sum));
            }
            factors.offsets.push(factors.all.len() as u32);
        }
        factors
    }

    #[inline(always)]
    pub(super) fn of_element(&self, element: usize) -> &[(u32, Line)] {
        &self.all[self.offsets[element] as usize..self.offsets[element + 1] as usize]
    }
}
