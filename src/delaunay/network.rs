//! Breaklines as a planar network: segments that meet at common vertices only.

use crate::points::Point2;

/// Lines after noding: all vertices are different, and segments have nothing in common but their ends. A
/// vertex may lie on no segment (a line of one place).
///
/// The same set of lines gives the same network, whatever their order and directions, up to the numbers of
/// lines.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Network {
    /// In lexicographic order of their places.
    pub vertices: Vec<NetworkVertex>,
    /// In increasing order of their ends.
    pub segments: Vec<NetworkSegment>,
    /// The distance of neighbours on the grid that places are rounded to, in stored units.
    pub step: f64,
}

/// A place that lines share or bend at.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NetworkVertex {
    /// Stored coordinates of the stream that the lines are for.
    pub place: Point2,
    /// Stored elevation, if a line states one here; otherwise that of the surface without lines counts.
    pub z: Option<f64>,
}

/// A straight part of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NetworkSegment {
    /// Numbers of its vertices, the lesser one first.
    pub ends: [u32; 2],
    /// Number of the line in the file; the least of those that have this segment in common.
    pub line: u32,
    /// Whether a line states elevations along it: at both ends of a part of which this segment is a piece.
    pub is_hard: bool,
}

impl Network {
    /// The elevations of the ends of a segment, if a line states elevations along it.
    pub fn elevations(&self, segment: &NetworkSegment) -> Option<[f64; 2]> {
        let [a, b] = segment.ends.map(|end| self.vertices[end as usize].z);
        a.zip(b).map(<[f64; 2]>::from).filter(|_| segment.is_hard)
    }

    /// The places of the ends of a segment.
    pub fn places(&self, segment: &NetworkSegment) -> [Point2; 2] {
        segment.ends.map(|end| self.vertices[end as usize].place)
    }
}

/// The elevation at a place on an edge, between those of its ends. The lexicographically lesser end comes
/// first, so that the direction does not matter.
pub fn elevation_between([a, b]: [Point2; 2], elevations: [f64; 2], place: Point2) -> f64 {
    let difference = |to: Point2| [to[0] - a[0], to[1] - a[1]];
    let (whole, part) = (difference(b), difference(place));
    let axis = usize::from(whole[1].abs() > whole[0].abs());
    elevation_at(part[axis] / whole[axis], elevations)
}

/// The elevation at a part of the way between two ends.
pub fn elevation_at(part: f64, [low, high]: [f64; 2]) -> f64 {
    // Rounding must not lead beyond both ends: it could leave the box of the mesh.
    (low + (high - low) * part).clamp(low.min(high), low.max(high))
}
