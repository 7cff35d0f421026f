//! The triangles of the exposed part of one sphere.
//!
//! Vertices of the mesh on a sphere are outside of all other balls or on their spheres. So the cap that
//! another ball cuts off has no vertex inside, and the neighbours on its circle are ends of an edge of the
//! convex hull of all vertices on the sphere. The arcs, as chains of such edges, divide the hull as they
//! divide the sphere: the facets between them are the mesh of the exposed part. The hull lies in the cell of
//! the ball, so that patches of different balls do not cross.

use foldhash::{HashMap, HashMapExt, HashSet};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;
use std::borrow::Cow;

/// Directions and factor of weights that only change the tetrahedra below the hull: without weights, all
/// points on a sphere are a tie, and each is decided in integers.
const TILTED: Point3 = [0.48, 0.36, 0.8];
const TILT: f64 = 0.25;

/// The facets of the hull of `points` that are on the left of the chords, which go around the exposed part;
/// all facets if there are no chords. Points are relative to the centre of the sphere. `None` if rounding has
/// left a chord out of the hull.
pub(super) fn patch(
    points: &[Point3],
    chords: &[[u32; 2]],
    kernel: &mut Kernel,
) -> Result<Option<Vec<[u32; 3]>>> {
    let weight = |p: &Point3| TILT * (0..3).map(|axis| p[axis] * TILTED[axis]).sum::<f64>().powi(2);
    let weights: Vec<f64> = points.iter().map(weight).collect();
    let mut mesh = Tetrahedralization::default();
    kernel.triangulate_weighted(Cow::Borrowed(points), &weights, &mut mesh).map_err(Error::of_computation)?;
    let facets: Vec<[u32; 3]> = mesh.hull().collect();
    Ok(if chords.is_empty() { Some(facets) } else { enclosed(&facets, chords) })
}

/// The facets on the left of chords; `None` if they do not enclose any.
fn enclosed(facets: &[[u32; 3]], chords: &[[u32; 2]]) -> Option<Vec<[u32; 3]>> {
    let mut on_left: HashMap<[u32; 2], usize> = HashMap::with_capacity(3 * facets.len());
    for (number, &facet) in facets.iter().enumerate() {
        on_left.extend(sides(facet).map(|side| (side, number)));
    }
    let borders: HashSet<[u32; 2]> = chords.iter().copied().collect();
    let mut is_taken = vec![false; facets.len()];
    let mut open = Vec::new();
    for chord in chords {
        let &number = on_left.get(chord)?;
        open.extend((!std::mem::replace(&mut is_taken[number], true)).then_some(number));
    }
    while let Some(number) = open.pop() {
        for [from, to] in sides(facets[number]) {
            if borders.contains(&[from, to]) {
                continue;
            }
            if borders.contains(&[to, from]) {
                // The wrong side of a chord.
                return None;
            }
            let &next = on_left.get(&[to, from])?;
            open.extend((!std::mem::replace(&mut is_taken[next], true)).then_some(next));
        }
    }
    Some(facets.iter().zip(is_taken).filter_map(|(&facet, is_taken)| is_taken.then_some(facet)).collect())
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
