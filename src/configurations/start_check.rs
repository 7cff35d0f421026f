//! Whether triangles are a triangulation of the convex hull of all knots.
//!
//! The triangles must be counterclockwise. Every directed edge must have its opposite, except for the edges
//! of one cycle, which is convex and goes around once. Then the triangles cover the inside of the cycle once
//! (winding numbers), and edges meet only at knots.

use std::cmp::Ordering;

use super::knots::Knots;
use super::plane::Plane;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_stream::model::configurations::FARAWAY;

/// Checks triangles from an input.
pub(super) fn check(knots: &Knots, triangles: &[[u32; 3]]) -> Result<()> {
    let mut predicates = FiniteFloatPredicates::default();
    let mut plane = Plane::new(knots, None, &mut predicates);
    let mut is_vertex = vec![false; knots.len()];
    for (number, &triangle) in triangles.iter().enumerate() {
        let fail = |what: String| Err(Error::malformed(what).at(format!("triangle {number}")));
        for v in triangle {
            match is_vertex.get_mut(v as usize) {
                Some(is_vertex) => *is_vertex = true,
                None => return fail(format!("unknown knot {v}: there are {}", knots.len())),
            }
        }
        let [a, b, c] = triangle;
        if a == b || b == c || c == a || !plane.is_left(a, b, c) {
            return fail(format!("{triangle:?} is flat or clockwise; triangles must be counterclockwise"));
        }
    }
    if let Some(missing) = is_vertex.iter().position(|&is_vertex| !is_vertex) {
        return Err(Error::malformed("no triangle has this knot as a vertex").at(format!("knot {missing}")));
    }
    check_border(&mut plane, &border(triangles)?)
}

/// The edges with a triangle to the left only, in order as one cycle.
pub(super) fn border(triangles: &[[u32; 3]]) -> Result<Vec<[u32; 2]>> {
    let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut all: Vec<[u32; 2]> = triangles.iter().flat_map(edges).collect();
    all.sort_unstable();
    if let Some(pair) = all.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(bad_edge(pair[0], "two triangles are to the left of it"));
    }
    let mut open: Vec<[u32; 2]> =
        all.iter().copied().filter(|&[a, b]| all.binary_search(&[b, a]).is_err()).collect();
    open.sort_unstable();
    let Some(&first) = open.first() else { return Err(Knots::collinear()) };
    let mut cycle = vec![first];
    loop {
        let [_, end] = cycle[cycle.len() - 1];
        if end == first[0] {
            break;
        }
        match open.binary_search_by_key(&end, |edge| edge[0]) {
            Ok(next) if cycle.len() < open.len() => cycle.push(open[next]),
            _ => return Err(bad_edge(first, "the border does not close")),
        }
    }
    if cycle.len() < open.len() {
        return Err(bad_edge(first, "the border is not one cycle: there are holes or pieces"));
    }
    Ok(cycle)
}

fn check_border(plane: &mut Plane<FiniteFloatPredicates>, border: &[[u32; 2]]) -> Result<()> {
    let mut minima = 0;
    for (edge, next) in border.iter().zip(border.iter().cycle().skip(1)) {
        let ([a, b], [_, c]) = (*edge, *next);
        let turns = match plane.orient(a, b, c) {
            Sign::Zero => plane.is_between(a, c, b),
            sign => sign == Sign::Positive,
        };
        if !turns {
            return Err(bad_edge([b, c], "the border is not convex there: fill the hull with triangles"));
        }
        let is_below = |p, q| plane.knots.order(p, q) == Ordering::Less;
        minima += u32::from(is_below(b, a) && is_below(b, c));
    }
    if minima != 1 {
        return Err(bad_edge(border[0], "the border goes around more than once"));
    }
    Ok(())
}

fn bad_edge([a, b]: [u32; 2], what: &str) -> Error {
    debug_assert!(a != FARAWAY && b != FARAWAY);
    Error::malformed(what).at(format!("edge from knot {a} to knot {b}"))
}

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
