//! Points that coincide are merged while they wait, so that a cell of a few places, each with any number of
//! points, takes little memory.

use super::duplicates::{Duplicates, Merged};
use super::residual::Residual;
use spmesh_base::error::Result;
use spmesh_stream::{Coordinates, Weights};

/// Fewer points are not worth looking at.
const FEW: usize = 1 << 18;

/// Merges waiting points whenever their number has doubled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Merging {
    policy: Duplicates,
    coordinates: Coordinates,
    weights: Option<Weights>,
    next: usize,
}

impl Merging {
    pub(super) fn new(policy: Duplicates, coordinates: Coordinates, weights: Option<Weights>) -> Self {
        Merging { policy, coordinates, weights, next: FEW }
    }

    /// Begins with the points of another cell.
    pub(super) fn restart(&mut self) {
        self.next = FEW;
    }

    /// Merges raw points that coincide, if they are twice as many as after the last time; returns those that
    /// are gone. The mean of elevations needs all of them, so with that policy none is merged here.
    pub(super) fn merge<const D: usize>(&mut self, points: &mut Residual<D>) -> Result<Merged> {
        if points.len() < self.next || self.policy == Duplicates::Mean {
            return Ok(Merged::default());
        }
        let mut pairs = coinciding(&points.at);
        let merged = self.policy.settle(points, &mut pairs, &self.coordinates, self.weights)?;
        points.remove(pairs.iter().map(|pair| pair[0]));
        self.next = FEW.max(2 * points.len());
        Ok(merged)
    }
}

/// Pairs of a point and the first point that it coincides with.
fn coinciding<const D: usize>(at: &[[f64; D]]) -> Vec<[u32; 2]> {
    let bits = |i: u32| at[i as usize].map(f64::to_bits);
    let mut order: Vec<u32> = (0..at.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (bits(i), i));
    let groups = order.chunk_by(|&i, &j| bits(i) == bits(j));
    groups.flat_map(|group| group[1..].iter().map(|&point| [point, group[0]])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn merged(policy: Duplicates, points: &[[f64; 3]]) -> (Vec<[f64; 3]>, u64) {
        let mut raw = Residual::<2>::default();
        raw.extend_raw(points, &[]);
        let mut merging = Merging::new(policy, Coordinates::F64, None);
        let gone = merging.merge(&mut raw).expect("a policy that allows them");
        ((0..raw.len()).map(|i| raw.point(i)).collect(), gone.points)
    }

    #[test]
    fn each_place_keeps_one_point_and_the_order_of_the_stream() {
        // Seven places in turn, with elevations that rise and then fall.
        let count = FEW + 6;
        let point = |i: usize| [(i % 7) as f64, -0.0, (i.min(count - i)) as f64];
        let points: Vec<[f64; 3]> = (0..count).map(point).collect();
        let (first, gone) = merged(Duplicates::First, &points);
        assert_eq!((first.as_slice(), gone), (&points[..7], count as u64 - 7));
        let (lowest, _) = merged(Duplicates::Lowest, &points);
        let of_place = |place: usize| points.iter().skip(place).step_by(7).map(|point| point[2]);
        let least = |place: usize| of_place(place).fold(f64::INFINITY, f64::min);
        assert!((0..7).all(|place| lowest[place][2] == least(place)));
        assert_eq!(merged(Duplicates::Mean, &points).1, 0, "the mean needs all points");
        assert_eq!(merged(Duplicates::First, &points[..FEW - 1]).1, 0, "too few to look");
    }

    #[test]
    fn coinciding_points_can_be_an_error() {
        let mut raw = Residual::<2>::default();
        raw.extend_raw(&vec![[1.0, 2.0, 3.0]; FEW], &[]);
        assert!(Merging::new(Duplicates::Error, Coordinates::F64, None).merge(&mut raw).is_err());
    }
}
