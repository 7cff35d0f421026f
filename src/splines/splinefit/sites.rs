//! Places with several points: stations that measured more than once.

use crate::fitting::Observation;
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::Point2;

/// Points of which those at one place are merged into one, with their mean and the sum of their weights.
///
/// A fit to them has the coefficients of the fit to all points: the sums of squares differ by a constant. But
/// how much to smooth then depends on places, not on how often each was measured.
#[derive(Debug)]
pub struct Sites {
    /// The merged points, in the order of the first ones.
    pub(super) merged: Vec<Observation>,
    /// The standard deviation of a point of weight one, from points of one place: it does not depend on any
    /// spline. `None` if no place has two points of weight.
    pub pure_error: Option<f64>,
}

impl Sites {
    /// Merges points; `None` if each is at a place of its own.
    pub(super) fn of(points: &[Observation]) -> Option<Sites> {
        if points.iter().any(|one| !one.point.iter().all(|x| x.is_finite())) {
            return None;
        }
        let places: Vec<Point2> = points.iter().map(|one| one.point).collect();
        let firsts = distinct(&places);
        if (0..).zip(&firsts).all(|(id, &first)| id == first) {
            return None;
        }
        // Where the first point of each place is among the merged ones.
        let mut numbers = vec![0u32; points.len()];
        let mut merged: Vec<Observation> = Vec::new();
        for (id, one) in points.iter().enumerate().filter(|&(id, _)| firsts[id] as usize == id) {
            numbers[id] = merged.len() as u32;
            merged.push(Observation { value: 0.0, weight: 0.0, ..*one });
        }
        let number = |id: usize| numbers[firsts[id] as usize] as usize;
        for (id, one) in points.iter().enumerate() {
            let site = &mut merged[number(id)];
            site.weight += one.weight;
            // West's update: sums of great values would lose the digits in which values differ.
            if site.weight > 0.0 {
                site.value += one.weight / site.weight * (one.value - site.value);
            }
        }
        let (mut square, mut weighted) = (0.0, 0u64);
        for (id, one) in points.iter().enumerate().filter(|(_, one)| one.weight > 0.0) {
            square += one.weight * (one.value - merged[number(id)].value).powi(2);
            weighted += 1;
        }
        let sites = merged.iter().filter(|site| site.weight > 0.0).count() as u64;
        let free = weighted - sites;
        let pure_error = (free > 0).then(|| (square / free as f64).sqrt());
        Some(Sites { merged, pure_error })
    }

    /// Number of places.
    pub fn count(&self) -> u64 {
        self.merged.len() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_one_place_become_their_mean() {
        let at = |x: f64, value: f64, weight: f64| Observation { point: [x, 1.0], value, weight };
        let points =
            [at(0.0, 1.0, 1.0), at(2.0, 5.0, 1.0), at(0.0, 4.0, 2.0), at(3.0, 7.0, 0.0), at(-0.0, 1.0, 1.0)];
        let sites = Sites::of(&points).unwrap();
        assert_eq!(sites.merged, [at(0.0, 2.5, 4.0), at(2.0, 5.0, 1.0), at(3.0, 0.0, 0.0)]);
        // (2.25 + 2 * 2.25 + 2.25) / (4 - 2)
        assert!((sites.pure_error.unwrap().powi(2) - 4.5).abs() < 1e-14);
        assert!(Sites::of(&points[1..4]).is_none() && Sites::of(&[]).is_none());
        assert_eq!(Sites::of(&[at(0.0, 1.0, 1.0), at(0.0, 1.0, 0.0)]).unwrap().pure_error, None);
    }

    #[test]
    fn great_values_keep_their_digits() {
        let values = [1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0];
        let points = values.map(|value| Observation::new([0.0; 2], value));
        let sites = Sites::of(&points).unwrap();
        assert_eq!((sites.merged[0].value, sites.merged[0].weight), (1e9 + 2.0, 3.0));
        assert_eq!(sites.pure_error, Some(1.0));
    }
}
