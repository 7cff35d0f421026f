//! Writes configurations.

use std::io::Write;

use super::{POINTS_PAYLOAD, StreamWriter, Tag};
use crate::ConfigurationBlock;
use spmesh_base::error::Result;

/// A block of this many words takes no further configuration.
const WORDS: usize = POINTS_PAYLOAD / 4;

/// Configurations that are buffered until their block is full.
pub(super) struct Waiting {
    block: ConfigurationBlock,
    /// Whether no block of the degree has been written yet. A degree without configurations gets a block,
    /// too.
    is_news: bool,
}

impl<W: Write> StreamWriter<W> {
    /// Appends configurations; all knots must have been written before, with [`StreamWriter::points`]. The
    /// writer divides them into blocks by length, independently of `block`.
    ///
    /// # Errors
    /// Malformed, if degrees, interior sets or boundaries are out of order or name unknown knots; I/O.
    pub fn configurations(&mut self, block: &ConfigurationBlock) -> Result<()> {
        self.flush_points()?;
        self.configuration_rules.block(block, self.totals.points)?;
        if self.waiting.as_ref().is_none_or(|waiting| waiting.block.degree != block.degree) {
            self.flush_configurations()?;
            let empty = ConfigurationBlock::new(block.degree, block.claim);
            self.waiting = Some(Waiting { block: empty, is_news: true });
        }
        for (interior, boundaries) in block.groups() {
            self.group(interior, boundaries)?;
        }
        self.totals.simplices += block.boundaries.len() as u64;
        Ok(())
    }

    fn group(&mut self, interior: &[u32], boundaries: &[[u32; 3]]) -> Result<()> {
        let mut rest = boundaries;
        while let (false, Some(Waiting { block, .. })) = (rest.is_empty(), &mut self.waiting) {
            let is_open = block.last_interior() == Some(interior);
            let words = block.words() + if is_open { 0 } else { interior.len() + 1 };
            let capacity = WORDS.saturating_sub(words) / 3;
            if capacity == 0 {
                self.flush_configurations()?;
                continue;
            }
            let (now, later) = rest.split_at(capacity.min(rest.len()));
            block.push(interior, now);
            rest = later;
        }
        Ok(())
    }

    /// Writes the buffered configurations; the degree stays open.
    pub(super) fn flush_configurations(&mut self) -> Result<()> {
        let Some(waiting) = &mut self.waiting else { return Ok(()) };
        if waiting.block.is_empty() && !waiting.is_news {
            return Ok(());
        }
        self.payload.clear();
        waiting.block.encode(&mut self.payload);
        waiting.block.clear();
        waiting.is_news = false;
        self.flush_block(Tag::Configurations)
    }
}
