//! Spatial order of points: along a curve, and the sequence in which they are inserted then.
//!
//! A kernel stores distinct points in their order along a [`Curve`], which [`SpatialOrder`] finds, and
//! inserts them in a [`Sequence`] of their places in that order.

mod cells;
mod curve;
mod hilbert;
mod levels;
mod radix;
mod rounds;
mod sequence;

pub use curve::Curve;
pub use levels::{BIT_LEVEL_MAX, BitLevels, Suffixes};
pub use radix::sizes_to_starts;
pub use rounds::Rounds;
pub use sequence::{Insertions, Sequence};

use crate::parallel;
use crate::predicates::{Extent, lexicographic};
pub(crate) use cells::Cells;
use radix::Keyed;
use std::num::NonZeroUsize;

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
    ) -> Places<'_> {
        self.sort_on(NonZeroUsize::MIN, points, extent, curve)
    }

    /// The same on so many threads.
    pub fn sort_on<const D: usize>(
        &mut self,
        threads: NonZeroUsize,
        points: &[[f64; D]],
        extent: &Extent<D>,
        curve: Curve,
    ) -> Places<'_> {
        let words = 2 * points.len();
        if self.memory.len() < words {
            self.memory = vec![0; words];
        }
        sort_in(&mut self.memory[..words], threads, points, extent, curve)
    }
}

/// [`SpatialOrder::sort_on`] in memory of two words for each point, whose content is arbitrary.
pub(crate) fn sort_in<'m, const D: usize>(
    memory: &'m mut [u64],
    threads: NonZeroUsize,
    points: &[[f64; D]],
    extent: &Extent<D>,
    curve: Curve,
) -> Places<'m> {
    let (items, scratch) = bytemuck::cast_slice_mut(memory).split_at_mut(points.len());
    let mut key_bits = 0;
    if lexicographic(extent.lower, extent.upper).is_lt() {
        let cells = Cells::of(extent, points.len());
        key_bits = D as u32 * cells.bits;
        let key = |point: [f64; D]| curve.key(cells.of_point(point), cells.bits);
        fill_keys(threads, items, points, key);
    } else {
        (0u32..).zip(&mut *items).for_each(|(index, item)| *item = Keyed::new(0, index));
    }
    let sorted = radix::sort(items, scratch, key_bits);
    for_groups(sorted, |group| refine(points, curve, group));
    Places(sorted.iter())
}

fn fill_keys<P: Copy + Sync>(
    threads: NonZeroUsize,
    items: &mut [Keyed],
    points: &[P],
    key: impl Fn(P) -> u32 + Sync,
) {
    let share = points.len().div_ceil(threads.get()).max(1);
    let shares = items.chunks_mut(share).zip(points.chunks(share)).enumerate();
    parallel::for_each(threads, shares, |(number, (items, points))| {
        let first = (number * share) as u32;
        for ((index, item), &point) in (first..).zip(items).zip(points) {
            *item = Keyed::new(key(point), index);
        }
    });
}

/// Indices of points in an order.
#[derive(Debug, Clone)]
pub struct Places<'o>(std::slice::Iter<'o, Keyed>);

impl<'o> Places<'o> {
    /// The same order in pieces of so many points.
    pub fn chunks(self, size: usize) -> impl ExactSizeIterator<Item = Places<'o>> {
        self.0.as_slice().chunks(size).map(|piece| Places(piece.iter()))
    }
}

impl Iterator for Places<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        self.0.next().map(|item| item.index())
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.0.size_hint()
    }
}

impl ExactSizeIterator for Places<'_> {}

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
