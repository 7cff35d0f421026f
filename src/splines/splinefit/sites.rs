//! The sites at which splines are evaluated, one after the other.

use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::source::Input;

/// A site in world coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    /// For computations.
    pub(super) world: Point2,
    /// As users read it.
    pub(super) decimal: Point2,
}

/// Calls `take` with each site, in their order. `take` returns whether the site is in the domain. Returns the
/// number of sites, and the number of sites outside. `done` gets the number of sites so far.
pub(super) fn for_each_site(
    sites: &Input,
    mut done: impl FnMut(u64),
    mut take: impl FnMut(Site) -> Result<bool>,
) -> Result<[u64; 2]> {
    let (mut count, mut outside) = (0, 0);
    let (mut reader, mut batch) = (sites.read()?, Vec::new());
    let coordinates = sites.description().coordinates;
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            return Ok([count, outside]);
        }
        for &stored in &batch {
            let [world, decimal] = [coordinates.to_world(stored), coordinates.to_decimal(stored)];
            let [world, decimal] = [world, decimal].map(|[x, y, _]| [x, y]);
            outside += u64::from(!take(Site { world, decimal })?);
        }
        count += batch.len() as u64;
        done(count);
    }
}
