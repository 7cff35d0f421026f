//! Blocks of 32 elements after a descriptor, as in SMB and SPB.

use std::io::Write;

use crate::sink::write_error;
use spmesh_base::error::Result;

const ELEMENTS_PER_BLOCK: u32 = 32;

/// Collects elements of equal length and writes them block by block, little-endian.
///
/// A block is a u32 whose bit i tells whether element i is a point (1) or of the other type (0), then the
/// elements. All blocks but the last have 32 elements; the last has fewer, possibly none.
pub(crate) struct ElementBlocks<W> {
    output: W,
    descriptor: u32,
    count: u32,
    elements: Vec<u8>,
}

impl<W: Write> ElementBlocks<W> {
    pub(crate) fn new(output: W) -> Self {
        ElementBlocks { output, descriptor: 0, count: 0, elements: Vec::new() }
    }

    /// Appends an element.
    pub(crate) fn push(&mut self, is_point: bool, element: &[u8]) -> Result<()> {
        self.descriptor |= u32::from(is_point) << self.count;
        self.count += 1;
        self.elements.extend_from_slice(element);
        if self.count == ELEMENTS_PER_BLOCK { self.write_block() } else { Ok(()) }
    }

    /// Writes the last block and flushes.
    pub(crate) fn end(&mut self) -> Result<()> {
        self.write_block()?;
        self.output.flush().map_err(write_error)
    }

    /// What the blocks are written to.
    pub(crate) fn output(&mut self) -> &mut W {
        &mut self.output
    }

    fn write_block(&mut self) -> Result<()> {
        self.output.write_all(&self.descriptor.to_le_bytes()).map_err(write_error)?;
        self.output.write_all(&self.elements).map_err(write_error)?;
        (self.descriptor, self.count) = (0, 0);
        self.elements.clear();
        Ok(())
    }
}
