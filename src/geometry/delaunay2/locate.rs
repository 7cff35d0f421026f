//! Where a new point begins to change the triangulation: a triangle in conflict with it.

use super::mesh::{HalfEdge, INFINITE, Sphere, corner, next, previous, triangle_of};
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
pub(super) fn walk(sphere: &Sphere, mut start: Start, q: Point2) -> HalfEdge {
    // A triangle at the point that was inserted last has that point as its corner 0.
    let [_, second, third] = sphere.vertices(start.triangle);
    if second == INFINITE {
        start = Start { triangle: triangle_of(sphere.across(start.triangle + 1)), is_seen: false };
    } else if third == INFINITE {
        start = Start { triangle: triangle_of(sphere.across(start.triangle + 2)), is_seen: false };
    }
    let t = start.triangle;
    let [a, b, c] = sphere.vertices(t).map(|v| difference(sphere.point(v), q));
    // The side that q is behind: its half-edge beyond, and its ends.
    let (mut beyond, mut p, mut r);
    if cross(b, c) < 0.0 {
        (beyond, p, r) = (sphere.across(t), b, c);
    } else if !start.is_seen && cross(c, a) < 0.0 {
        (beyond, p, r) = (sphere.across(t + 1), c, a);
    } else if !start.is_seen && cross(a, b) < 0.0 {
        (beyond, p, r) = (sphere.across(t + 2), a, b);
    } else {
        return t;
    }
    for _ in 0..STEPS_MAX {
        let apex = difference(sphere.point(sphere.opposite(beyond)), q);
        let (is_left, is_right) = (cross(p, apex) < 0.0, cross(apex, r) < 0.0);
        if !(is_left | is_right) {
            break;
        }
        beyond = sphere.across(if is_left { next(beyond) } else { previous(beyond) });
        (p, r) = if is_left { (p, apex) } else { (apex, r) };
    }
    triangle_of(beyond)
}

/// Walks from `t` to a triangle that contains `q`, exactly. In a Delaunay triangulation this walk ends.
#[cold]
#[inline(never)]
pub(super) fn walk_exactly<P: Predicates2>(
    sphere: &Sphere,
    mut t: HalfEdge,
    q: Point2,
    predicates: &mut P,
) -> HalfEdge {
    if let Some(side) = sphere.hull_side(t) {
        if is_in_conflict(sphere, t, q, predicates) {
            return t;
        }
        t = triangle_of(sphere.across(side));
    }
    loop {
        let vertices = sphere.vertices(t);
        if vertices.contains(&INFINITE) {
            return t;
        }
        let [a, b, c] = vertices.map(|v| sphere.point(v));
        let mut is_beyond = |u, v| predicates.orient2d(u, v, q) == Sign::Negative;
        let side = match () {
            () if is_beyond(b, c) => t,
            () if is_beyond(c, a) => t + 1,
            () if is_beyond(a, b) => t + 2,
            () => return t,
        };
        t = triangle_of(sphere.across(side));
    }
}

/// Whether `q`, which is no vertex, lies in the circle of triangle `t`, ties broken by the canonical perturbation.
///
/// The circle of an infinite triangle is the open half-plane beyond its edge of the hull, and that edge: a point on
/// its line but off the edge is in the circle if it is in that of the triangle on the other side, which it is not.
#[cold]
#[inline(never)]
pub(super) fn is_in_conflict<P: Predicates2>(
    sphere: &Sphere,
    t: HalfEdge,
    q: Point2,
    predicates: &mut P,
) -> bool {
    let vertices = sphere.vertices(t);
    let Some(side) = sphere.hull_side(t) else {
        let [a, b, c] = vertices.map(|v| sphere.point(v));
        return predicates.incircle_perturbed(a, b, c, q) == Sign::Positive;
    };
    let (a, b) = (sphere.point(vertices[corner(next(side))]), sphere.point(vertices[corner(previous(side))]));
    match predicates.orient2d(a, b, q) {
        Sign::Positive => true,
        Sign::Negative => false,
        Sign::Zero => lexicographic(a, q) == lexicographic(q, b),
    }
}
