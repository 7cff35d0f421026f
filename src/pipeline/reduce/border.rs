//! A checksum of whether walls are the border of the final simplices, without holding a facet.

use spmesh_base::random::mixed;
use spmesh_stream::Patch;

/// The border of simplices of D + 1 corners, less the walls around them, as one number.
///
/// Every oriented facet adds a hash of the ids of its corners; the same facet seen from its other side
/// subtracts it. So the two sides of a facet between two simplices cancel, walls cancel the other facets, and
/// the sum is zero. If a wall is missing, repeated or reversed, or a simplex is missing or repeated, the sum
/// is zero with probability 2^-64.
///
/// Cost: D + 1 numbers per simplex, no memory.
#[derive(Debug, Default)]
pub(super) struct Border<const D: usize> {
    sum: u64,
}

impl<const D: usize> Border<D> {
    /// Adds the simplices of a patch.
    pub(super) fn simplices(&mut self, patch: &Patch) {
        for simplex in patch.simplices.chunks_exact(D + 1) {
            for opposite in 0..=D {
                let facet = std::array::from_fn(|i| patch.id(simplex[i + usize::from(i >= opposite)]));
                // The facet opposite to the last corner has the orientation of a wall, the facet opposite to
                // the corner before it is reversed, and so on alternately.
                let number = number_of::<D>(facet);
                let is_seen_so = (D - opposite).is_multiple_of(2);
                self.sum = self.sum.wrapping_add(if is_seen_so { number } else { number.wrapping_neg() });
            }
        }
    }

    /// Subtracts a wall, given by the ids of its corners.
    pub(super) fn wall(&mut self, corners: [u64; D]) {
        self.sum = self.sum.wrapping_sub(number_of(corners));
    }

    /// Whether the walls are the border of the simplices.
    pub(super) fn is_closed(&self) -> bool {
        self.sum == 0
    }
}

/// The hash of a facet, negated for odd permutations of its corners.
fn number_of<const D: usize>(mut corners: [u64; D]) -> u64 {
    let mut is_odd = false;
    for end in (1..D).rev() {
        for i in 0..end {
            if corners[i] > corners[i + 1] {
                corners.swap(i, i + 1);
                is_odd = !is_odd;
            }
        }
    }
    let number = corners.iter().fold(0, |number, &id| mixed(number ^ id));
    if is_odd { number.wrapping_neg() } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch(simplices: &[u32]) -> Patch {
        Patch { new: vec![[0.0; 3]; 9], simplices: simplices.to_vec(), ..Patch::default() }
    }

    fn is_border<const D: usize>(simplices: &[u32], walls: &[[u64; D]]) -> bool {
        let mut border = Border::<D>::default();
        border.simplices(&patch(simplices));
        walls.iter().for_each(|&wall| border.wall(wall));
        border.is_closed()
    }

    #[test]
    fn edges_around_triangles() {
        let two = [5, 1, 2, 2, 1, 3];
        let walls = [[5, 1], [1, 3], [3, 2], [2, 5]];
        assert!(is_border(&two, &walls));
        assert!(!is_border(&two, &walls[1..]));
        assert!(!is_border::<2>(&two, &[]));
        assert!(!is_border(&two[..3], &walls));
        assert!(!is_border(&two, &[[1, 5], [1, 3], [3, 2], [2, 5]]));
        assert!(is_border::<2>(&[], &[]));
        assert!(!is_border(&[], &walls));
    }

    #[test]
    fn facets_around_tetrahedra() {
        let two = [0, 1, 2, 3, 1, 2, 3, 4];
        // Counterclockwise as seen from their tetrahedra, starting at any corner.
        let walls = [[0, 2, 3], [3, 1, 0], [1, 2, 0], [2, 4, 3], [1, 3, 4], [4, 2, 1]];
        assert!(is_border(&two, &walls));
        assert!(!is_border(&[0, 1, 2, 3, 1, 3, 2, 4], &walls), "both are on one side of their facet");
        assert!(!is_border(&two[..4], &walls));
        assert!(!is_border::<3>(&two, &[]));
        for turned in 0..6 {
            let mut others = walls;
            others[turned].swap(0, 2);
            assert!(!is_border(&two, &others), "{turned} is seen from the other side");
            assert!(
                !is_border(&two, &[&walls[..], &walls[turned..=turned]].concat()),
                "{turned} comes twice"
            );
        }
    }
}
