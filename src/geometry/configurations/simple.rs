//! Whether a polygon is simple.

use super::plane::Plane;
use crate::predicates::Predicates2;

/// Two edges of a polygon, or of an open chain, that have a point in common other than a shared vertex.
///
/// Domain: distinct vertices.
///
/// Cost: O(n log n), plus a test for each pair of edges that overlap in x and y.
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
    let mut sorted: Vec<(f64, f64, usize)> = (0..edges)
        .map(|i| {
            let [p, q] = [polygon[i], polygon[(i + 1) % count]].map(|v| plane.knots.at(v)[0]);
            (p.min(q), p.max(q), i)
        })
        .collect();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    for (place, &(_, end, i)) in sorted.iter().enumerate() {
        for &(_, _, j) in sorted[place + 1..].iter().take_while(|other| other.0 <= end) {
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
    plane.orient(a, b, c) == crate::predicates::Sign::Zero && !plane.is_between(a, c, b)
}

/// Tests a chain or polygon of at most three vertices.
fn flat<P: Predicates2>(plane: &mut Plane<P>, polygon: &[u32], is_closed: bool) -> Option<[[u32; 2]; 2]> {
    let &[a, b, c] = polygon else { return None };
    let is_bad = if is_closed { !plane.is_left(a, b, c) } else { folds(plane, a, b, c) };
    is_bad.then_some([[a, b], [b, c]])
}
