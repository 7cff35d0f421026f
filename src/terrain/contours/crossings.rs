//! The edges of a triangle that the lines through it pass.

use super::places::Vertex;
use spmesh_delaunay::predicates::Point2;

/// A level on an edge, given by the ids of its ends, the lesser first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Crossing {
    pub(super) edge: [u64; 2],
    pub(super) level: i64,
}

/// The piece of a line in a triangle: the edges where it enters and where it leaves. Edge i leads from corner
/// i to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Piece {
    pub(super) level: i64,
    pub(super) from: usize,
    pub(super) to: usize,
}

/// The levels that pass through a triangle: at least one corner is above them, and one is not.
pub(super) fn levels([a, b, c]: [&Vertex; 3]) -> std::ops::RangeInclusive<i64> {
    a.rank.min(b.rank).min(c.rank) + 1..=a.rank.max(b.rank).max(c.rank)
}

/// The piece of the line of one of these levels in a counterclockwise triangle.
///
/// Corners above the level are on the left of the line. So the line enters over the edge that leads,
/// counterclockwise, from above to below, and leaves over the edge that leads from below to above. The
/// adjacent triangle has the edge in the other direction, so pieces fit.
pub(super) fn piece(corners: [&Vertex; 3], level: i64) -> Piece {
    let is_above = corners.map(|corner| corner.rank >= level);
    let edge = |is_from: bool| (0..3).find(|&i| is_above[i] == is_from && is_above[(i + 1) % 3] != is_from);
    Piece { level, from: edge(true).unwrap_or(0), to: edge(false).unwrap_or(0) }
}

/// A corner of a triangle that a line passes, and the side of the line where it is.
///
/// Every corner of the triangles along a ring is an end of an edge that the ring crosses. So the least of all
/// of them, by x and then y, is outside: the least place inside of the ring is on an edge, one end of which
/// is less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    at: Point2,
    pub(super) is_above: bool,
}

impl Side {
    /// The least corner of a triangle.
    pub(super) fn least(corners: [&Vertex; 3], level: i64) -> Side {
        let [a, b, c] = corners.map(|corner| Side { at: corner.at, is_above: corner.rank >= level });
        a.min(b).min(c)
    }

    /// The lesser one.
    pub(super) fn min(self, other: Side) -> Side {
        if other.at < self.at { other } else { self }
    }
}

/// The ends of an edge of a triangle.
pub(super) fn ends(corners: [&Vertex; 3], edge: usize) -> [&Vertex; 2] {
    [corners[edge], corners[(edge + 1) % 3]]
}

/// The crossing of a level and an edge.
pub(super) fn crossing([p, q]: [&Vertex; 2], level: i64) -> Crossing {
    Crossing { edge: [p.id.min(q.id), p.id.max(q.id)], level }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn higher_ground_is_on_the_left() {
        let corners = |ranks: [i64; 3]| {
            [0, 1, 2].map(|i| Vertex { id: i as u64, at: [0.0; 2], elevation: 0.0, rank: ranks[i] })
        };
        // With one corner above, the line enters over the edge that starts there.
        for first in 0..3 {
            let mut ranks = [3; 3];
            ranks[first] = 5;
            let triangle = corners(ranks);
            assert_eq!(levels(triangle.each_ref()), 4..=5);
            assert_eq!(piece(triangle.each_ref(), 5), Piece { level: 5, from: first, to: (first + 2) % 3 });
            ranks = [5; 3];
            ranks[first] = 3;
            assert_eq!(
                piece(corners(ranks).each_ref(), 4),
                Piece { level: 4, from: (first + 2) % 3, to: first }
            );
        }
        assert!(levels(corners([2; 3]).each_ref()).is_empty());
    }
}
