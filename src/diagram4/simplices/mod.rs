//! The 4D Delaunay triangulation that remains if each point, as it is inserted, is lowered a bit more than all before it
//! (thesis 4.4): a point on a sphere counts as inside.
//!
//! Simplices and their spheres are in flat arrays. A point is inserted as Bowyer (1981) and Watson (1981) do it, along a
//! Hilbert curve; an in-sphere test is the product of two vectors of six. `locate` is the walk to a simplex in conflict,
//! `insertion` finds the others and puts the star of the point in their place.

mod complex;
mod first;
mod insertion;
mod locate;

pub(super) use complex::{Complex, FACETS, INFINITE, facet_of, simplex_of};

use super::Stats;
use super::sites::Sites;
use crate::error::Result;
use crate::order::{Curve, SpatialOrder};
use crate::predicates::Extent;
use insertion::Insertion;
use std::time::Instant;

/// Triangulates sites.
///
/// Errors: all points are in a hyperplane.
///
/// Cost: 88 bytes per simplex.
pub(super) fn triangulate<'a>(sites: &'a Sites, stats: &mut Stats) -> Result<Complex<'a>> {
    let started = Instant::now();
    let mut order: Vec<u32> = SpatialOrder::default()
        .sort(&sites.points, &Extent::of(&sites.points), Curve::Hilbert)
        .collect();
    first::to_front(sites, &mut order)?;
    let mut insertion = Insertion::new(Complex::new(sites, order));
    stats.order = started.elapsed();
    let started = Instant::now();
    insertion.run();
    stats.insertion = started.elapsed();
    stats.created = insertion.created;
    stats.in_sphere_tests = insertion.tests;
    Ok(insertion.complex)
}
