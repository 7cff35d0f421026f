//! Binary arrays as packed by the XML formats of VTK: after their length, in base64, and in compressed
//! blocks.

use std::io::{self, BufReader, Read};

use crate::source::origin::FileView;
use crate::source::point_arrays::Numbers;
use crate::vtk::base64::Base64Reader;
use crate::vtk::blocks::{Blocks, Compressor};
use crate::vtk::lengths::Lengths;
use spmesh_base::error::{Error, Result};

/// Bytes read at once.
const BUFFER_LEN: usize = 1 << 17;

/// Place and packing of a binary array.
#[derive(Debug, Clone)]
pub(crate) struct Framed {
    /// Range of the file that holds it; may extend beyond the array.
    pub(crate) start: u64,
    pub(crate) end: u64,
    pub(crate) is_base64: bool,
    pub(crate) lengths: Lengths,
    pub(crate) compressor: Option<Compressor>,
    /// Length of its numbers in bytes.
    pub(crate) len: u64,
}

impl Framed {
    /// The bytes of the numbers, possibly followed by others.
    ///
    /// Memory: buffers, and for LZ4 one block.
    pub(crate) fn open(&self, view: &FileView) -> Result<Numbers> {
        let mut head = self.bytes(view, 0)?;
        let Some(compressor) = self.compressor else {
            self.check(self.length(&mut head)?)?;
            return Ok(head);
        };
        let [blocks, block_len, last_len] =
            [self.length(&mut head)?, self.length(&mut head)?, self.length(&mut head)?];
        // A last length of zero means that the last block is as long as the others.
        let full = blocks.saturating_sub(u64::from(last_len > 0));
        if last_len > block_len || (blocks == 0 && self.len > 0) || (blocks > 0 && block_len == 0) {
            let message = format!("{blocks} compressed blocks of {block_len} bytes, the last of {last_len}");
            return Err(Error::malformed(message));
        }
        self.check(full.saturating_mul(block_len).saturating_add(last_len))?;
        let data = self.bytes(view, self.lengths.len().saturating_mul(blocks.saturating_add(3)))?;
        let blocks =
            Blocks { sizes: head, lengths: self.lengths, compressor, block_len, left: self.len, number: 0 };
        Ok(Box::new(BufReader::with_capacity(BUFFER_LEN, blocks.reader(data))))
    }

    /// Offset of the numbers, if they are stored unpacked.
    pub(crate) fn plain_start(&self, view: &FileView) -> Result<Option<u64>> {
        if self.is_base64 || self.compressor.is_some() {
            return Ok(None);
        }
        self.check(self.length(&mut view.range(self.start, self.end))?)?;
        let start = self.start + self.lengths.len();
        if self.end.saturating_sub(start) < self.len {
            return Err(Error::malformed(format!(
                "truncated: {} bytes are left of {}",
                self.end.saturating_sub(start),
                self.len
            )));
        }
        Ok(Some(start))
    }

    /// The array's bytes, decoded from base64 if necessary, without the first `skipped`.
    fn bytes(&self, view: &FileView, skipped: u64) -> Result<Numbers> {
        if !self.is_base64 {
            let start = self.start.saturating_add(skipped);
            return Ok(Box::new(BufReader::with_capacity(BUFFER_LEN, view.range(start, self.end))));
        }
        let encoded = BufReader::with_capacity(BUFFER_LEN, view.range(self.start, self.end));
        let mut decoded = Box::new(BufReader::with_capacity(BUFFER_LEN, Base64Reader::new(encoded)));
        let mut before = (&mut decoded).take(skipped);
        io::copy(&mut before, &mut io::sink()).map_err(|e| Error::io("reading", e))?;
        Ok(decoded)
    }

    fn length(&self, input: &mut impl Read) -> Result<u64> {
        self.lengths.read(input).map_err(|e| match e.kind() {
            io::ErrorKind::UnexpectedEof => Error::malformed("truncated: the array ends within its lengths"),
            _ => Error::io("reading", e),
        })
    }

    fn check(&self, found: u64) -> Result<()> {
        if found == self.len {
            return Ok(());
        }
        let expected = self.len;
        Err(Error::malformed(format!("array of {found} bytes, its points and type need {expected}")))
    }
}
