//! Whether triangles are a triangulation of the convex hull of all knots.
//!
//! The triangles must be counterclockwise. Every directed edge must have its opposite, except for the edges
//! of one cycle, which is convex and goes around once. Then the triangles cover the inside of the cycle once
//! (winding numbers), and edges meet only at knots.

use super::knots::Knots;
use super::plane::Plane;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Sign};
use spmesh_stream::model::configurations::FARAWAY;
use std::cmp::Ordering;

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
