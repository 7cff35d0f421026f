//! Spatial order of points: along a Hilbert curve.

mod cells;
mod hilbert;
mod radix;

pub use hilbert::hilbert_key;

use crate::predicates::{Extent, Point2, lexicographic};
use cells::Cells;
use radix::{Keyed, RadixSort};

/// Points of one cell are ordered along a finer curve if they are more than this, and lexicographically if not.
const FEW: usize = 12;

/// Points sorted along the Hilbert curve; reusable, so that its pages are touched once.
///
/// Points of one cell of the curve are sorted along a curve of their own if they are many, which makes the order as
/// good where points cluster as elsewhere. Equal points are neighbours in the order, that of least index first.
#[derive(Debug, Default)]
pub struct HilbertOrder {
    sort: RadixSort,
}

impl HilbertOrder {
    /// Indices of `points`, whose extent is `extent`, in their order along the curve.
    ///
    /// Domain: finite coordinates, at most 2^32 points. Cost: O(n), and O(m log m) at most for every level of
    /// m points in one cell.
    pub fn sort(&mut self, points: &[Point2], extent: &Extent) -> impl Iterator<Item = u32> + '_ {
        let items = self.sort.items(points.len());
        let mut key_bits = 0;
        if lexicographic(extent.lower, extent.upper).is_lt() {
            let cells = Cells::of(extent, points.len());
            key_bits = 2 * cells.bits;
            items.extend((0u32..).zip(points).map(|(index, point)| Keyed::new(cells.key(*point), index)));
        } else {
            items.extend((0..points.len() as u32).map(|index| Keyed::new(0, index)));
        }
        let sorted = self.sort.sort(key_bits);
        for_groups(sorted, |group| refine(points, group));
        sorted.iter().map(|item| item.index())
    }
}

/// Calls `work` for all runs of at least two items with equal keys.
fn for_groups(items: &mut [Keyed], work: impl FnMut(&mut [Keyed])) {
    items.chunk_by_mut(|a, b| a.key() == b.key()).filter(|group| group.len() > 1).for_each(work);
}

/// Sorts items of equal keys.
///
/// Each level divides the box of the points at least by three on its longer side, so the recursion is no deeper
/// than the 2,100 binary orders of magnitude of a coordinate allow.
fn refine(points: &[Point2], items: &mut [Keyed]) {
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
    items.iter_mut().for_each(|item| *item = Keyed::new(cells.key(point(item)), item.index()));
    items.sort_unstable();
    for_groups(items, |group| refine(points, group));
}
