//! Point records of LAZ files: chunks are decompressed in parallel, a few at a time.
//!
//! The decompressors of the `laz` crate are used chunk by chunk, because all that they take from the file
//! unchecked (chunk table, chunk lengths, lengths of layers) decides how much they allocate. Here those are
//! checked first, and chunks too long for memory are decompressed as they are read.

use std::io::{BufReader, Cursor, Read, Seek};

use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LazItemType, LazVlr};
use rayon::prelude::*;

use super::las_header::{LasHeader, Laszip};
use super::laz_chunks::{Chunk, Chunks, PointsPerChunk};
use super::origin::FileView;
use super::panic_guard::guarded;
use super::records::RecordReader;
use crate::error::{Error, Result};

/// Bytes of records that one group of chunks decompresses to, per thread, and in all.
const GROUP_LEN_PER_THREAD: usize = 4 << 20;
const GROUP_LEN_MAX: usize = 64 << 20;

/// Bytes of records from which a chunk is decompressed as it is read.
const CHUNK_LEN_MAX: u64 = 32 << 20;

/// Bytes of records that are taken at once from a chunk that is decompressed as it is read.
const STREAMED_LEN: usize = 1 << 20;

/// Most items that the laszip record may split a point record into; the formats need four.
const ITEMS_MAX: usize = 16;

type Decompressor<R> = Box<dyn RecordDecompressor<R> + Send + Sync>;

/// How the records of a file are compressed, checked.
#[derive(Debug, Clone)]
struct Codec {
    vlr: LazVlr,
    record_len: usize,
    /// Layers of a chunk, each with its length in the chunk's head; 0 where records are compressed as a whole.
    layers: usize,
}

