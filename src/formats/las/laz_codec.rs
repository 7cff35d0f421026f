//! Checks how the records of a LAZ file are compressed, and decompresses single chunks.
//!
//! The decompressors of the `laz` crate are used chunk by chunk. The crate allocates memory by numbers that
//! it takes from the file unchecked (chunk table, lengths of chunks and layers); here these are checked
//! first.

use std::io::{Cursor, Read, Seek};

use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LazItemType, LazVlr};

use crate::las::header::LasHeader;
use crate::source::panic_guard::guarded;
use spmesh_base::error::{Error, Result};

/// Greatest number of items that the laszip record may split a point record into; the formats need four.
const ITEMS_MAX: usize = 16;

pub(crate) type Decompressor<R> = Box<dyn RecordDecompressor<R> + Send + Sync>;

/// How the records of a file are compressed, after checks.
#[derive(Debug, Clone)]
pub(crate) struct Codec {
    vlr: LazVlr,
    pub(crate) record_len: usize,
    /// Number of layers in a chunk, each with its length in the chunk's head; 0 if records are not layered.
    pub(crate) layers: usize,
    /// The fields to decompress.
    selection: DecompressionSelection,
}

impl Codec {
    /// Decompresses the fields of `selection`. Records without layers are always decompressed as a whole.
    pub(crate) fn new(vlr: LazVlr, header: &LasHeader, selection: DecompressionSelection) -> Result<Codec> {
        let items = vlr.items();
        let len: usize = items.iter().map(|item| usize::from(item.size())).sum();
        let first = items.first().map(|item| item.item_type());
        let expected = if header.format < 6 { LazItemType::Point10 } else { LazItemType::Point14 };
        if len != header.record_len || items.len() > ITEMS_MAX || first != Some(expected) {
            return Err(Error::malformed(format!(
                "laszip record: {} items of {len} bytes in all do not make up a record of format {} with {} bytes",
                items.len(),
                header.format,
                header.record_len
            )));
        }
        let layers = items.iter().map(|item| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(count) => usize::from(count),
            _ => 1,
        });
        let is_layered = matches!(items[0].version(), 3 | 4);
        let layers = if is_layered { layers.sum() } else { 0 };
        let codec = Codec { vlr, record_len: header.record_len, layers, selection };
        let decompressor = codec.decompressor(Cursor::new(&[][..]))?;
        if decompressor.record_size() != header.record_len {
            return Err(Error::malformed(format!(
                "laszip record: items decompress to {} bytes, a record has {}",
                decompressor.record_size(),
                header.record_len
            )));
        }
        Ok(codec)
    }

    pub(crate) fn decompressor<'a, R: Read + Seek + Send + Sync + 'a>(
        &self,
        input: R,
    ) -> Result<Box<dyn RecordDecompressor<R> + Send + Sync + 'a>> {
        let mut decompressor: Box<dyn RecordDecompressor<R> + Send + Sync + 'a> = if self.layers > 0 {
            Box::new(LayeredPointRecordDecompressor::new(input))
        } else {
            Box::new(SequentialPointRecordDecompressor::new(input))
        };
        self.prepare(&mut *decompressor)?;
        Ok(decompressor)
    }

    /// Prepares a decompressor for the start of a chunk. It decompresses only the layers of the selected fields:
    /// mostly, the other layers are most of the work.
    pub(crate) fn prepare<R>(&self, decompressor: &mut dyn RecordDecompressor<R>) -> Result<()> {
        decompressor
            .set_fields_from(self.vlr.items())
            .map_err(|e| Error::malformed(format!("laszip record: {e}")))?;
        decompressor.set_selection(self.selection);
        Ok(())
    }

    /// Checks the lengths of the layers of a chunk against `room`, the chunk's length in bytes. `head` holds
    /// the first record, the number of records, and the lengths. Returns the number of records.
    pub(crate) fn check_layers(&self, head: &[u8], room: u64) -> Result<u64> {
        let mut numbers = head[self.record_len..]
            .chunks_exact(4)
            .map(|bytes| u64::from(u32::from_le_bytes(bytes.try_into().expect("four bytes"))));
        let count = numbers.next().unwrap_or(0);
        let layers: u64 = numbers.sum();
        if layers + head.len() as u64 > room {
            return Err(Error::malformed(format!("layers of {layers} bytes in a chunk of {room}")));
        }
        Ok(count)
    }

    /// Length in bytes of a chunk before its layers.
    pub(crate) fn head_len(&self) -> usize {
        self.record_len + 4 + 4 * self.layers
    }

    /// Decompresses a whole chunk.
    pub(crate) fn decompress(&self, compressed: &[u8], records: &mut [u8]) -> Result<()> {
        if self.layers > 0 {
            let head = compressed
                .get(..self.head_len())
                .ok_or_else(|| Error::malformed("the chunk ends in the lengths of its layers"))?;
            let count = self.check_layers(head, compressed.len() as u64)?;
            let expected = (records.len() / self.record_len) as u64;
            if count != expected {
                return Err(Error::malformed(format!("chunk of {count} points, expected {expected}")));
            }
        }
        let work = || {
            let mut codec = self.decompressor(Cursor::new(compressed))?;
            let outcome = codec.decompress_many(records);
            Ok((outcome, codec.get().position()))
        };
        let (outcome, used) = match guarded(work) {
            Ok(work) => work?,
            Err(panic) => return decompression(Err(panic)),
        };
        decompression(Ok(outcome))?;
        self.check_end(compressed.len() as u64 - used)
    }

    /// Checks the number of bytes that are `left` of a chunk after its last point. The decoder of points in
    /// one layer uses as many bytes as the encoder has written.
    pub(crate) fn check_end(&self, left: u64) -> Result<()> {
        if self.layers > 0 || left == 0 {
            return Ok(());
        }
        Err(Error::malformed(format!(
            "{left} bytes follow the last point that the header states: it states too few points, or the \
             compressed points are damaged"
        )))
    }
}

/// Converts the outcome of a decompressor to a result of this library.
pub(crate) fn decompression(outcome: std::result::Result<std::io::Result<()>, String>) -> Result<()> {
    match outcome {
        Ok(Ok(())) => Ok(()),
        Ok(Err(e)) => Err(match e.kind() {
            std::io::ErrorKind::UnexpectedEof => Error::malformed("the compressed points end too early"),
            _ if e.raw_os_error().is_some() => Error::io("decompressing points", e),
            _ => Error::malformed(format!("the compressed points are damaged ({e})")),
        }),
        Err(panic) => Err(Error::malformed(format!("the compressed points are damaged ({panic})"))),
    }
}
