//! Breaklines as a planar network: segments that meet at common vertices only.

use crate::points::Point2;

/// Lines after noding: all vertices are different, and segments have nothing in common but their ends. A
/// vertex may lie on no segment (a line of one place).
///
/// The same set of lines gives the same network, whatever their order and directions, up to the numbers of
/// lines.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Network {
    /// In lexicographic order of their places.
    pub vertices: Vec<NetworkVertex>,
    /// In increasing order of their ends.
    pub segments: Vec<NetworkSegment>,
}

/// A place that lines share or bend at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetworkVertex {
    /// Stored coordinates of the stream that the lines are for.
    pub place: Point2,
    /// Stored elevation, if a line states one here; otherwise that of the surface without lines counts.
    pub z: Option<f64>,
}

/// A straight part of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NetworkSegment {
    /// Numbers of its vertices, the lesser one first.
    pub ends: [u32; 2],
    /// Number of the line in the file; the least of those that have this segment in common.
    pub line: u32,
}

impl Network {
    /// The places of the ends of a segment.
    #[must_use]
    pub fn places(&self, segment: &NetworkSegment) -> [Point2; 2] {
        segment.ends.map(|end| self.vertices[end as usize].place)
    }
}
