//! The temporary file for waiting points that exceed memory: extents, chained per cell.
//!
//! An extent is the offset of the next extent of its cell, its own length, and points. Extents are appended,
//! and read back from first to last when their cell is complete. No memory is needed per extent.

use std::path::Path;

use spmesh_base::error::Result;
use spmesh_base::temporary::TemporaryFile;

/// No extent.
pub(super) const NO_EXTENT: u64 = u64::MAX;

const EXTENT_HEADER_LEN: usize = 16;
/// The operation, for messages.
const READING: &str = "reading points back";

/// Extents of points.
pub(super) struct Spill {
    file: TemporaryFile,
    /// Bytes that wait to be written at `end`.
    waiting: Vec<u8>,
    waiting_max: usize,
    end: u64,
    /// The piece that was read back last.
    piece: Vec<u8>,
}

impl Spill {
    /// An empty file in `folder`, or in the system's folder for temporary files, written and read in pieces
    /// of `io_len` bytes.
    pub(super) fn create(folder: Option<&Path>, io_len: usize) -> Result<Spill> {
        let file = TemporaryFile::create(folder)?;
        let waiting = Vec::with_capacity(io_len);
        Ok(Spill { file, waiting, waiting_max: io_len, end: 0, piece: vec![0; io_len] })
    }

    /// Bytes in the file.
    pub(super) fn len(&self) -> u64 {
        self.end + self.waiting.len() as u64
    }

    /// Starts an extent of `len` bytes that follows `previous` in the chain of its cell. Returns its offset.
    ///
    /// `previous` must have been flushed.
    pub(super) fn start_extent(&mut self, previous: u64, len: u64) -> Result<u64> {
        let offset = self.len();
        if previous != NO_EXTENT {
            debug_assert!(previous < self.end);
            self.write_at(&offset.to_le_bytes(), previous)?;
        }
        self.append(&NO_EXTENT.to_le_bytes())?;
        self.append(&len.to_le_bytes())?;
        Ok(offset)
    }

    /// Appends bytes to the extent that was started last.
    pub(super) fn append(&mut self, mut bytes: &[u8]) -> Result<()> {
        while !bytes.is_empty() {
            let free = self.waiting_max - self.waiting.len();
            let (now, later) = bytes.split_at(free.min(bytes.len()));
            self.waiting.extend_from_slice(now);
            bytes = later;
            if self.waiting.len() == self.waiting_max {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Writes the waiting bytes.
    pub(super) fn flush(&mut self) -> Result<()> {
        self.write_at(&self.waiting, self.end)?;
        self.end += self.waiting.len() as u64;
        self.waiting.clear();
        Ok(())
    }

    /// Calls `consume` with the content of the extent at `first` and of those chained to it, in pieces of
    /// whole records. All extents must have been flushed.
    pub(super) fn read_chain(
        &mut self,
        first: u64,
        record_len: usize,
        mut consume: impl FnMut(&[u8]) -> Result<()>,
    ) -> Result<()> {
        debug_assert!(self.waiting.is_empty());
        let piece_max = (self.piece.len() / record_len * record_len) as u64;
        let mut extent = first;
        while extent != NO_EXTENT {
            let mut header = [0; EXTENT_HEADER_LEN];
            self.file.read_at(READING, &mut header, extent)?;
            let (next, len) = header.split_at(8);
            let len = u64::from_le_bytes(len.try_into().expect("8 bytes"));
            let mut done = 0;
            while done < len {
                let piece = 0..(len - done).min(piece_max) as usize;
                let offset = extent + EXTENT_HEADER_LEN as u64 + done;
                self.file.read_at(READING, &mut self.piece[piece.clone()], offset)?;
                consume(&self.piece[piece.clone()])?;
                done += piece.len() as u64;
            }
            extent = u64::from_le_bytes(next.try_into().expect("8 bytes"));
        }
        Ok(())
    }

    fn write_at(&self, bytes: &[u8], offset: u64) -> Result<()> {
        self.file.write_at("writing points that exceed --memory", bytes, offset)
    }
}
