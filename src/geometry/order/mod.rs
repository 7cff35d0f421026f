//! Spatial order of points: along a curve, and the sequence in which they are inserted then.
//!
//! A kernel stores distinct points in their order along a [`Curve`], which [`SpatialOrder`] finds, and
//! inserts them in a [`Sequence`] of their places in that order.

mod cells;
mod counting;
mod curve;
mod hilbert;
mod levels;
mod radix;
mod rounds;
mod sequence;

pub use counting::sizes_to_starts;
pub use curve::Curve;
pub use levels::{BIT_LEVEL_MAX, BitLevels, Suffixes};
pub use rounds::Rounds;
pub use sequence::{Insertions, Sequence};

use crate::predicates::{Extent, lexicographic};
use cells::Cells;
use radix::Keyed;

/// Points of one cell are ordered along a finer curve if they are more than this, and lexicographically if
/// not.
const FEW: usize = 12;

/// Points on two, three or four axes sorted along a curve; reusable, so that its pages are touched once.
///
/// Points of one cell of the curve are sorted along a curve of their own if they are many, which makes the
/// order as good where points cluster as elsewhere. Equal points are neighbours in the order, that of least
/// index first.
///
/// Shape: 16 bytes per point of the greatest set so far, until it is dropped.
#[derive(Debug, Default)]
pub struct SpatialOrder {
    memory: Vec<u64>,
}

impl SpatialOrder {
    /// Indices of `points`, whose extent is `extent`, in their order along `curve`.
    ///
    /// Domain: two to four axes, finite coordinates, at most 2^32 points. Cost: O(n), and O(m log m) at most
    /// for every level of m points in one cell.
    pub fn sort<const D: usize>(
        &mut self,
        points: &[[f64; D]],
        extent: &Extent<D>,
        curve: Curve,
    ) -> impl Iterator<Item = u32> + '_ {
        let words = 2 * points.len();
        if self.memory.len() < words {
            self.memory = vec![0; words];
        }
        sort_in(&mut self.memory[..words], points, extent, curve)
    }
}

/// [`SpatialOrder::sort`] in memory of two words for each point, whose content is arbitrary.
pub(crate) fn sort_in<'m, const D: usize>(
    memory: &'m mut [u64],
    points: &[[f64; D]],
    extent: &Extent<D>,
    curve: Curve,
) -> impl Iterator<Item = u32> + 'm {
    let (items, scratch) = bytemuck::cast_slice_mut(memory).split_at_mut(points.len());
    let mut key_bits = 0;
    if lexicographic(extent.lower, extent.upper).is_lt() {
        let cells = Cells::of(extent, points.len());
        key_bits = D as u32 * cells.bits;
        for ((index, point), item) in (0u32..).zip(points).zip(&mut *items) {
            *item = Keyed::new(curve.key(cells.of_point(*point), cells.bits), index);
        }
    } else {
        (0u32..).zip(&mut *items).for_each(|(index, item)| *item = Keyed::new(0, index));
    }
    let sorted = radix::sort(items, scratch, key_bits);
    for_groups(sorted, |group| refine(points, curve, group));
    sorted.iter().map(|item| item.index())
}

/// Calls `work` for all runs of at least two items with equal keys.
fn for_groups(items: &mut [Keyed], work: impl FnMut(&mut [Keyed])) {
    items.chunk_by_mut(|a, b| a.key() == b.key()).filter(|group| group.len() > 1).for_each(work);
}

/// Sorts items of equal keys.
///
/// Each level divides the box of the points at least by three on its longer side, so the recursion is no
/// deeper than the 2,100 binary orders of magnitude of a coordinate allow.
fn refine<const D: usize>(points: &[[f64; D]], curve: Curve, items: &mut [Keyed]) {
    let point = |item: &Keyed| points[item.index() as usize];
    if items.len() <= FEW {
        items.sort_unstable_by(|a, b| lexicographic(point(a), point(b)).then(a.index().cmp(&b.index())));
        return;
    }
    let extent = Extent::of_each(items.iter().map(point));
    if lexicographic(extent.lower, extent.upper).is_eq() {
        // Equal points, in the order of their indices already.
        return;
    }
    let cells = Cells::of(&extent, items.len());
    for item in &mut *items {
        *item = Keyed::new(curve.key(cells.of_point(point(item)), cells.bits), item.index());
    }
    items.sort_unstable();
    for_groups(items, |group| refine(points, curve, group));
}
