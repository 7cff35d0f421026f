//! Two triangulations separated by a line become one.

use super::divide::Cut;
use super::edges::{Edges, NIL};
use crate::predicates::{Point2, Predicates2, Sign};
use std::cmp::Ordering;

/// Handle of a triangulation: two half-edges of its counterclockwise hull, far from each other where possible.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hull {
    /// A vertex.
    pub(super) vertex: u32,
    /// A hull edge with the outer face to its right; [`NIL`] if there is one vertex only.
    pub(super) start: u32,
    /// Another.
    pub(super) end: u32,
}

impl Hull {
    pub(super) fn of_point(vertex: u32) -> Hull {
        Hull { vertex, start: NIL, end: NIL }
    }
}

/// What merging works on.
pub(super) struct Stitch<'a, 'e, P> {
    pub(super) points: &'a [Point2],
    pub(super) edges: &'a mut Edges<'e>,
    pub(super) predicates: &'a mut P,
}

/// A vertex of a hull and the hull edge that leaves it; the edge is [`NIL`] if the vertex is all there is.
#[derive(Clone, Copy)]
struct Tip {
    vertex: u32,
    edge: u32,
}

/// An end of the base, or the end of a candidate.
#[derive(Clone, Copy)]
struct Vertex {
    id: u32,
    at: Point2,
}

/// An edge from an end of the base to the first point above it, on the same side.
#[derive(Clone, Copy)]
struct Candidate {
    edge: u32,
    vertex: Vertex,
}

impl<P: Predicates2> Stitch<'_, '_, P> {
    #[inline(always)]
    fn orientation(&mut self, u: u32, v: u32, w: u32) -> Sign {
        self.predicates.orient2d(self.points[u as usize], self.points[v as usize], self.points[w as usize])
    }

    /// Merges `left` and `right`, which `cut` separates. "Left", "right", "low" and "up" are meant after the quarter
    /// turn of [`Cut::compare`] if it is horizontal; but for the two starting vertices nothing depends on it.
    pub(super) fn merge(&mut self, left: Hull, right: Hull, cut: Cut) -> Hull {
        let left = self.extreme(left, cut, Ordering::Greater);
        let right = self.extreme(right, cut, Ordering::Less);
        let low = self.lower_tangent(left, right);
        let high = self.rise(low);
        Hull { vertex: left.vertex, start: low, end: high ^ 1 }
    }

    /// Whether `e` leaves a vertex that is beyond the origin of `than` across the cut, in the direction wanted.
    #[inline(always)]
    fn is_further(&self, e: u32, than: u32, cut: Cut, wanted: Ordering) -> bool {
        let p = self.points[self.edges.origin(e) as usize];
        let q = self.points[self.edges.origin(than) as usize];
        cut.compare(p, q) == wanted
    }

    /// The vertex of a hull that comes last (`Greater`) or first (`Less`) across the cut.
    ///
    /// Along a convex polygon the order across the cut has one maximum and one minimum, also where boundary points
    /// are collinear and where the polygon is a chain passed twice: climbing finds the maximum. The edges of the
    /// last merge lie near the extremes across the other axis, so the climb is short if cuts alternate.
    fn extreme(&self, hull: Hull, cut: Cut, wanted: Ordering) -> Tip {
        if hull.start == NIL {
            return Tip { vertex: hull.vertex, edge: NIL };
        }
        let mut edge = if self.is_further(hull.end, hull.start, cut, wanted) { hull.end } else { hull.start };
        let mut next = self.edges.hull_next(edge);
        if self.is_further(next, edge, cut, wanted) {
            while self.is_further(next, edge, cut, wanted) {
                edge = next;
                next = self.edges.hull_next(edge);
            }
        } else {
            let mut previous = self.edges.hull_previous(edge);
            while self.is_further(previous, edge, cut, wanted) {
                edge = previous;
                previous = self.edges.hull_previous(edge);
            }
        }
        Tip { vertex: self.edges.origin(edge), edge }
    }

