//! Stores the bytes of tiles: in the output directly, or in a temporary file, from which they can be read
//! back and reordered.

use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;

/// The actions that errors of the temporary file name.
const KEEPING: &str = "keeping tiles";
const READING: &str = "reading tiles back";

/// Offset and length of a piece; zeros if there is none.
pub(super) type Extent = [u64; 2];

/// Pieces one after the other.
pub(super) enum Store<'a> {
    /// In the output, after room for the bytes before the pieces.
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

/// An output. If it cannot seek, pieces must be staged.
pub(super) trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

impl<'a> Store<'a> {
    /// Writes pieces directly to the output, after `head_len` bytes left free.
    pub(super) fn direct(output: &'a mut dyn WriteSeek, head_len: u64) -> Result<Store<'a>> {
        std::io::copy(&mut std::io::Read::take(std::io::repeat(0), head_len), output).map_err(write_error)?;
        Ok(Store::Direct { output, end: head_len })
    }

    /// Writes pieces to a temporary file.
    pub(super) fn staged(output: &'a mut dyn WriteSeek, temp_dir: Option<&Path>) -> Result<Store<'a>> {
        Ok(Store::Staged { output, file: TemporaryFile::create(temp_dir)?, end: 0 })
    }

    /// Adds a piece.
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

    /// Reads a staged piece back. Leaves `bytes` empty if pieces are not staged.
    pub(super) fn read(&self, [offset, len]: Extent, bytes: &mut Vec<u8>) -> Result<()> {
        bytes.clear();
        if let Store::Staged { file, .. } = self {
            bytes.resize(len as usize, 0);
            file.read_at(READING, bytes, offset)?;
        }
        Ok(())
    }

    /// Lays out staged pieces in the output after `head_len` bytes, in the order of `extents`, and sets
    /// `extents` accordingly. Returns their extents in the temporary file. Pieces that are not staged stay
    /// where they are.
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

    /// Writes the head, and copies staged pieces after it.
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
