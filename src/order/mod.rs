//! Spatial order of points: along a Hilbert curve.

mod cells;
mod hilbert;
mod radix;

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers in [0, 1).
    fn random(count: usize) -> impl Iterator<Item = f64> {
        let mut state = 1u64;
        (0..count).map(move |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        })
    }

    fn check(points: &[Point2]) {
        let mut order = HilbertOrder::default();
        let indices: Vec<u32> = order.sort(points, &Extent::of(points)).collect();
        let mut sorted = indices.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..points.len() as u32), "a permutation");
        let mut last_of = std::collections::HashMap::new();
        for (place, &index) in indices.iter().enumerate() {
            let point = points[index as usize].map(|c| (c + 0.0).to_bits());
            if let Some((last, before)) = last_of.insert(point, (place, index)) {
                assert!(last + 1 == place && before < index, "equal points are neighbours, in order");
            }
        }
    }

    #[test]
    fn clusters_within_clusters() {
        let numbers: Vec<f64> = random(60_000).collect();
        let points: Vec<Point2> = numbers
            .chunks_exact(2)
            .enumerate()
            .map(|(i, p)| {
                let size = 1e-5f64.powi(i as i32 % 40);
                // Every seventh has an equal.
                let p = if i % 7 == 0 { [0.5, 0.25] } else { [p[0], p[1]] };
                p.map(|c| c * size)
            })
            .collect();
        check(&points);
    }

    #[test]
    fn many_points_in_extents_of_every_size() {
        for size in [5e-324, 1e-320, 1e-307, 1e-300, 1e-150, 1.0, 1e150, f64::MAX] {
            let numbers: Vec<f64> = random(100_000).collect();
            let mut points: Vec<Point2> =
                numbers.chunks_exact(2).map(|p| [(2.0 * p[0] - 1.0) * size, p[1] * size]).collect();
            check(&points);
            points.push([1.0, -1.0]);
            check(&points);
            points.iter_mut().for_each(|p| p[1] = 1e300);
            check(&points);
        }
    }
}
