//! Prepares points: makes them distinct, sorts them, and scales them about the centre of their box.

use super::exact::{DOUBLE_MAX, Exactness, INT128_MAX, SMALL_MAX};
use spmesh_delaunay::predicates::{Extent, lexicographic};
use spmesh_stream::model::cells4::Point4;

/// Distinct points, sorted and scaled.
#[derive(Debug)]
pub(super) struct Sites {
    /// In lexicographic order.
    pub(super) points: Vec<Point4>,
    pub(super) exactness: Exactness,
    /// Coordinates are multiplied by `unit`, a power of two, and then measured from `centre`.
    pub(super) unit: f64,
    pub(super) centre: Point4,
}

impl Sites {
    /// Domain: distinct points in lexicographic order, finite coordinates.
    pub(super) fn new(points: Vec<Point4>) -> Sites {
        let extent = Extent::of(&points);
        let greatest = extent.max_difference();
        let is_below =
            |limit| extent.integral && extent.greatest_magnitude() < 2f64.powi(52) && greatest <= limit;
        let exactness = if is_below(SMALL_MAX) {
            Exactness::Small
        } else if is_below(DOUBLE_MAX) {
            Exactness::Double
        } else if is_below(INT128_MAX) {
            Exactness::Int128
        } else {
            Exactness::Big
        };
        let is_double = exactness.is_double();
        let unit = if is_double { 1.0 } else { unit_for(&extent) };
        let middle = |axis: usize| extent.lower[axis] * unit * 0.5 + extent.upper[axis] * unit * 0.5;
        let centre = std::array::from_fn(|axis| if is_double { middle(axis).floor() } else { middle(axis) });
        Sites { points, exactness, unit, centre }
    }

    /// Some of the sites, scaled as all of them are.
    pub(super) fn part(&self, numbers: &[u32]) -> Sites {
        let points = numbers.iter().map(|&number| self.points[number as usize]).collect();
        Sites { points, ..*self }
    }

    /// A point near the origin: exact small integers, or rounded numbers between -1 and 1 that differ by at
    /// most 1.
    pub(super) fn near(&self, number: u32) -> Point4 {
        let point = self.points[number as usize];
        std::array::from_fn(|axis| point[axis] * self.unit - self.centre[axis])
    }
}

/// The power of two that makes the greatest difference a number from 1/2 to 1.
fn unit_for(extent: &Extent<4>) -> f64 {
    // Halves do not overflow. A box of subnormal size is scaled by the largest power of two.
    let half = (0..4).map(|axis| extent.upper[axis] * 0.5 - extent.lower[axis] * 0.5).fold(0.0, f64::max);
    let exponent = (half.to_bits() >> 52) as i32 - 1023;
    match (-exponent - 2).min(1023) {
        normal @ -1022.. => 2f64.powi(normal),
        // For extents near the largest f64, the unit is subnormal.
        subnormal => f64::from_bits(1 << (subnormal + 1074)),
    }
}

/// Sorts points lexicographically, removes duplicates, and returns their number as well. Values are permuted
/// alike; of equal points, the value of the first is kept.
pub(super) fn distinct(
    points: Vec<Point4>,
    values: Option<Vec<f64>>,
) -> (Vec<Point4>, Option<Vec<f64>>, u64) {
    // Turn -0 into 0, so that the result does not depend on which comes first.
    let points: Vec<Point4> = points.into_iter().map(|point| point.map(|x| x + 0.0)).collect();
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    let at = |number: &u32| points[*number as usize];
    order.sort_unstable_by(|a, b| lexicographic(at(a), at(b)).then(a.cmp(b)));
    order.dedup_by(|a, b| at(a) == at(b));
    let sorted: Vec<Point4> = order.iter().map(at).collect();
    let values = values.map(|values| order.iter().map(|&number| values[number as usize]).collect());
    let merged = (points.len() - sorted.len()) as u64;
    (sorted, values, merged)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_near_the_origin() {
        let far = |x: f64| Sites::new(vec![[x, 0.0, 0.0, 0.0], [x * 1.5, x * 0.25, 0.0, 0.0]]);
        for x in [1e-310, 1e-300, 1e-20, 0.3, 5e6, 1e100, 1e307, 1e308, 1.19e308] {
            let sites = far(x);
            assert_eq!(sites.exactness, if x == 5e6 { Exactness::Big } else { sites.exactness });
            let near = [sites.near(0), sites.near(1)];
            let difference = near[1][0] - near[0][0];
            assert!((0.5..=1.0).contains(&difference) || x < 1e-305, "{x}: {near:?}");
        }
        let small = Sites::new(vec![[7.0, 1000.0, 0.0, 0.0], [9.0, 1003.0, 0.0, 0.0]]);
        assert_eq!((small.exactness, small.near(1)), (Exactness::Small, [1.0, 2.0, 0.0, 0.0]));
        let less_small = Sites::new(vec![[7.0, 1000.0, 0.0, 0.0], [9.0, 1027.0, 0.0, 0.0]]);
        assert_eq!((less_small.exactness, less_small.near(1)), (Exactness::Double, [1.0, 14.0, 0.0, 0.0]));
        let wide = Sites::new(vec![[0.0; 4], [1_048_575.0, 0.0, 0.0, 0.0]]);
        assert_eq!(wide.exactness, Exactness::Int128);
    }

    #[test]
    fn equal_points_are_one() {
        let points = vec![[1.0, 0.0, 0.0, 0.0], [0.0; 4], [-0.0; 4], [1.0, -0.0, 0.0, 0.0]];
        let (points, values, merged) = distinct(points, Some(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(points, [[0.0; 4], [1.0, 0.0, 0.0, 0.0]]);
        assert_eq!((values, merged), (Some(vec![2.0, 1.0]), 2));
    }
}
