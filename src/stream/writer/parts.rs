//! Writes which vertices a part of a mesh shares with other parts.

use std::io::Write;

use super::{StreamWriter, Tag};
use crate::event::Patch;
use crate::part::{Origin, check_shared, encode_origins};
use spmesh_base::error::Result;

impl<W: Write> StreamWriter<W> {
    /// Writes what a patch says about vertices of other parts, if anything, before the patch.
    pub(super) fn write_shared(&mut self, patch: &Patch) -> Result<()> {
        check_shared(self.header.part, patch)?;
        self.write_origins(patch.origins.iter().copied())?;
        if patch.kept.is_empty() {
            return Ok(());
        }
        self.expect_part();
        let payload = &mut self.payload;
        payload.clear();
        patch.kept.iter().for_each(|local| payload.extend_from_slice(&local.to_le_bytes()));
        self.flush_block(Tag::Kept)
    }

    /// Writes which new vertices of the next patch are those of other parts, if any.
    pub(super) fn write_origins(&mut self, origins: impl Iterator<Item = Origin>) -> Result<()> {
        self.payload.clear();
        encode_origins(origins, &mut self.payload);
        if self.payload.is_empty() {
            return Ok(());
        }
        self.expect_part();
        self.flush_block(Tag::Origins)
    }

    fn expect_part(&self) {
        assert!(self.header.part.is_some(), "vertices of other parts in a mesh whose header is that of none");
    }
}
