//! Where a new point begins to change the triangulation: a triangle in conflict with it.

use super::half_edge::{HalfEdge, corner, next, previous, triangle_of};
use super::mesh::{INFINITE, Mesh};
use crate::predicates::{Point2, Predicates2, Sign, lexicographic};

/// Steps after which the exact walk takes over: rounding may lead the other one in circles.
const STEPS_MAX: usize = 10_000;

/// Where the walk to a point starts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) triangle: HalfEdge,
    /// The point is seen from corner 0 of the triangle through the opposite side.
    pub(super) is_seen: bool,
}

#[inline(always)]
pub(super) fn difference(p: Point2, q: Point2) -> Point2 {
    [p[0] - q[0], p[1] - q[1]]
}

#[inline(always)]
pub(super) fn cross(p: Point2, q: Point2) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// Walks from `start` to a triangle that probably contains `q`, in rounded arithmetic.
#[inline(always)]
pub(super) fn walk(mesh: &Mesh, mut start: Start, q: Point2) -> HalfEdge {
    // A triangle at the point that was inserted last has that point as its corner 0.
    let [_, second, third] = mesh.vertices(start.triangle);
    if second == INFINITE {
        start = Start { triangle: triangle_of(mesh.neighbour(start.triangle + 1)), is_seen: false };
    } else if third == INFINITE {
        start = Start { triangle: triangle_of(mesh.neighbour(start.triangle + 2)), is_seen: false };
    }
    let t = start.triangle;
    let [a, b, c] = mesh.vertices(t).map(|v| difference(mesh.point(v), q));
    // The side that q is behind: its half-edge beyond, and its ends.
    let (mut neighbour, mut p, mut r);
    if cross(b, c) < 0.0 {
        (neighbour, p, r) = (mesh.neighbour(t), b, c);
    } else if !start.is_seen && cross(c, a) < 0.0 {
        (neighbour, p, r) = (mesh.neighbour(t + 1), c, a);
    } else if !start.is_seen && cross(a, b) < 0.0 {
        (neighbour, p, r) = (mesh.neighbour(t + 2), a, b);
    } else {
        return t;
    }
    for _ in 0..STEPS_MAX {
        let apex = difference(mesh.point(mesh.opposite(neighbour)), q);
        let (is_left, is_right) = (cross(p, apex) < 0.0, cross(apex, r) < 0.0);
        if !(is_left | is_right) {
            break;
        }
        neighbour = mesh.neighbour(if is_left { next(neighbour) } else { previous(neighbour) });
        (p, r) = if is_left { (p, apex) } else { (apex, r) };
    }
    triangle_of(neighbour)
}

/// Walks from `t` to a triangle that contains `q`, exactly. In a Delaunay triangulation this walk ends.
#[cold]
#[inline(never)]
pub(super) fn walk_exactly<P: Predicates2>(
    mesh: &Mesh,
    mut t: HalfEdge,
    q: Point2,
    predicates: &mut P,
) -> HalfEdge {
    if let Some(side) = mesh.hull_side(t) {
        if is_in_conflict(mesh, t, q, predicates) {
            return t;
        }
        t = triangle_of(mesh.neighbour(side));
    }
    loop {
        let vertices = mesh.vertices(t);
        if vertices.contains(&INFINITE) {
            return t;
        }
        let [a, b, c] = vertices.map(|v| mesh.point(v));
        let mut is_beyond = |u, v| predicates.orient2d(u, v, q) == Sign::Negative;
        let side = match () {
            () if is_beyond(b, c) => t,
            () if is_beyond(c, a) => t + 1,
            () if is_beyond(a, b) => t + 2,
            () => return t,
        };
        t = triangle_of(mesh.neighbour(side));
    }
}

/// Whether `q`, which is no vertex, lies in the circle of triangle `t`, ties broken by the canonical
/// perturbation.
///
/// The circle of an infinite triangle is the open half-plane beyond its edge of the hull, and that edge: a
/// point on its line but off the edge is in the circle if it is in that of the triangle on the other side,
/// which it is not.
#[cold]
#[inline(never)]
pub(super) fn is_in_conflict<P: Predicates2>(
    mesh: &Mesh,
    t: HalfEdge,
    q: Point2,
    predicates: &mut P,
) -> bool {
    let vertices = mesh.vertices(t);
    let Some(side) = mesh.hull_side(t) else {
        let [a, b, c] = vertices.map(|v| mesh.point(v));
        return predicates.incircle_perturbed(a, b, c, q) == Sign::Positive;
    };
    let (a, b) = (mesh.point(vertices[corner(next(side))]), mesh.point(vertices[corner(previous(side))]));
    match predicates.orient2d(a, b, q) {
        Sign::Positive => true,
        Sign::Negative => false,
        Sign::Zero => lexicographic(a, q) == lexicographic(q, b),
    }
}
