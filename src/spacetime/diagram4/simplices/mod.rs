//! The 4D Delaunay triangulation under a symbolic perturbation: each point is raised infinitesimally as it is
//! inserted, by far more than all points before it, so that a point on a sphere counts as outside.
//!
//! The thesis (4.4) lowers points, so that a point on a sphere counts as inside. Then each point of a grid
//! retriangulates all cubes around it: in one pass along the curve, the full 16^4 grid creates 30 million
//! simplices, but 10 million if points are raised. A point that is no vertex is inside the sphere of the
//! simplex that contains it, or beyond the hull, so it is always in conflict with some simplex. A facet in a
//! hyperplane with the point is never on the border of the cavity, so no new simplex is flat.
//!
//! Simplices and their spheres are in flat arrays. Points are inserted by the algorithm of Bowyer (1981) and
//! Watson (1981), along a Hilbert curve; an in-sphere test is the product of two vectors of length six.
//! `locate` walks to a simplex in conflict, `cavity` finds the others, `links` replaces them by simplices
//! around the point, and `links` links these.
//!
//! Unpredictable branches are avoided: both outcomes are written, and one is kept. On the full 16^4 grid that
//! saves a quarter of the time.

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
pub(super) use complex::{
    Complex, FACETS, Facet, SIMPLICES_MAX, Simplex, Sphere, facet, facet_of, simplex_of, without,
};
pub(super) use first::spanning;
pub(super) use order::insertions;

use super::Stats;
use super::sites::Sites;
use insertion::Insertion;
use spmesh_base::error::Result;
use std::time::Instant;

/// Triangulates sites.
///
/// Cost: 40 bytes and six coefficients per simplex.
pub(super) fn triangulate<'a, C: Coefficient>(sites: &'a Sites, stats: &mut Stats) -> Result<Complex<'a, C>> {
    let started = Instant::now();
    let order = insertions(sites)?;
    stats.order += started.elapsed();
    insert(Complex::new(sites, order, SIMPLICES_MAX), stats)
}

/// The same for some of the sites, given by increasing numbers, if there are at most so many simplices.
pub(super) fn triangulate_part<'a, C: Coefficient>(
    sites: &'a Sites,
    numbers: &[u32],
    most: usize,
    stats: &mut Stats,
) -> Result<Complex<'a, C>> {
    let started = Instant::now();
    let mut order = insertions(&sites.part(numbers))?;
    order.iter_mut().for_each(|number| *number = numbers[*number as usize]);
    stats.order += started.elapsed();
    insert(Complex::new(sites, order, most.min(SIMPLICES_MAX)), stats)
}

fn insert<'a, C: Coefficient>(complex: Complex<'a, C>, stats: &mut Stats) -> Result<Complex<'a, C>> {
    let started = Instant::now();
    let mut insertion = Insertion::new(complex);
    let result = insertion.run();
    stats.insertion += started.elapsed();
    stats.created += insertion.created;
    stats.in_sphere_tests += insertion.tests;
    result.map(|()| insertion.complex)
}
