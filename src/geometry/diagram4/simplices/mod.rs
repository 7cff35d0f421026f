//! The 4D Delaunay triangulation that remains if each point, as it is inserted, is raised infinitesimally, by
//! far more than all before it: a point on a sphere counts as outside.
//!
//! The thesis (4.4) lowers points, so that a point on a sphere counts as inside. Then each point of a grid
//! triangulates all cubes around it anew: 30 million simplices are created for the full 16^4 grid, and 10
//! million if points are raised. A point that is no vertex is inside of the sphere of the simplex that it
//! lies in, or beyond the hull, so it always finds a place; and a facet in a hyperplane with the point is
//! never between a simplex in conflict and one that is not, so no simplex is flat.
//!
//! Simplices and their spheres are in flat arrays. A point is inserted as Bowyer (1981) and Watson (1981) do
//! it, along a Hilbert curve; an in-sphere test is the product of two vectors of six. `locate` is the walk to
//! a simplex in conflict, `cavity` finds the others, `insertion` puts the star of the point in their place,
//! and `links` makes its simplices neighbours.
//!
//! What a processor cannot predict is not asked: which simplex of a cavity is met first, which of two
//! neighbours. Both answers are written down, and one is kept. Of the full 16^4 grid that saves a third of
//! the time.

mod cavity;
mod coefficient;
mod complex;
mod first;
mod insertion;
mod lanes;
mod links;
mod locate;
mod order;

pub(super) use coefficient::Coefficient;
pub(super) use complex::{Complex, FACETS, Facet, INFINITE, Simplex, facet, facet_of, simplex_of};

pub(super) use order::insertions;

use super::Stats;
use super::sites::Sites;
use insertion::Insertion;
use spmesh_core::error::Result;
use std::time::Instant;

/// Triangulates sites.
///
/// Cost: 40 bytes per simplex, and six coefficients.
///
/// # Errors
/// All points are in a hyperplane; too many simplices.
pub(super) fn triangulate<'a, C: Coefficient>(sites: &'a Sites, stats: &mut Stats) -> Result<Complex<'a, C>> {
    let started = Instant::now();
    let order = insertions(sites)?;
    let mut insertion = Insertion::new(Complex::new(sites, order));
    stats.order = started.elapsed();
    let started = Instant::now();
    insertion.run()?;
    stats.insertion = started.elapsed();
    stats.created = insertion.created;
    stats.in_sphere_tests = insertion.tests;
    Ok(insertion.complex)
}