impl Codec {
    fn new(vlr: LazVlr, header: &LasHeader) -> Result<Codec> {
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
        let codec = Codec { vlr, record_len: header.record_len, layers };
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

    fn decompressor<'a, R: Read + Seek + Send + Sync + 'a>(
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

    /// Makes a decompressor ready for the start of a chunk. Layers without coordinates, class and return
    /// numbers (which come with x and y) are left out: they are most of the work.
    fn prepare<R>(&self, decompressor: &mut dyn RecordDecompressor<R>) -> Result<()> {
        decompressor
            .set_fields_from(self.vlr.items())
            .map_err(|e| Error::malformed(format!("laszip record: {e}")))?;
        decompressor.set_selection(
            DecompressionSelection::xy_returns_channel().decompress_z().decompress_classification(),
        );
        Ok(())
    }

    /// Checks the lengths of the layers of a chunk against `room`, the bytes it has, given its `head`: the
    /// first record, the number of records, and the lengths. Returns the number of records.
    fn check_layers(&self, head: &[u8], room: u64) -> Result<u64> {
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

    /// Length of what precedes the layers of a chunk.
    fn head_len(&self) -> usize {
        self.record_len + 4 + 4 * self.layers
    }

    /// Decompresses a whole chunk.
    fn decompress(&self, compressed: &[u8], records: &mut [u8]) -> Result<()> {
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
        let mut decompressor = self.decompressor(Cursor::new(compressed))?;
        decompression(guarded(|| decompressor.decompress_many(records)))
    }
}

fn decompression(outcome: std::result::Result<std::io::Result<()>, String>) -> Result<()> {
    match outcome {
        Ok(Ok(())) => Ok(()),
        Ok(Err(e)) => Err(match e.kind() {
            std::io::ErrorKind::UnexpectedEof => Error::malformed("the compressed points end too early"),
            _ => Error::io("decompressing points", e),
        }),
        Err(panic) => Err(Error::malformed(format!("the compressed points are damaged ({panic})"))),
    }
}

/// Records of a compressed file.
pub(super) struct LazRecords {
    file: FileView,
    codec: Codec,
    chunks: std::iter::Peekable<std::vec::IntoIter<Chunk>>,
    compressed: Vec<u8>,
    streamed: Option<Streamed>,
    /// Records given out so far.
    done: u64,
}

impl LazRecords {
    pub(super) fn new(file: FileView, header: &LasHeader, laszip: &Laszip) -> Result<LazRecords> {
        let codec = Codec::new(laszip.vlr.clone(), header)?;
        let mut records = LazRecords {
            chunks: Vec::new().into_iter().peekable(),
            codec,
            compressed: Vec::new(),
            streamed: None,
            done: 0,
            file,
        };
        match Chunks::find(&records.file, header, laszip)? {
            Chunks::Table(chunks) => records.chunks = chunks.into_iter().peekable(),
            Chunks::Unknown { start, points_per_chunk } => {
                let chunk = Chunk { start, len: records.file.len() - start, points: header.points };
                records.streamed =
                    Some(Streamed::new(&records.file, &records.codec, &chunk, Some(points_per_chunk))?);
            }
        }
        Ok(records)
    }

    /// Takes chunks from the table until they fill a group, or one that must be decompressed as it is read.
    fn next_group(&mut self) -> Result<Vec<Chunk>> {
        let group_max = (GROUP_LEN_PER_THREAD * rayon::current_num_threads()).min(GROUP_LEN_MAX) as u64;
        let record_len = self.codec.record_len as u64;
        let mut group = Vec::new();
        let mut len = 0u64;
        while let Some(chunk) = self.chunks.peek() {
            // Compressed data may be a little longer than the records, never by much.
            let records_len = chunk.points.checked_mul(record_len).ok_or_else(|| {
                Error::malformed(format!("more points of {record_len} bytes than any file can hold"))
                    .at(chunk.describe(self.done))
            })?;
            let is_long = records_len > CHUNK_LEN_MAX || chunk.len > 2 * CHUNK_LEN_MAX;
            if is_long && group.is_empty() {
                self.streamed = Some(Streamed::new(&self.file, &self.codec, chunk, None)?);
                self.chunks.next();
                break;
            }
            len = len.saturating_add(records_len.max(chunk.len));
            if is_long || (len > group_max && !group.is_empty()) {
                break;
            }
            group.extend(self.chunks.next());
        }
        Ok(group)
    }

    fn decompress_group(&mut self, group: &[Chunk], records: &mut Vec<u8>) -> Result<()> {
        let (codec, record_len) = (&self.codec, self.codec.record_len);
        let total = |len: fn(&Chunk) -> u64| group.iter().map(len).sum::<u64>() as usize;
        self.compressed.resize(total(|chunk| chunk.len), 0);
        records.resize(total(|chunk| chunk.points) * record_len, 0);
        let (mut input, mut output) = (&mut self.compressed[..], &mut records[..]);
        let mut jobs = Vec::with_capacity(group.len());
        let mut first = self.done;
        for chunk in group {
            let (compressed, rest) = input.split_at_mut(chunk.len as usize);
            input = rest;
            let (decompressed, rest) = output.split_at_mut(chunk.points as usize * record_len);
            output = rest;
            let position = chunk.describe(first);
            first += chunk.points;
            self.file
                .read_at(chunk.start, compressed)
                .map_err(|e| Error::io("reading compressed points", e).at(position.clone()))?;
            jobs.push((position, &*compressed, decompressed));
        }
        self.done = first;
        jobs.into_par_iter().try_for_each(|(position, compressed, decompressed)| {
            codec.decompress(compressed, decompressed).map_err(|e| e.at(position))
        })
    }
}

impl RecordReader for LazRecords {
    fn next_records(&mut self, records: &mut Vec<u8>) -> Result<()> {
        records.clear();
        loop {
            if let Some(streamed) = &mut self.streamed {
                let count = streamed.next_records(&self.file, &self.codec, records);
                self.done += count.map_err(|e| e.at(format!("after record {}", self.done)))?;
                if !records.is_empty() {
                    return Ok(());
                }
                self.streamed = None;
            }
            let group = self.next_group()?;
            if !group.is_empty() {
                return self.decompress_group(&group, records);
            }
            if self.streamed.is_none() {
                return Ok(());
            }
        }
    }
}

/// Records that are decompressed as they are read: from one chunk, or from chunks that follow each other
/// without a table.
struct Streamed {
    decompressor: Decompressor<BufReader<FileView>>,
    /// Records left to give out, and those left in the current chunk.
    left: u64,
    left_in_chunk: u64,
    points_per_chunk: PointsPerChunk,
}

impl Streamed {
    fn new(file: &FileView, codec: &Codec, chunk: &Chunk, per_chunk: Option<PointsPerChunk>) -> Result<Self> {
        let input = BufReader::new(file.range(chunk.start, chunk.start + chunk.len));
        Ok(Streamed {
            decompressor: codec.decompressor(input)?,
            left: chunk.points,
            left_in_chunk: 0,
            points_per_chunk: per_chunk.unwrap_or(PointsPerChunk::Fixed(chunk.points)),
        })
    }

    /// Replaces `records` with the next ones and returns their number.
    fn next_records(&mut self, file: &FileView, codec: &Codec, records: &mut Vec<u8>) -> Result<u64> {
        records.clear();
        if self.left == 0 {
            return Ok(0);
        }
        if self.left_in_chunk == 0 {
            self.start_chunk(file, codec)?;
        }
        let count = self.left_in_chunk.min((STREAMED_LEN / codec.record_len).max(1) as u64);
        records.resize(count as usize * codec.record_len, 0);
        let decompressor = &mut self.decompressor;
        decompression(guarded(|| decompressor.decompress_many(records)))?;
        self.left -= count;
        self.left_in_chunk -= count;
        Ok(count)
    }

    fn start_chunk(&mut self, file: &FileView, codec: &Codec) -> Result<()> {
        let mut points = self.left;
        if codec.layers > 0 {
            let at = self.decompressor.get_mut().stream_position().map_err(|e| Error::io("reading", e))?;
            let mut head = vec![0; codec.head_len()];
            file.read_at(at, &mut head).map_err(|e| Error::io("reading the head of a chunk", e))?;
            let stated = codec.check_layers(&head, file.len() - at)?;
            points = points.min(stated);
            if stated == 0 {
                return Err(Error::malformed(format!("chunk without points at byte {at}")));
            }
        }
        if let PointsPerChunk::Fixed(fixed) = self.points_per_chunk {
            points = self.left.min(fixed);
        }
        self.left_in_chunk = points;
        self.decompressor.reset();
        codec.prepare(&mut *self.decompressor)
    }
}
