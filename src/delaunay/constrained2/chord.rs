//! Segments that are inserted, part by part.

use super::mesh::{Mesh, NONE, Side};
use super::vertex::edge;
use super::walk::{End, walk};
use crate::error::{Error, Result};
use crate::predicates::{Point2, Predicates2, Sign, lexicographic};
use foldhash::HashMap;

/// Makes the part of a segment an edge that goes from a vertex on it towards its end `to`, up to the next
/// vertex. Returns whether the part leaves the region before it reaches one.
pub(super) fn insert(
    mesh: &mut Mesh,
    from: u32,
    to: Point2,
    segment: u32,
    predicates: &mut impl Predicates2,
) -> Result<bool> {
    if mesh.place(from) == to {
        return Ok(false);
    }
    let (walk, end) = walk(mesh, from, to, predicates);
    let vertex = match end {
        End::Vertex(vertex) => vertex,
        End::Border(None) => return Ok(false),
        End::Border(Some(_)) | End::Inside(_) | End::On(_) => return Ok(true),
    };
    let end = mesh.place(vertex);
    if end != to && lexicographic(end, to) != lexicographic(mesh.place(from), to) {
        return Ok(true);
    }
    if !walk.crossed.is_empty() {
        open_cavity(mesh, [from, vertex], &walk.crossed, predicates)?;
    }
    let side = edge(mesh, from, vertex).expect("the part is an edge now");
    for side in [Some(side), mesh.across(side)].into_iter().flatten() {
        mesh.triangles[side.triangle as usize].segments[side.place] = segment;
    }
    // The new triangles are locally Delaunay if the mesh was; this does not rely on it.
    mesh.restore(predicates);
    Ok(false)
}

/// Makes a segment between two vertices of a convex region edges, divided at the vertices that it passes
/// through.
pub(super) fn insert_whole(
    mesh: &mut Mesh,
    [mut vertex, last]: [u32; 2],
    segment: u32,
    predicates: &mut impl Predicates2,
) -> Result<()> {
    let to = mesh.place(last);
    while vertex != last {
        insert(mesh, vertex, to, segment, predicates)?;
        let End::Vertex(next) = walk(mesh, vertex, to, predicates).1 else {
            unreachable!("the part is an edge now");
        };
        vertex = next;
    }
    Ok(())
}

/// A side of the cavity that stays, by the direction in which it runs in the cavity.
#[derive(Debug, Clone, Copy)]
struct Outer {
    across: Option<Side>,
    segment: u32,
}

/// Replaces the triangles that a part of a segment crosses by triangles on both sides of the part.
fn open_cavity(
    mesh: &mut Mesh,
    [from, to]: [u32; 2],
    crossed: &[Side],
    predicates: &mut impl Predicates2,
) -> Result<()> {
    let ends = |side: &Side| {
        let vertices = mesh.triangle(side.triangle).vertices;
        [1, 2].map(|turn| vertices[(side.place + turn) % 3])
    };
    let (mut right, mut left) = (vec![from], vec![from]);
    for side in crossed {
        if mesh.triangle(side.triangle).segments[side.place] != NONE {
            return Err(Error::Crossing(ends(side).map(|end| mesh.place(end))));
        }
        for (chain, end) in [&mut right, &mut left].into_iter().zip(ends(side)) {
            if chain.last() != Some(&end) {
                chain.push(end);
            }
        }
    }
    right.push(to);
    left.push(to);
    // Both polygons run counterclockwise.
    left.reverse();
    let numbers: Vec<u32> = std::iter::once(crossed[0].triangle)
        .chain(crossed.iter().filter_map(|&side| mesh.across(side)).map(|side| side.triangle))
        .collect();
    let outer = outer_sides(mesh, &numbers);
    let mut triangles = Vec::with_capacity(numbers.len());
    for chain in [&right, &left] {
        divide(mesh, chain, &mut triangles, predicates);
    }
    debug_assert_eq!(triangles.len(), numbers.len());
    link(mesh, &numbers, &triangles, &outer);
    Ok(())
}

/// The sides of some triangles by their directions.
fn outer_sides(mesh: &Mesh, numbers: &[u32]) -> HashMap<[u32; 2], Outer> {
    let mut outer = HashMap::default();
    for &triangle in numbers {
        let vertices = mesh.triangle(triangle).vertices;
        for place in 0..3 {
            let ends = [1, 2].map(|turn| vertices[(place + turn) % 3]);
            let segment = mesh.triangle(triangle).segments[place];
            outer.insert(ends, Outer { across: mesh.across(Side { triangle, place }), segment });
        }
    }
    outer
}

/// Divides a polygon into triangles. It runs counterclockwise along `chain`, and back along a straight line.
/// A vertex comes several times where the polygon touches itself.
///
/// The triangle at the line has the vertex whose circle through both ends contains no other. This leaves a
/// polygon of the same kind on each of its sides.
fn divide(mesh: &Mesh, chain: &[u32], triangles: &mut Vec<[u32; 3]>, predicates: &mut impl Predicates2) {
    let mut ranges = vec![[0, chain.len() - 1]];
    while let Some([first, last]) = ranges.pop() {
        if last - first < 2 {
            continue;
        }
        let [a, b] = [chain[first], chain[last]].map(|vertex| mesh.place(vertex));
        let mut best: Option<usize> = None;
        for candidate in first + 1..last {
            let place = mesh.place(chain[candidate]);
            if predicates.orient2d(a, place, b) != Sign::Positive {
                continue;
            }
            let is_better = best.is_none_or(|best| {
                let apex = mesh.place(chain[best]);
                place != apex && predicates.incircle_perturbed(a, apex, b, place) == Sign::Positive
            });
            if is_better {
                best = Some(candidate);
            }
        }
        let best = best.expect("a vertex of the polygon is beside its line");
        triangles.push([chain[first], chain[best], chain[last]]);
        ranges.extend([[first, best], [best, last]]);
    }
}

/// Writes the triangles of a cavity under the numbers of those that they replace.
fn link(mesh: &mut Mesh, numbers: &[u32], triangles: &[[u32; 3]], outer: &HashMap<[u32; 2], Outer>) {
    let mut sides: HashMap<[u32; 2], Side> = HashMap::default();
    for (&triangle, vertices) in numbers.iter().zip(triangles) {
        for place in 0..3 {
            sides.insert([1, 2].map(|turn| vertices[(place + turn) % 3]), Side { triangle, place });
        }
    }
    for (&triangle, &vertices) in numbers.iter().zip(triangles) {
        let found = [0, 1, 2].map(|place| {
            let [from, to] = [1, 2].map(|turn| vertices[(place + turn) % 3]);
            let old = outer.get(&[from, to]);
            let across = sides.get(&[to, from]).copied().or_else(|| old.and_then(|old| old.across));
            (across, old.map_or(NONE, |old| old.segment))
        });
        mesh.set(triangle, vertices, found.map(|side| side.0), found.map(|side| side.1));
        mesh.doubtful.extend([0, 1, 2].map(|place| Side { triangle, place }));
    }
}
