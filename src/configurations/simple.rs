//! Whether a polygon is simple.

use super::plane::Plane;
use spmesh_delaunay::predicates::Predicates2;

/// Two edges of a polygon, or of an open chain, that have a point in common other than a shared vertex.
///
/// Domain: distinct vertices.
///
/// Cost: O(n log n), plus a test for each pair of edges that overlap in the order of the knots. Copies of one
/// knot are told apart by their ranks, so a chain of them costs no more than others.
pub(super) fn crossing<P: Predicates2>(
    plane: &mut Plane<P>,
    polygon: &[u32],
    is_closed: bool,
) -> Option<[[u32; 2]; 2]> {
    let count = polygon.len();
    if count < 4 {
        return flat(plane, polygon, is_closed);
    }
    let edges = if is_closed { count } else { count - 1 };
    let knots = plane.knots;
    let mut sorted: Vec<([u32; 2], usize)> = (0..edges)
        .map(|i| {
            let [p, q] = [polygon[i], polygon[(i + 1) % count]];
            (if knots.order(p, q).is_lt() { [p, q] } else { [q, p] }, i)
        })
        .collect();
    sorted.sort_unstable_by(|([a, _], i), ([b, _], j)| knots.order(*a, *b).then(i.cmp(j)));
    for (place, &([_, end], i)) in sorted.iter().enumerate() {
        let overlaps = |other: &&([u32; 2], usize)| knots.order(other.0[0], end).is_le();
        for &(_, j) in sorted[place + 1..].iter().take_while(overlaps) {
            let [e, f] = [i, j].map(|at| [polygon[at], polygon[(at + 1) % count]]);
            if meet(plane, e, f) {
                return Some([e, f]);
            }
        }
    }
    None
}

/// Whether two edges of one polygon meet at a point other than a shared vertex.
fn meet<P: Predicates2>(plane: &mut Plane<P>, e: [u32; 2], f: [u32; 2]) -> bool {
    let range = |[a, b]: [u32; 2]| {
        let (p, q) = (plane.knots.at(a)[1], plane.knots.at(b)[1]);
        (p.min(q), p.max(q))
    };
    let ((low, high), (other_low, other_high)) = (range(e), range(f));
    if low > other_high || other_low > high {
        return false;
    }
    if e[1] == f[0] {
        return folds(plane, e[0], e[1], f[1]);
    }
    if f[1] == e[0] {
        return folds(plane, f[0], f[1], e[1]);
    }
    plane.do_meet(e, f)
}

/// Whether the chain abc turns back on itself.
fn folds<P: Predicates2>(plane: &mut Plane<P>, a: u32, b: u32, c: u32) -> bool {
    plane.orient(a, b, c) == spmesh_delaunay::predicates::Sign::Zero && !plane.is_between(a, c, b)
}

/// Tests a chain or polygon of at most three vertices.
fn flat<P: Predicates2>(plane: &mut Plane<P>, polygon: &[u32], is_closed: bool) -> Option<[[u32; 2]; 2]> {
    let &[a, b, c] = polygon else { return None };
    let is_bad = if is_closed { !plane.is_left(a, b, c) } else { folds(plane, a, b, c) };
    is_bad.then_some([[a, b], [b, c]])
}
