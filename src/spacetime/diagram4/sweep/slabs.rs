//! Cuts points into slabs along an axis.

use spmesh_delaunay::predicates::Extent;
use spmesh_stream::model::cells4::Point4;

/// Points along an axis, of which slab after slab is taken. Points that differ in other coordinates alone are
/// in one slab.
pub(super) struct Slabs {
    /// The points that are not taken yet follow after `taken` others.
    order: Vec<u32>,
    taken: usize,
    /// Counts of points after which the coordinate changes: slabs may end there.
    ends: Vec<u32>,
}

impl Slabs {
    /// Points along their longest axis.
    pub(super) fn of(points: &[Point4]) -> Slabs {
        let extent = Extent::of(points);
        // Halves do not overflow.
        let length = |axis: usize| extent.upper[axis] * 0.5 - extent.lower[axis] * 0.5;
        let axis = (1..4).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
        let at = |number: u32| points[number as usize][axis];
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let ends =
            (1..=points.len()).filter(|&end| end == points.len() || at(order[end - 1]) < at(order[end]));
        let ends = ends.map(|end| end as u32).collect();
        Slabs { order, taken: 0, ends }
    }

    /// The number of points of the next slab: as many as are wanted or less, but more if so many have the
    /// same coordinate.
    pub(super) fn next(&self, wanted: usize) -> usize {
        let first = self.ends.partition_point(|&end| end as usize <= self.taken);
        let last = self.ends.partition_point(|&end| end as usize <= self.taken.saturating_add(wanted));
        let end = self.ends.get(first.max(last.saturating_sub(1)));
        end.map_or(0, |&end| end as usize - self.taken)
    }

    /// The points of a slab.
    pub(super) fn numbers(&self, slab: usize) -> &[u32] {
        &self.order[self.taken..][..slab]
    }

    /// The points after a slab.
    pub(super) fn numbers_after(&self, slab: usize) -> &[u32] {
        &self.order[self.taken + slab..]
    }

    /// Whether no points are after a slab.
    pub(super) fn is_last(&self, slab: usize) -> bool {
        self.numbers_after(slab).is_empty()
    }

    /// Takes a slab.
    pub(super) fn take(&mut self, slab: usize) {
        self.taken += slab;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_end_between_different_coordinates() {
        let xs = [3.0, 1.0, 1.0, 2.0, 9.0, 9.0, 9.0, 4.0];
        let points: Vec<Point4> = xs.iter().map(|&x| [0.0, x, 0.0, 5.0]).collect();
        let mut slabs = Slabs::of(&points);
        let mut taken = Vec::new();
        for (wanted, expected) in [(1, &[1, 2][..]), (2, &[3, 0]), (3, &[7]), (1, &[4, 5, 6])] {
            let slab = slabs.next(wanted);
            assert_eq!(slabs.numbers(slab), expected);
            taken.extend_from_slice(slabs.numbers(slab));
            assert_eq!(slabs.is_last(slab), taken.len() == points.len());
            slabs.take(slab);
        }
        assert_eq!(Slabs::of(&points).next(usize::MAX), 8);
        assert_eq!(Slabs::of(&[]).next(5), 0);
    }
}
