//! Cuts points into slabs along an axis; what comes after a stage is known as a box.

use crate::diagram4::simplices::{Coefficient, Complex, Sphere};
use crate::diagram4::sites::Sites;
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

    pub(super) fn take(&mut self, slab: usize) {
        self.taken += slab;
    }
}

/// A sum of few products in f64 is off by less than this times the sum of their magnitudes.
const SUM_ERROR: f64 = 1e-12;

/// The bound on rounding holds for points. Those of a box are rounded once more, so it is multiplied by this.
const MARGIN: f64 = 8.0;

/// The box of the points that come later, in the coordinates of spheres; `None` if there are none.
pub(super) struct Rest(Option<[Point4; 2]>);

impl Rest {
    pub(super) fn of(sites: &Sites, numbers: &[u32]) -> Rest {
        let mut points = numbers.iter().map(|&number| sites.near(number));
        let first = points.next().map(|point| [point; 2]);
        Rest(first.map(|first| {
            points.fold(first, |[lower, upper], point| {
                let both =
                    |f: fn(f64, f64) -> f64, bound: Point4| std::array::from_fn(|i| f(bound[i], point[i]));
                [both(f64::min, lower), both(f64::max, upper)]
            })
        }))
    }

    /// For each simplex: whether it is finite, and the box of the rest is certainly outside of its sphere.
    /// Without a rest, `true` for all, infinite ones included.
    pub(super) fn closed<C: Coefficient>(&self, complex: &Complex<C>) -> Vec<bool> {
        let Some(bounds) = &self.0 else { return vec![true; complex.simplices.len()] };
        let is_closed = |sphere: &Sphere<C>| is_outside(&sphere.map(C::value), bounds, complex.rounding);
        complex.spheres.iter().map(is_closed).collect()
    }
}

/// Whether a whole box is strictly outside of a sphere, and certainly so. The value of a point is a sum of a
/// convex function of each coordinate, whose least value in the box is at the vertex of the parabola, or at
/// the end that is nearest to it.
fn is_outside([a, b, c, d, m, s]: &[f64; 6], [lower, upper]: &[Point4; 2], rounding: f64) -> bool {
    if *m <= 0.0 {
        return false;
    }
    let (mut value, mut magnitude) = (*s, s.abs());
    for (axis, n) in [a, b, c, d].into_iter().enumerate() {
        let x = (-0.5 * n / m).max(lower[axis]).min(upper[axis]);
        let (square, linear) = (m * x * x, n * x);
        value += square + linear;
        magnitude += square + linear.abs();
    }
    value > SUM_ERROR * magnitude + MARGIN * rounding
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

    #[test]
    fn boxes_outside_of_a_sphere() {
        // |x - (1, 0, 0, 0)|^2 - 4, twice.
        let sphere = [-4.0, 0.0, 0.0, 0.0, 2.0, -6.0];
        let is_outside = |lower, upper| is_outside(&sphere, &[lower, upper], 0.0);
        assert!(is_outside([3.01, -5.0, -5.0, -5.0], [9.0; 4]));
        assert!(!is_outside([3.0, -5.0, -5.0, -5.0], [9.0; 4]), "a point on the sphere");
        assert!(is_outside([2.5, 1.5, -5.0, 0.0], [9.0; 4]), "beside it");
        assert!(!is_outside([2.5, 1.0, -5.0, 0.0], [9.0; 4]));
        assert!(!is_outside([-9.0; 4], [9.0; 4]), "around it");
        let [.., m, _] = sphere;
        let flat = [1.0, 0.0, 0.0, 0.0, m - m, 5.0];
        assert!(!super::is_outside(&flat, &[[1.0; 4], [2.0; 4]], 0.0), "infinite simplices stay");
    }
}
