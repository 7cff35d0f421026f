//! Writes what constrains a triangle mesh.

use std::io::Write;

use super::{StreamWriter, Tag};
use crate::constraints::{Segment, encode_segment, segment_len};
use crate::event::Patch;
use spmesh_base::error::Result;
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

impl<W: Write> StreamWriter<W> {
    /// Appends segments to a constrained mesh. They are numbered from 0 in the order in which they are
    /// written; the sides of later patches may name them.
    ///
    /// # Errors
    /// Malformed, if a coordinate does not fit the encoding of the header, a segment has equal ends, or there
    /// are too many; I/O, if writing fails.
    pub fn segments(&mut self, segments: &[Segment]) -> Result<()> {
        self.expect_constrained();
        self.constraint_rules.segments(segments)?;
        for segments in segments.chunks(BLOCK_PAYLOAD_MAX / segment_len(&self.header)) {
            self.payload.clear();
            for segment in segments {
                encode_segment(&self.header, segment, &mut self.payload)?;
            }
            self.flush_block(Tag::Segments)?;
        }
        Ok(())
    }

    /// Appends numbers of segments that leave the mesh, so that edges do not cover them: increasing, also
    /// over several calls. No patch or segment follows.
    ///
    /// # Errors
    /// Malformed, if a number is not that of a segment, or not above the one before; I/O, if writing fails.
    pub fn open_segments(&mut self, segments: &[u32]) -> Result<()> {
        self.expect_constrained();
        self.constraint_rules.open_segments(segments)?;
        for segments in segments.chunks(BLOCK_PAYLOAD_MAX / 4) {
            let payload = &mut self.payload;
            payload.clear();
            segments.iter().for_each(|segment| payload.extend_from_slice(&segment.to_le_bytes()));
            self.flush_block(Tag::OpenSegments)?;
        }
        Ok(())
    }

    /// Writes the sides of a patch, if it has any, before the patch.
    pub(super) fn write_sides(&mut self, patch: &Patch) -> Result<()> {
        if patch.sides.is_empty() {
            return Ok(());
        }
        self.expect_constrained();
        self.constraint_rules.sides(patch)?;
        let payload = &mut self.payload;
        payload.clear();
        patch.sides.as_flattened().iter().for_each(|number| payload.extend_from_slice(&number.to_le_bytes()));
        self.flush_block(Tag::Sides)
    }

    fn expect_constrained(&self) {
        assert!(self.header.constrained.is_some(), "segments of a mesh whose header is not constrained");
    }
}