    /// Adds the lower common tangent of two hulls and returns it, directed from left to right.
    ///
    /// Starts at the extreme vertices and moves down while that is strictly below: among collinear vertices the
    /// tangent joins the two innermost.
    fn lower_tangent(&mut self, mut left: Tip, mut right: Tip) -> u32 {
        // Each step moves one way along one hull; the limit only matters if the points were not separated.
        for _ in 0..=2 * self.points.len() {
            if left.edge != NIL {
                let previous = self.edges.hull_previous(left.edge);
                let below = self.edges.origin(previous);
                if self.orientation(left.vertex, below, right.vertex) == Sign::Positive {
                    left = Tip { vertex: below, edge: previous };
                    continue;
                }
            }
            if right.edge != NIL {
                let below = self.edges.destination(right.edge);
                if self.orientation(right.vertex, below, left.vertex) == Sign::Negative {
                    right = Tip { vertex: below, edge: self.edges.hull_next(right.edge) };
                    continue;
                }
            }
            break;
        }
        let after = if left.edge == NIL { NIL } else { self.edges.oprev(left.edge) };
        self.edges.connect(left.vertex, after, right.vertex, right.edge)
    }

    /// Fills the gap above `base`, an edge from left to right, and returns its last edge, the upper common tangent.
    fn rise(&mut self, base: u32) -> u32 {
        let Stitch { points, edges, predicates } = self;
        edges.locally(|edges| rise(points, edges, *predicates, base))
    }
}

/// [`Stitch::rise`]. Each round joins the base to the first point that a circle through its ends meets when it grows
/// upwards. Edges of either side that this point cuts off are deleted.
#[inline(always)]
fn rise<P: Predicates2>(points: &[Point2], edges: &mut Edges, predicates: &mut P, mut base: u32) -> u32 {
    let vertex = |id: u32| Vertex { id, at: points[id as usize] };
    let (mut u, mut v) = (vertex(edges.origin(base)), vertex(edges.destination(base)));
    loop {
        let left = candidate::<true, P>(points, edges, predicates, base, u, v);
        let right = candidate::<false, P>(points, edges, predicates, base ^ 1, u, v);
        let right_wins = match (left, right) {
            (None, None) => return base,
            (Some(_), None) => false,
            (None, Some(_)) => true,
            (Some(left), Some(right)) => is_in_circle(predicates, [u, v, left.vertex], right.vertex),
        };
        base = if right_wins {
            let Some(right) = right else { return base };
            v = right.vertex;
            edges.connect(u.id, base, v.id, right.edge ^ 1)
        } else {
            let Some(left) = left else { return base };
            u = left.vertex;
            edges.connect(u.id, left.edge ^ 1, v.id, base ^ 1)
        };
    }
}

/// The edge to the first point above the base from u, its left end, or from v. `base` is its half that leaves that
/// end.
///
/// A point that is not above the base is never in the circle, perturbed or not, so that a second edge needs no
/// test of its own; it only must not be the base itself.
#[inline(always)]
fn candidate<const FROM_LEFT: bool, P: Predicates2>(
    points: &[Point2],
    edges: &mut Edges,
    predicates: &mut P,
    base: u32,
    u: Vertex,
    v: Vertex,
) -> Option<Candidate> {
    let to = |edges: &Edges, edge: u32| {
        let id = edges.destination(edge);
        Candidate { edge, vertex: Vertex { id, at: points[id as usize] } }
    };
    let upwards = |edges: &Edges, e: u32| if FROM_LEFT { edges.onext(e) } else { edges.oprev(e) };
    let first = upwards(edges, base);
    if first == base {
        return None;
    }
    let mut found = to(edges, first);
    if predicates.orient2d(u.at, v.at, found.vertex.at) != Sign::Positive {
        return None;
    }
    loop {
        let next = upwards(edges, found.edge);
        if next == base {
            return Some(found);
        }
        let second = to(edges, next);
        if !is_in_circle(predicates, [u, v, found.vertex], second.vertex) {
            return Some(found);
        }
        edges.delete(found.edge);
        found = second;
    }
}

#[inline(always)]
fn is_in_circle<P: Predicates2>(predicates: &mut P, [u, v, w]: [Vertex; 3], x: Vertex) -> bool {
    predicates.incircle_perturbed(u.at, v.at, w.at, x.at) == Sign::Positive
}
