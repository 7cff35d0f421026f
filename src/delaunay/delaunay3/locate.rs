//! Where a new point begins to change the tetrahedralization: a tetrahedron in conflict with it.

use super::complex::{Complex, Facet, corner, tetrahedron_of};
use super::exact::Exact;
use super::translated::volume;
use super::weights::Weights;
use crate::predicates::{Point3, Sign};
use crate::simplex::TETRAHEDRON_FACETS;
use crate::vector::difference;

/// Steps after which the exact walk takes over: rounding may lead the other one in circles.
const STEPS_MAX: usize = 10_000;

/// Walks from `start` to a tetrahedron that probably contains the point at `q`, in rounded arithmetic, or
/// to a frozen one.
#[inline(always)]
pub(super) fn walk(complex: &Complex<'_>, start: u32, q: Point3) -> u32 {
    let infinite = complex.infinite();
    let t = complex.hull_facet(start).map_or(start, |side| tetrahedron_of(complex.neighbour(side)));
    if complex.is_frozen(t) {
        return t;
    }
    let vertices @ [a, b, c, d] = complex.corners(t);
    let at = [
        difference(complex.point(a), q),
        difference(complex.point(b), q),
        difference(complex.point(c), q),
        difference(complex.point(d), q),
    ];
    let mut entered: Option<(Facet, u32, [Point3; 3])> = None;
    for (side, [i, j, k]) in TETRAHEDRON_FACETS.into_iter().enumerate() {
        if volume(at[i], at[j], at[k]) < 0.0 {
            let facet = complex.neighbour(t + side as u32);
            entered = Some((facet, vertices[i], [at[i], at[j], at[k]]));
            break;
        }
    }
    let Some((mut facet, mut first, [mut a, mut b, mut c])) = entered else { return t };
    for _ in 0..STEPS_MAX {
        let apex = complex.opposite(facet);
        // Flags of frozen tetrahedra are above all vertices.
        if apex >= infinite {
            break;
        }
        let d = difference(complex.point(apex), q);
        let neighbours = complex.neighbours_behind(facet, first);
        if volume(d, b, c) < 0.0 {
            (facet, first, a) = (neighbours[0], apex, d);
        } else if volume(a, d, c) < 0.0 {
            (facet, b) = (neighbours[1], d);
        } else if volume(a, b, d) < 0.0 {
            (facet, c) = (neighbours[2], d);
        } else {
            break;
        }
    }
    tetrahedron_of(facet)
}

/// A point to be inserted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    pub(super) at: Point3,
    pub(super) weight: f64,
}

/// Walks from `t` to the tetrahedron that contains `q`, exactly: finite, or infinite and in conflict with it.
/// A finite one is in conflict, too, unless weights hide the point. It may be a frozen one, where the walk
/// stops. In a Delaunay or regular tetrahedralization this walk ends.
#[cold]
#[inline(never)]
pub(super) fn walk_exactly<W: Weights>(
    complex: &Complex<'_>,
    weights: &W,
    mut t: u32,
    q: Site,
    predicates: &mut dyn Exact,
) -> u32 {
    if let Some(side) = complex.hull_facet(t) {
        if is_in_conflict(complex, weights, t, q, predicates) {
            return t;
        }
        t = tetrahedron_of(complex.neighbour(side));
    }
    let q = q.at;
    loop {
        let vertices = complex.corners(t);
        if vertices.contains(&complex.infinite()) || complex.is_frozen(t) {
            return t;
        }
        let side = TETRAHEDRON_FACETS.iter().position(|corners| {
            let [a, b, c] = corners.map(|i| complex.point(vertices[i]));
            predicates.orient3d(q, a, b, c) == Sign::Negative
        });
        match side {
            Some(side) => t = tetrahedron_of(complex.neighbour(t + side as u32)),
            None => return t,
        }
    }
}

/// Whether `q`, which is no vertex, lies in the sphere of tetrahedron `t`, or with weights is in conflict
/// with its orthosphere, ties broken by the canonical perturbation. It does if `t` is no longer there: it
/// gave way to `q`.
///
/// The sphere of an infinite tetrahedron is the open half-space beyond its facet of the hull, and what the
/// sphere of the tetrahedron on the other side has in common with the plane between them (thesis 4.4).
#[cold]
#[inline(never)]
pub(super) fn is_in_conflict<W: Weights>(
    complex: &Complex<'_>,
    weights: &W,
    t: u32,
    q: Site,
    predicates: &mut dyn Exact,
) -> bool {
    if complex.is_deleted(t) {
        return true;
    }
    let vertices = complex.corners_of_any(t);
    let Some(side) = complex.hull_facet(t) else {
        let abcd @ [a, b, c, d] = vertices.map(|v| complex.point(v));
        let sign = if W::ARE_EQUAL {
            predicates.insphere_perturbed(a, b, c, d, q.at)
        } else {
            let [k, l, m, n] = vertices.map(|v| weights.of(v));
            predicates.power_side_perturbed(abcd, q.at, [k, l, m, n, q.weight])
        };
        return sign == Sign::Positive;
    };
    let [a, b, c] = TETRAHEDRON_FACETS[corner(side)].map(|i| complex.point(vertices[i]));
    match predicates.orient3d(q.at, a, b, c) {
        Sign::Positive => true,
        Sign::Negative => false,
        Sign::Zero => {
            is_in_conflict(complex, weights, tetrahedron_of(complex.neighbour(side)), q, predicates)
        }
    }
}
