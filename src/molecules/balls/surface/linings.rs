//! The parts of the surface around pockets.

use super::super::Balls;
use super::super::pockets::{Pocket, with_members};
use super::super::shares::length;
use super::super::tile::{Tile, with_all};
use super::{Surface, check_step, of_tile};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{cross, difference, dot};
use std::num::NonZeroUsize;

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
