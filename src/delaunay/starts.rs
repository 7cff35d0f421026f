//! Simplices to begin walks at.

use crate::order::{Cells, Curve};
use crate::predicates::Extent;

/// One simplex in so many is a start: a walk from the nearest takes a few steps.
const SIMPLICES_PER_START: usize = 8;

/// Simplices of a triangulation of the plane or of space, from which one near to a target is found fast: a
/// start for walks to targets in no order.
///
/// ```
/// use spmesh_delaunay::delaunay2::triangulate;
///
/// let mesh = triangulate(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])?;
/// let starts = mesh.starts();
/// assert_eq!(mesh.nearest_from([3.0, 1.0], starts.near([3.0, 1.0])), Some(1));
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Starts<const D: usize> {
    /// `None` without simplices.
    cells: Option<Cells<D>>,
    /// Places of simplices along a Hilbert curve, in increasing order.
    keys: Vec<u32>,
    /// The simplices there.
    simplices: Vec<u32>,
}

impl<const D: usize> Starts<D> {
    /// Starts among so many simplices; `corner` tells where one of the corners of each is.
    pub(crate) fn new(count: usize, extent: &Extent<D>, corner: impl Fn(u32) -> [f64; D]) -> Starts<D> {
        if count == 0 {
            return Starts { cells: None, keys: Vec::new(), simplices: Vec::new() };
        }
        let cells = Cells::of(extent, count / SIMPLICES_PER_START);
        let numbers = (0..count as u32).step_by(SIMPLICES_PER_START);
        let mut starts: Vec<(u32, u32)> =
            numbers.map(|number| (key(&cells, corner(number)), number)).collect();
        starts.sort_unstable();
        let (keys, simplices) = starts.into_iter().unzip();
        Starts { cells: Some(cells), keys, simplices }
    }

    /// The number of a simplex that is probably near to the target; 0 if there is none.
    ///
    /// Cost: O(log n).
    pub fn near(&self, target: [f64; D]) -> u32 {
        let Some(cells) = &self.cells else { return 0 };
        let key = key(cells, target);
        let place = self.keys.partition_point(|&other| other < key);
        self.simplices[place.min(self.simplices.len() - 1)]
    }
}

/// The place of a point along the curve. What is outside of the extent counts for a cell at its border.
fn key<const D: usize>(cells: &Cells<D>, point: [f64; D]) -> u32 {
    Curve::Hilbert.key(cells.of_point(point), cells.bits)
}
