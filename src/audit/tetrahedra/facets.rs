//! The oriented facets of tetrahedra that wait for their twin.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use foldhash::fast::RandomState;

use crate::audit::check::Violation;
use crate::audit::exact::space::Xyz;

/// A vertex as the geometry sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub(super) id: u64,
    pub(super) at: Xyz,
}

/// Adds the corners to what a violation concerns.
pub(super) fn name_corners(violation: Violation, corners: &[Corner]) -> Violation {
    corners.iter().fold(violation, |violation, corner| violation.with(corner.id, corner.at))
}

/// The corners of each facet of a positive tetrahedron, counterclockwise seen from outside; the facet opposite to
/// corner 0 first.
pub(super) const FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// What adding a facet did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meeting<T> {
    /// Its twin has not come yet.
    Open,
    /// Its twin was open and is not any more; what is known of the twin's tetrahedron.
    Twin(T),
    /// Another tetrahedron on the same side has the same facet open.
    Twice(T),
}

/// Facets between their tetrahedron and that of their twin, each with what is to be known of its tetrahedron: the
/// apex at least.
///
/// Memory: the boundary of the tetrahedra seen so far, which is the front of the stream and the hull.
#[derive(Debug)]
pub(super) struct OpenFacets<T> {
    open: HashMap<[u64; 3], Side<T>, RandomState>,
}

/// The tetrahedron on one side of a facet.
#[derive(Debug, Clone, Copy)]
struct Side<T> {
    tetrahedron: T,
    /// Whether the corners in increasing order are counterclockwise seen from outside of it.
    is_increasing: bool,
}

impl<T: Copy> OpenFacets<T> {
    pub(super) fn new() -> Self {
        OpenFacets { open: HashMap::default() }
    }

    /// Adds a facet, counterclockwise seen from outside of its tetrahedron.
    pub(super) fn meet(&mut self, facet: [u64; 3], tetrahedron: T) -> Meeting<T> {
        let (sorted, is_increasing) = increasing(facet);
        match self.open.entry(sorted) {
            Entry::Vacant(place) => {
                place.insert(Side { tetrahedron, is_increasing });
                Meeting::Open
            }
            Entry::Occupied(twin) if twin.get().is_increasing != is_increasing => {
                Meeting::Twin(twin.remove().tetrahedron)
            }
            Entry::Occupied(other) => Meeting::Twice(other.get().tetrahedron),
        }
    }

    /// Takes a facet away, counterclockwise seen from outside of its tetrahedron; whether it was open.
    pub(super) fn close(&mut self, facet: [u64; 3]) -> bool {
        let (sorted, is_increasing) = increasing(facet);
        match self.open.entry(sorted) {
            Entry::Occupied(open) if open.get().is_increasing == is_increasing => {
                open.remove();
                true
            }
            _ => false,
        }
    }

    /// The open facet with the smallest ids, counterclockwise seen from outside.
    pub(super) fn first(&self) -> Option<[u64; 3]> {
        self.iter().map(|(facet, _)| facet).min_by_key(|&facet| increasing(facet).0)
    }

    /// The open facets, counterclockwise seen from outside, with what is known of their tetrahedra, in no order.
    pub(super) fn iter(&self) -> impl Iterator<Item = ([u64; 3], T)> + '_ {
        self.open.iter().map(|(&[a, b, c], side)| {
            (if side.is_increasing { [a, b, c] } else { [a, c, b] }, side.tetrahedron)
        })
    }

    /// Number of open facets.
    pub(super) fn len(&self) -> usize {
        self.open.len()
    }
}

/// The ids in increasing order, and whether that is an even permutation.
pub(super) fn increasing(facet: [u64; 3]) -> ([u64; 3], bool) {
    let [a, b, c] = facet;
    let (a, b, is_even) = if a < b { (a, b, true) } else { (b, a, false) };
    if b < c {
        ([a, b, c], is_even)
    } else if a < c {
        ([a, c, b], !is_even)
    } else {
        ([c, a, b], is_even)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const APEX: Corner = Corner { id: 9, at: [0.0; 3] };

    #[test]
    fn facets_meet_the_other_orientation_only() {
        for facet in [[1, 2, 3], [2, 3, 1], [3, 1, 2], [1, 3, 2], [3, 2, 1], [2, 1, 3]] {
            let [a, b, c] = facet;
            for other in [[a, b, c], [b, c, a], [c, a, b]] {
                let mut facets = OpenFacets::new();
                assert_eq!(facets.meet(facet, APEX), Meeting::Open);
                assert_eq!(facets.meet(other, APEX), Meeting::Twice(APEX));
                let (found, _) = facets.iter().next().unwrap();
                assert!([[a, b, c], [b, c, a], [c, a, b]].contains(&found));
                assert_eq!(facets.meet([other[1], other[0], other[2]], APEX), Meeting::Twin(APEX));
                assert_eq!(facets.len(), 0);
            }
        }
    }
}
