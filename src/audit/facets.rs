//! The oriented facets of simplices whose twin is yet to come: edges of triangles, triangles of tetrahedra.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use foldhash::fast::RandomState;

/// The result of adding a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meeting<T> {
    /// Its twin has not come yet.
    Open,
    /// Its twin was open and is now closed; the data of the twin's simplex.
    Twin(T),
    /// Another simplex on the same side has the same facet open.
    Twice(T),
}

/// Open facets of `N` corners, whose twin has not come yet, each with data of its simplex: at least the apex.
///
/// Memory: the boundary of the simplices seen so far, which is the front of the stream and the hull.
#[derive(Debug)]
pub(super) struct OpenFacets<const N: usize, T> {
    open: HashMap<[u64; N], Side<T>, RandomState>,
}

/// The simplex on one side of a facet.
#[derive(Debug, Clone, Copy)]
struct Side<T> {
    simplex: T,
    /// Whether the corners in increasing order are an even permutation of their order in the simplex.
    is_increasing: bool,
}

impl<const N: usize, T: Copy> OpenFacets<N, T> {
    pub(super) fn new() -> Self {
        OpenFacets { open: HashMap::default() }
    }

    /// Adds a facet. Its twin has the opposite order: an edge runs in the other direction; a triangle is
    /// counterclockwise seen from outside of its own tetrahedron, which is on the other side.
    pub(super) fn meet(&mut self, facet: [u64; N], simplex: T) -> Meeting<T> {
        let (sorted, is_increasing) = increasing(facet);
        match self.open.entry(sorted) {
            Entry::Vacant(place) => {
                place.insert(Side { simplex, is_increasing });
                Meeting::Open
            }
            Entry::Occupied(twin) if twin.get().is_increasing != is_increasing => {
                Meeting::Twin(twin.remove().simplex)
            }
            Entry::Occupied(other) => Meeting::Twice(other.get().simplex),
        }
    }

    /// Removes a facet; returns the data of its simplex if it was open.
    pub(super) fn close(&mut self, facet: [u64; N]) -> Option<T> {
        let (sorted, is_increasing) = increasing(facet);
        match self.open.entry(sorted) {
            Entry::Occupied(side) if side.get().is_increasing == is_increasing => Some(side.remove().simplex),
            _ => None,
        }
    }

    /// The open facets, in no order: the corners in the order of the simplex, and the data of the simplex.
    pub(super) fn iter(&self) -> impl Iterator<Item = ([u64; N], T)> + '_ {
        self.open.iter().map(|(&sorted, side)| {
            let mut facet = sorted;
            if !side.is_increasing {
                facet.swap(N - 2, N - 1);
            }
            (facet, side.simplex)
        })
    }

    /// The open facet with the smallest ids, with its corners in the order of its simplex.
    pub(super) fn first(&self) -> Option<[u64; N]> {
        self.iter().map(|(facet, _)| facet).min_by_key(|&facet| increasing(facet).0)
    }

    pub(super) fn len(&self) -> usize {
        self.open.len()
    }
}

/// The ids in increasing order, and whether that is an even permutation.
pub(super) fn increasing<const N: usize>(mut facet: [u64; N]) -> ([u64; N], bool) {
    let mut is_even = true;
    for end in (1..N).rev() {
        for i in 0..end {
            if facet[i] > facet[i + 1] {
                facet.swap(i, i + 1);
                is_even = !is_even;
            }
        }
    }
    (facet, is_even)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_meet_the_other_orientation_only() {
        for facet in [[1, 2, 3], [2, 3, 1], [3, 1, 2], [1, 3, 2], [3, 2, 1], [2, 1, 3]] {
            let [a, b, c] = facet;
            for other in [[a, b, c], [b, c, a], [c, a, b]] {
                let mut facets = OpenFacets::new();
                assert_eq!(facets.meet(facet, 'p'), Meeting::Open);
                assert_eq!(facets.meet(other, 'q'), Meeting::Twice('p'));
                let (found, _) = facets.iter().next().unwrap();
                assert!([[a, b, c], [b, c, a], [c, a, b]].contains(&found));
                assert_eq!(facets.meet([other[1], other[0], other[2]], 'q'), Meeting::Twin('p'));
                assert_eq!(facets.len(), 0);
            }
        }
    }

    #[test]
    fn edges_meet_the_other_direction_only() {
        for [a, b] in [[1, 2], [2, 1]] {
            let mut edges = OpenFacets::new();
            assert_eq!(edges.meet([a, b], 'p'), Meeting::Open);
            assert_eq!(edges.meet([a, b], 'q'), Meeting::Twice('p'));
            assert_eq!(edges.iter().collect::<Vec<_>>(), [([a, b], 'p')]);
            assert_eq!(edges.close([b, a]), None);
            assert_eq!(edges.meet([b, a], 'q'), Meeting::Twin('p'));
            assert_eq!(edges.meet([b, a], 'q'), Meeting::Open);
            assert_eq!(edges.close([b, a]), Some('q'));
            assert_eq!(edges.len(), 0);
        }
    }
}
