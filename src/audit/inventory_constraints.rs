//! Counts what constrains a triangle mesh.

use std::collections::HashSet;

use spmesh_stream::Event;

/// Counts of segments and of the sides on them.
#[derive(Debug, Default)]
pub struct ConstraintInventory {
    /// Segments.
    pub segments: u64,
    /// Sides of triangles that lie on segments. An edge between two triangles has two.
    pub sides: u64,
    /// Segments that leave the mesh.
    pub open_segments: u64,
    lines: HashSet<u32>,
}

impl ConstraintInventory {
    pub(super) fn event(&mut self, event: &Event) {
        match event {
            Event::Segments(segments) => {
                self.segments += segments.len() as u64;
                self.lines.extend(segments.iter().map(|segment| segment.line));
            }
            Event::Patch(patch) => self.sides += patch.sides.len() as u64,
            Event::OpenSegments(open) => self.open_segments += open.len() as u64,
            _ => {}
        }
    }

    /// Number of different lines that segments belong to.
    pub fn lines(&self) -> u64 {
        self.lines.len() as u64
    }
}
