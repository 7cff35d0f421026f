//! Where the bytes of tiles go: to the output at once, or to a temporary file, to be read again and brought
//! into order.

use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use spmesh_core::error::{Error, Result};
use spmesh_core::temporary::TemporaryFile;

/// What is being done when a temporary file fails.
const KEEPING: &str = "keeping tiles";
const READING: &str = "reading tiles back";

/// Where a piece is, and how long it is; zeros, if there is none.
pub(super) type Extent = [u64; 2];

/// Pieces one after the other.
pub(super) enum Store<'a> {
    /// In the output, after room for what stands before them.
    Direct {
        output: &'a mut dyn WriteSeek,
        end: u64,
    },
    Staged {
        output: &'a mut dyn WriteSeek,
        file: TemporaryFile,
        end: u64,
    },
}

/// An output; one that cannot be sought takes what is staged.
pub(super) trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

impl<'a> Store<'a> {
    /// Pieces in the output, which leave room for `head_len` bytes.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub(super) fn direct(output: &'a mut dyn WriteSeek, head_len: u64) -> Result<Store<'a>> {
        std::io::copy(&mut std::io::Read::take(std::io::repeat(0), head_len), output).map_err(write_error)?;
        Ok(Store::Direct { output, end: head_len })
    }

    /// Pieces in a temporary file.
    ///
    /// # Errors
    /// If it cannot be made.
    pub(super) fn staged(output: &'a mut dyn WriteSeek, temp_dir: Option<&Path>) -> Result<Store<'a>> {
        Ok(Store::Staged { output, file: TemporaryFile::create(temp_dir)?, end: 0 })
    }

    /// Adds a piece.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn put(&mut self, bytes: &[u8]) -> Result<Extent> {
        let end = match self {
            Store::Direct { output, end } => {
                output.write_all(bytes).map_err(write_error)?;
                end
            }
            Store::Staged { file, end, .. } => {
                file.write_at(KEEPING, bytes, *end)?;
                end
            }
        };
        let extent = [*end, bytes.len() as u64];
        *end += extent[1];
        Ok(extent)
    }

    /// Reads a piece again, of a temporary file; nothing from an output.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(super) fn read(&self, [offset, len]: Extent, bytes: &mut Vec<u8>) -> Result<()> {
        bytes.clear();
        if let Store::Staged { file, .. } = self {
            bytes.resize(len as usize, 0);
            file.read_at(READING, bytes, offset)?;
        }
        Ok(())
    }

    /// Says where pieces are going to be in the output, after so many bytes: where they are, or, if they were
    /// staged, in the order of `extents`. Gives where staged ones are now.
    pub(super) fn arrange<'b>(
        &self,
        extents: impl Iterator<Item = &'b mut Extent>,
        head_len: u64,
    ) -> Vec<Extent> {
        let Store::Staged { .. } = self else { return Vec::new() };
        let mut end = head_len;
        let mut place = |extent: &mut Extent| {
            let staged = *extent;
            extent[0] = end;
            end += staged[1];
            staged
        };
        extents.filter(|[_, len]| *len > 0).map(&mut place).collect()
    }

    /// Writes what stands before the pieces, and those that are staged.
    ///
    /// # Errors
    /// If writing or the temporary file fails.
    pub(super) fn finish(self, head: &[u8], staged: &[Extent]) -> Result<()> {
        match self {
            Store::Direct { output, .. } => {
                output.rewind().map_err(write_error)?;
                output.write_all(head).map_err(write_error)?;
                output.seek(SeekFrom::End(0)).map_err(write_error)?;
                output.flush().map_err(write_error)
            }
            Store::Staged { output, file, .. } => {
                output.write_all(head).map_err(write_error)?;
                let mut bytes = Vec::new();
                for [offset, len] in staged {
                    bytes.resize(*len as usize, 0);
                    file.read_at(READING, &mut bytes, *offset)?;
                    output.write_all(&bytes).map_err(write_error)?;
                }
                output.flush().map_err(write_error)
            }
        }
    }
}

fn write_error(error: std::io::Error) -> Error {
    Error::io("writing", error)
}
