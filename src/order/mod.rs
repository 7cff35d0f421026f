//! Spatial order of points: Morton keys of a monotone quantisation, and the radix sort that applies them.

mod morton;
mod radix;

pub use morton::{Quantisation, morton_key};
pub use radix::{Keyed, RadixSort};

use crate::predicates::{Extent, Point2, lexicographic};

/// Points sorted along the Morton curve; reusable, so that its pages are touched once.
///
/// Points with equal keys are sorted lexicographically, and equal points by their index: equal points are
/// neighbours in the order, the one of least index first.
#[derive(Debug, Default)]
pub struct MortonOrder {
    sort: RadixSort,
}

impl MortonOrder {
    /// Sorts `points`, whose extent is `extent`; returns key and index of each in Morton order.
    ///
    /// Domain: finite coordinates, at most 2^32 points. Cost: O(n) unless keys collide, O(n log n) at worst.
    pub fn sort(&mut self, points: &[Point2], extent: &Extent) -> &[Keyed] {
        let quantisation = Quantisation::of(extent);
        let items = self.sort.items(points.len());
        items.extend(
            (0u32..).zip(points).map(|(index, point)| Keyed { key: quantisation.key(*point), index }),
        );
        self.sort.sort(|a, b| {
            lexicographic(points[a.index as usize], points[b.index as usize]).then(a.index.cmp(&b.index))
        })
    }
}
