//! How often the simplices around a vertex go around it.
//!
//! Let all simplices at a vertex be positive, and let each of their facets at it meet its twin. Seen from the
//! vertex they are positive arcs or triangles on a small circle or sphere, joined without a border; so they
//! cover every direction equally often, and it is enough to count for one. If that is once, they tile the
//! circle or sphere: the link is one cycle or one sphere, wound once. (Two fans that close at one vertex
//! count two, and so does a fan that goes around twice before it closes.)
//!
//! A vertex on the boundary of a correct mesh has no simplex in some directions, and one in all others.
//!
//! The direction is that of an axis, infinitesimally off towards the next ones, so that no facet contains it.
//! Comparisons in the plane, and signs of projected triangles in space, decide which facets face it. From a
//! corner of a simplex the direction leads into the simplex if all facets at this corner face away from it,
//! hence the one opposite faces it. So a simplex counts for one corner at most.

use super::check::{Check, Violation};
use super::vertices::Vertex;

/// How many simplices a vertex has ahead, which means in the direction, and behind, in the opposite
/// direction; 65,535 means that many or more.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Winding {
    ahead: u16,
    behind: u16,
}

/// Where a simplex is, seen from one of its corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Ahead,
    Behind,
}

/// The corner of a simplex that has it ahead or behind, if there is one. `is_facing` says for the facet
/// opposite to each corner whether its outer side faces the direction.
pub(super) fn corner_of<const N: usize>(is_facing: [bool; N]) -> Option<(usize, Place)> {
    let facing = is_facing.iter().rev().fold(0u32, |bits, &is_facing| bits << 1 | u32::from(is_facing));
    // The case is unpredictable, so no branch depends on it.
    let is_ahead = facing.is_power_of_two();
    let odd = if is_ahead { facing } else { facing ^ ((1 << N) - 1) };
    let place = if is_ahead { Place::Ahead } else { Place::Behind };
    odd.is_power_of_two().then_some((odd.trailing_zeros() as usize, place))
}

impl Winding {
    pub(super) fn add(&mut self, place: Place) {
        let is_ahead = place == Place::Ahead;
        self.ahead = self.ahead.saturating_add(u16::from(is_ahead));
        self.behind = self.behind.saturating_add(u16::from(!is_ahead));
    }

    /// How many simplices are ahead.
    pub(super) fn ahead(self) -> u16 {
        self.ahead
    }

    /// Proves that a vertex whose facets all met their twins is gone around once.
    pub(super) fn check_once<S>(self, vertex: &Vertex<S>) -> Result<(), Violation> {
        if self == (Winding { ahead: 1, behind: 1 }) {
            return Ok(());
        }
        Err(fault(vertex, format!("go around it {} times, expected once", self.ahead.max(self.behind))))
    }

    /// Proves of a vertex with open facets that no more than one simplex is in either direction.
    pub(super) fn check_at_most_once<S>(self, vertex: &Vertex<S>) -> Result<(), Violation> {
        let most = self.ahead.max(self.behind);
        if most <= 1 {
            return Ok(());
        }
        Err(fault(vertex, format!("cover a direction {most} times, expected at most once")))
    }
}

fn fault<S>(vertex: &Vertex<S>, what: String) -> Violation {
    let message = format!("the simplices around vertex {} {what}", vertex.id);
    Violation::new(Check::Vertices, message).with(vertex.id, vertex.at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simplex_counts_for_the_corner_opposite_to_the_odd_facet() {
        assert_eq!(corner_of([false, true, false]), Some((1, Place::Ahead)));
        assert_eq!(corner_of([true, true, false]), Some((2, Place::Behind)));
        assert_eq!(corner_of([true, false, false, false]), Some((0, Place::Ahead)));
        assert_eq!(corner_of([true, true, true, false]), Some((3, Place::Behind)));
        assert_eq!(corner_of([true, false, true, false]), None);
    }

    #[test]
    fn once_is_one_ahead_and_one_behind() {
        let vertex = Vertex { id: 7, at: [1.0, 2.0, 3.0], weight: 0.0, star: () };
        for (ahead, behind, is_once, is_at_most_once) in [
            (0, 0, false, true),
            (1, 0, false, true),
            (1, 1, true, true),
            (2, 2, false, false),
            (0, 2, false, false),
        ] {
            let mut winding = Winding::default();
            (0..ahead).for_each(|_| winding.add(Place::Ahead));
            (0..behind).for_each(|_| winding.add(Place::Behind));
            assert_eq!(winding.check_once(&vertex).is_ok(), is_once, "{winding:?}");
            assert_eq!(winding.check_at_most_once(&vertex).is_ok(), is_at_most_once, "{winding:?}");
        }
    }
}
