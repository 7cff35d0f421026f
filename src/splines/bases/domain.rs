//! Where all functions sum to one.
//!
//! Functions of degree k from links of configurations of degree k - 1 reproduce polynomials in the *domain*:
//! the points x such that every closed half-plane that contains x contains at least k knots. (Simplex splines
//! of configurations of degree k need k + 1 knots. Functions of degree 0 have the domain of degree 1, the
//! convex hull.)
//!
//! *Why they do.* Take a polynomial with the polar form P. The sum over all links of P(J) times the B-spline
//! of J, rearranged by configurations, is the sum of P(I, x) N(x | B, I) over the configurations (B, I) of
//! degree k - 1, as in thesis 6.2.2. The links of degree k - 1 with the polar form P(., x) give this sum,
//! too, except for the infinite configurations (p, q, I). These add terms that vanish unless x is in the hull
//! of I, p and q, to the left of the line from p to q. No point of the domain is strictly left of a line with
//! fewer than k knots to its left. So all degrees down to 0 give the same sum, and configurations of degree 0
//! are a triangulation.
//!
//! *How it is found.* A point is in the domain if it is not strictly left of the line of any infinite
//! configuration of degree k - 1. If x is left of such a line, then the parallel to the line through x has
//! only knots to its left, or on it, that are left of the line: fewer than k. For the converse, let n(t) be
//! the unit vector in the direction t, let s(t) be the k-th greatest scalar product of n(t) with a knot, and
//! let g(t) be the scalar product of n(t) with x, minus s(t). Then x is in the domain if g is nowhere
//! positive. While the k-th knot stays the same, g'' + g is zero. Where it changes from p to q, both are on a
//! line with the normal n(t). Either this line is an infinite configuration, with k - 1 knots to its left; or
//! k - 2 knots are to its left, then s is the lesser of the products of p and q nearby, and the slope of g
//! increases. Now let g be positive somewhere, but not at any infinite configuration. Then g'' + g is not
//! negative on the interval where g is positive, so the length of the interval is at least pi (Sturm). It is
//! greater than pi, because a single knot cannot be the k-th for half a circle of directions unless all knots
//! are on one line. So g is positive in two opposite directions: fewer than k knots are on either side of the
//! line through x, knots on the line included, and there are at most 2k - 2 knots. With so few knots the
//! domain is empty. Copies, and several knots on a line, are limits of knots that are moved.
//!
//! *Narrow* functions have knots on one line except for rounding.
//! If a straight border is rotated, rounding moves its knots off the line. Functions of these knots then have
//! supports as wide as rounding errors. They are needed there for functions to sum to one, but no observation
//! determines them.

use super::basis::Basis;
use super::directional_limit::DirectionalLimit;
use spmesh_configurations::{Configurations, Knots};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, area};

/// The intersection of the closed half-planes to the right of directed lines.
#[derive(Debug, Clone)]
pub(super) struct Domain {
    pub(super) lines: Vec<[Point2; 2]>,
    /// A point of the interior, if there is one.
    pub(super) inner: Point2,
    /// Whether there are too few knots for a domain: at most 2k - 2.
    pub(super) is_empty: bool,
}

impl Domain {
    /// The domain of functions of the links of configurations, or of the triangles of degree 0.
    pub(super) fn of(knots: &Knots, configurations: &Configurations) -> Domain {
        let infinite = configurations.groups().flat_map(|group| group.infinite);
        let lines = infinite.map(|&[p, q, _]| [knots.at(p), knots.at(q)]);
        let mut lines: Vec<[Point2; 2]> = lines.filter(|[p, q]| p != q).collect();
        lines.sort_unstable_by(|a, b| {
            a.as_flattened().partial_cmp(b.as_flattened()).unwrap_or(std::cmp::Ordering::Equal)
        });
        lines.dedup();
        let count = knots.len() as f64;
        let mean = [0, 1].map(|axis| knots.points().iter().map(|point| point[axis] / count).sum());
        let needed = configurations.degree() + 1;
        let mut domain = Domain { lines, inner: mean, is_empty: knots.len() + 1 < 2 * needed };
        if !domain.has_inside(mean) {
            let found = domain.clipped(knots.points());
            domain.inner = found.filter(|&point| domain.has_inside(point)).unwrap_or(mean);
        }
        domain
    }

