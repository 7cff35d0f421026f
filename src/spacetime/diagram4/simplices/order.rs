//! The order of insertion: rounds, each along a Hilbert curve.

use super::first;
use crate::diagram4::exact::Exactness;
use crate::diagram4::sites::Sites;
use spmesh_base::error::Result;
use spmesh_delaunay::order::{Curve, Rounds, SpatialOrder};
use spmesh_delaunay::predicates::Extent;

/// The sites in the order of their insertion, five that span space first.
///
/// On a full grid, compared with rounds of sublattices, one pass along the curve creates four times as many
/// simplices, rounds of random points twice as many, and lexicographic order twenty times as many.
pub(in crate::diagram4) fn insertions(sites: &Sites) -> Result<Vec<u32>> {
    let extent = Extent::of(&sites.points);
    let curve: Vec<u32> = SpatialOrder::default().sort(&sites.points, &extent, Curve::Hilbert).collect();
    let mut order = if is_grid(sites, &extent) {
        by_sublattices(sites, &extent, &curve)
    } else {
        rounds(&curve).collect()
    };
    first::to_front(sites, &mut order)?;
    Ok(order)
}

/// Whether the sites are at least half of the integer points of their box.
///
/// With fewer sites, sublattices still save simplices, but no time, because there are more rounds.
fn is_grid(sites: &Sites, extent: &Extent<4>) -> bool {
    let box_points: f64 = (0..4).map(|axis| extent.upper[axis] - extent.lower[axis] + 1.0).product();
    sites.exactness != Exactness::Big && sites.points.len() as f64 >= 0.5 * box_points
}

/// A biased randomized insertion order: a few points first, then those between.
fn rounds(curve: &[u32]) -> impl Iterator<Item = u32> {
    Rounds::new(curve.len()).map(|place| curve[place as usize])
}

/// Sorts integer points by sublattice, the sparsest first.
///
/// Every second point of Z^4 is in D4, whose cells have eight vertices. The centre of each cell is a point of
/// one of three classes, one of which is the rest of Z^4. Such a point creates 16 simplices, but a point
/// among random points about 130. Every second point of D4 in turn is in a copy of Z^4, rotated and scaled by
/// the square root of two, and so on.
///
/// In a random sample, parities are random, and so are the rounds.
fn by_sublattices(sites: &Sites, extent: &Extent<4>, curve: &[u32]) -> Vec<u32> {
    let level = |&number: &u32| {
        let point = sites.points[number as usize];
        level(std::array::from_fn(|axis| (point[axis] - extent.lower[axis]) as u64)) as usize
    };
    let mut levels: Vec<Vec<u32>> = vec![Vec::new(); LEVELS];
    for number in curve {
        levels[level(number)].push(*number);
    }
    let mut order = Vec::with_capacity(curve.len());
    for points in levels.iter().rev() {
        // Where almost all points are in one class, classes do not help.
        if points.len() > FEW * order.len() {
            order.extend(rounds(points));
        } else {
            order.extend(points);
        }
    }
    order
}

/// Largest ratio of a class to all classes before it for which it is one round.
const FEW: usize = 4;

/// Number of levels of integers of up to 21 bits.
const LEVELS: usize = 4 * 21 + 1;

/// The number of the last lattice in the sequence Z^4, D4, Z^4 rotated, D4 rotated, 2 Z^4, ... that contains
/// the point.
fn level(mut point: [u64; 4]) -> u32 {
    let mut level = 0;
    while point != [0; 4] {
        let [x, y, z, t] = point;
        let tests = [x + y + z + t, x + y, x + z, x];
        if let Some(last) = tests.iter().position(|test| test % 2 == 1) {
            return level + last as u32;
        }
        level += 4;
        point = point.map(|coordinate| coordinate / 2);
    }
    LEVELS as u32 - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagram4::exact::INT128_MAX;

    #[test]
    fn every_lattice_has_half_of_the_points_of_the_one_before() {
        let points = (0..1 << 16).map(|i: u64| [i & 15, i >> 4 & 15, i >> 8 & 15, i >> 12]);
        let mut counts = [0; LEVELS];
        points.for_each(|point| counts[level(point) as usize] += 1);
        assert!((0..16).all(|level| counts[level] == 1 << (15 - level)), "{counts:?}");
        assert_eq!(counts[LEVELS - 1], 1, "the origin is of all");
    }

    #[test]
    fn there_are_levels_for_all_integers() {
        let greatest = 1 << INT128_MAX.log2() as u32;
        assert!(level([greatest; 4]) < LEVELS as u32 - 1 && greatest * 2 > INT128_MAX as u64);
    }

    #[test]
    fn points_of_one_class_come_in_rounds() {
        // All sums are odd but of the first.
        let points: Vec<[f64; 4]> = (0..200)
            .map(|i| [f64::from(i % 7 * 2), f64::from(i / 7), f64::from(i / 7), f64::from(i.min(1))])
            .collect();
        let (points, _, _) = crate::diagram4::sites::distinct(points, None);
        let sites = Sites::new(points);
        let extent = Extent::of(&sites.points);
        let curve: Vec<u32> = (0..sites.points.len() as u32).collect();
        let mut order = by_sublattices(&sites, &extent, &curve);
        assert!(!order[1..].is_sorted(), "not in one pass");
        order.sort_unstable();
        assert_eq!(order, curve);
    }
}
