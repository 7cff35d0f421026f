//! The triangles of the exposed part of one sphere.
//!
//! Vertices of the mesh on a sphere are outside of all other balls or on their spheres. So the cap that
//! another ball cuts off has no vertex inside, and the neighbours on its circle are ends of an edge of the
//! convex hull of all vertices on the sphere. The arcs, as chains of such edges, divide the hull as they
//! divide the sphere: the facets between them are the mesh of the exposed part. The hull lies in the cell of
//! the ball, so that patches of different balls do not cross.

use std::borrow::Cow;
use std::num::NonZeroUsize;

use super::super::Balls;
use super::super::pockets::{Pocket, with_members};
use super::super::shares::length;
use super::super::tile::{Tile, with_all};
use super::{Surface, check_step, of_tile};
use foldhash::{HashMap, HashMapExt, HashSet};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{cross, difference, dot};

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

/// Tetrahedra on a walk, after which rounding must have led it in circles.
const STEPS_MAX: usize = 100_000;

/// The surface of a union of balls, its pockets, and for each triangle the number of the pocket around which
/// it lies, from 1 in their order; 0 if it lies around none.
///
/// A triangle belongs to a pocket if the middle of its place on the sphere lies in a tetrahedron of the
/// pocket: a point that no ball covers lies in an empty tetrahedron. So at mouths the border is a chain of
/// sides of triangles.
///
/// # Errors
/// As [`super::surface`].
pub fn linings(
    balls: Balls<'_>,
    step: f64,
    threads: NonZeroUsize,
) -> Result<(Surface, Vec<Pocket>, Vec<u32>)> {
    check_step(balls, step)?;
    with_all(balls, |tile| of_pockets(tile, balls, step, threads))
}

fn of_pockets(
    tile: &Tile<'_>,
    balls: Balls<'_>,
    step: f64,
    threads: NonZeroUsize,
) -> Result<(Surface, Vec<Pocket>, Vec<u32>)> {
    let surface = of_tile(tile, balls, step, threads)?;
    let mut numbers = vec![0; tile.tetrahedra().len()];
    let mut pockets = Vec::new();
    for (number, (pocket, members)) in (1..).zip(with_members(tile)) {
        members.into_iter().for_each(|t| numbers[t] = number);
        pockets.push(pocket);
    }
    let mut at = 0;
    let number = |(&corners, &ball): (&[u32; 3], &u32)| {
        let corners = corners.map(|corner| surface.points[corner as usize]);
        let (centre, radius) = (balls.centres[ball as usize], balls.radii[ball as usize]);
        let out = difference(mean(corners), centre);
        let middle = [0, 1, 2].map(|axis| centre[axis] + out[axis] * radius / length(out));
        at = locate(tile, at, middle);
        numbers[at]
    };
    let around = surface.triangles.iter().zip(&surface.balls).map(number).collect();
    Ok((surface, pockets, around))
}

fn mean([a, b, c]: [Point3; 3]) -> Point3 {
    [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0)
}

/// The tetrahedron at a point, by a walk in rounded arithmetic.
fn locate(tile: &Tile<'_>, start: usize, at: Point3) -> usize {
    let mut t = start;
    for _ in 0..STEPS_MAX {
        let tetrahedron = &tile.tetrahedra()[t];
        let is_beyond = |&side: &usize| {
            let corners = TETRAHEDRON_FACETS[side].map(|i| tile.point(tetrahedron.vertices[i]));
            let [a, b, c] = corners.map(|corner| difference(corner, at));
            dot(a, cross(b, c)) < 0.0
        };
        match (0..4).find(is_beyond).and_then(|side| tetrahedron.neighbour(side)) {
            Some(next) => t = next.tetrahedron as usize,
            None => break,
        }
    }
    t
}