    /// The directional limit at x from inside the domain.
    #[inline(always)]
    pub(super) fn limit_at(&self, x: Point2) -> DirectionalLimit {
        DirectionalLimit::new(x, self.inner)
    }

    fn has_inside(&self, x: Point2) -> bool {
        let mut predicates = FiniteFloatPredicates::default();
        self.lines.iter().all(|&[p, q]| predicates.orient2d(p, q, x) == Sign::Negative)
    }

    /// The mean of the corners of the domain, in plain arithmetic.
    fn clipped(&self, points: &[Point2]) -> Option<Point2> {
        let polygon = self.corners(points);
        let count = polygon.len() as f64;
        (count > 0.0).then(|| [0, 1].map(|axis| polygon.iter().map(|corner| corner[axis] / count).sum()))
    }

    /// The corners of the domain of these knots, counterclockwise, in plain arithmetic.
    pub(super) fn corners(&self, points: &[Point2]) -> Vec<Point2> {
        let corner = |pick: fn(f64, f64) -> f64| {
            points.iter().copied().reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])])
        };
        let (Some([x, y]), Some([right, top])) = (corner(f64::min), corner(f64::max)) else {
            return Vec::new();
        };
        let mut polygon = vec![[x, y], [right, y], [right, top], [x, top]];
        for &[p, q] in &self.lines {
            polygon = cut(&polygon, [p, q]);
        }
        polygon
    }
}

/// Whether x is not to the left of a line.
pub(super) fn is_right_or_on([p, q]: [Point2; 2], x: Point2) -> bool {
    FiniteFloatPredicates::default().orient2d(p, q, x) != Sign::Positive
}

/// The part of a convex polygon to the right of a line.
fn cut(polygon: &[Point2], [p, q]: [Point2; 2]) -> Vec<Point2> {
    let depth = |x: Point2| area(q, p, x);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (&a, &b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (at_a, at_b) = (depth(a), depth(b));
        if at_a >= 0.0 {
            kept.push(a);
        }
        if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
            let share = at_a / (at_a - at_b);
            kept.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
        }
    }
    kept
}

/// The greatest width of a support on a line, as a part of its length...
const WIDTH: f64 = 1e-9;
/// ...and of the greatest coordinate.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Basis {
    /// The numbers of the functions whose knots are on one line except for rounding, in order.
    ///
    /// Cost: a pass over all elements.
    pub(crate) fn narrow(&self) -> Vec<usize> {
        let mut knots = vec![Vec::new(); self.len()];
        for element in 0..self.elements.len() {
            for share in self.elements.shares(element) {
                knots[share.function as usize].extend_from_slice(self.elements.knots(element));
            }
        }
        let at = |ids: &[u32]| ids.iter().map(|&id| self.points[id as usize]).collect::<Vec<Point2>>();
        (0..self.len()).filter(|&function| is_narrow(&at(&knots[function]))).collect()
    }
}

fn is_narrow(points: &[Point2]) -> bool {
    let Some(&first) = points.first() else { return false };
    let distance = |p: Point2, q: Point2| (p[0] - q[0]).hypot(p[1] - q[1]);
    let last = points.iter().copied().max_by(|&p, &q| distance(first, p).total_cmp(&distance(first, q)));
    let last = last.unwrap_or(first);
    let length = distance(first, last);
    let width = points.iter().map(|&p| 2.0 * area(first, last, p).abs() / length).fold(0.0, f64::max);
    let size = points.iter().flatten().fold(0.0, |size: f64, c| size.max(c.abs()));
    width <= WIDTH * length + ROUNDING * size
}
