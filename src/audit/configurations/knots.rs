//! Knots as the audit holds them, with ranks that it counts itself.

use std::cmp::Ordering;

use crate::exact::plane::{Xy, lexicographic};
use spmesh_base::error::{Error, Result};

/// Most knots of one stream: as many as the programs make configurations of.
const KNOTS_MAX: usize = 268_000_000;

/// Knots by id.
///
/// Several knots may be at one place. Their *rank* tells them apart: the number of knots at the same place
/// with lesser ids. Claims about them are claims about the limit of distinct points, with the knot of rank j
/// at `p + e (j, j * j)` for e > 0 that goes to 0.
///
/// Shape: 16 bytes per knot, and 4 for ranks if two knots are at one place.
#[derive(Debug, Clone, Default)]
pub struct Knots {
    points: Vec<Xy>,
    /// By id; empty if all ranks are 0.
    ranks: Vec<u32>,
}

impl Knots {
    /// Knots at `points`, with the indices as ids.
    ///
    /// Cost: a sort.
    ///
    /// # Errors
    /// Usage, if there are too many knots; malformed, if a coordinate is not finite.
    pub fn new(points: Vec<Xy>) -> Result<Knots> {
        if points.len() > KNOTS_MAX {
            let found = points.len();
            return Err(Error::usage(format!("{found} knots, at most {KNOTS_MAX} can be handled")));
        }
        if let Some(bad) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            let message = format!("coordinate is not finite: {:?}", points[bad]);
            return Err(Error::malformed(message).at(format!("knot {bad}")));
        }
        let ranks = ranks(&points);
        Ok(Knots { points, ranks })
    }

    /// Positions by id.
    pub fn points(&self) -> &[Xy] {
        &self.points
    }

    /// Number of knots, copies included.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no knot.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Number of knots of lesser id at the place of knot `id`.
    pub fn rank(&self, id: u32) -> u32 {
        self.ranks.get(id as usize).copied().unwrap_or(0)
    }
}

/// The rank of each knot, or nothing if all places are different.
///
/// When sorted by place, then by id, the knots at one place are a run. The rank of a knot is the number of
/// knots before it in its run. Places are ordered as numbers, for which -0 and 0 are equal.
fn ranks(points: &[Xy]) -> Vec<u32> {
    let place_order = |a: u32, b: u32| lexicographic(points[a as usize], points[b as usize]);
    let mut ids: Vec<u32> = (0..points.len() as u32).collect();
    ids.sort_unstable_by(|&a, &b| place_order(a, b).then(a.cmp(&b)));
    let mut ranks = Vec::new();
    for run in ids.chunk_by(|&a, &b| place_order(a, b) == Ordering::Equal).filter(|run| run.len() > 1) {
        ranks.resize(points.len(), 0);
        (0..).zip(run).for_each(|(rank, &id)| ranks[id as usize] = rank);
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, word for word.
    fn by_definition(points: &[Xy]) -> Vec<u32> {
        let lesser = |id: usize| points[..id].iter().filter(|place| **place == points[id]).count() as u32;
        (0..points.len()).map(lesser).collect()
    }

    #[test]
    fn ranks_are_those_of_the_definition() {
        for count in 0..60 {
            // Places on a grid of 4 by 3, where both zeros occur.
            let place = |i: u32| {
                let code = i.wrapping_mul(2_654_435_769) >> 7;
                let (zero, [x, y]) = ([0.0, -0.0][(code >> 8) as usize % 2], [code % 4, code / 4 % 3]);
                [x, y].map(|c| if c == 0 { zero } else { f64::from(c) - 2.0 })
            };
            let points: Vec<Xy> = (0..count).map(place).collect();
            let knots = Knots::new(points.clone()).unwrap();
            let found: Vec<u32> = (0..count).map(|id| knots.rank(id)).collect();
            assert_eq!(found, by_definition(&points), "{points:?}");
        }
    }

    #[test]
    fn zeros_of_either_sign_are_one_place() {
        let knots = Knots::new(vec![[0.0, -0.0], [1.0, 0.0], [-0.0, 0.0], [1.0, -0.0], [0.0, 0.0]]).unwrap();
        assert_eq!([0, 1, 2, 3, 4].map(|id| knots.rank(id)), [0, 0, 1, 1, 2]);
    }

    #[test]
    fn knots_at_different_places_have_no_ranks() {
        let knots = Knots::new(vec![[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]).unwrap();
        assert!(knots.ranks.is_empty() && (0..3).all(|id| knots.rank(id) == 0));
    }

    #[test]
    fn coordinates_must_be_finite() {
        let error = Knots::new(vec![[0.0, 0.0], [f64::NAN, 1.0]]).unwrap_err();
        assert!(error.to_string().contains("knot 1"), "{error}");
    }
}
