//! Compresses point records to the chunks of a LAZ file, on several threads.

use std::io::{Cursor, Write};

use laz::laszip::{ChunkTable, ChunkTableEntry};
use laz::record::{LayeredPointRecordCompressor, RecordCompressor, SequentialPointRecordCompressor};
use laz::{LazItem, LazItemRecordBuilder, LazVlr, LazVlrBuilder};

use crate::las::file::LasFile;
use spmesh_base::error::{Error, Result};
use spmesh_base::parallel::OrderedPool;

/// Records in a chunk, as other writers have them.
const CHUNK_POINTS: u32 = 50_000;

/// Formats from this one on are compressed in layers.
const LAYERED_FORMAT: u8 = 6;

/// How records of `format` with `extra_len` extra bytes are compressed, in chunks as long as those of `file`.
pub(crate) fn laszip(file: &LasFile, extra_len: usize) -> Result<LazVlr> {
    let format = file.header.format;
    let too_many = || Error::usage(format!("{extra_len} extra bytes are too many for LAZ"));
    let extra_len = u16::try_from(extra_len).map_err(|_| too_many())?;
    let items = LazItemRecordBuilder::default_for_point_format_id(format, extra_len)
        .map_err(|e| Error::usage(format!("{e}: LAZ cannot hold points of format {format}, write LAS")))?;
    let stated = file.header.laz.as_ref().filter(|laz| !laz.vlr.uses_variable_size_chunks());
    let points =
        stated.map(|laz| laz.vlr.chunk_size()).filter(|points| (1..=4 * CHUNK_POINTS).contains(points));
    Ok(LazVlrBuilder::new(items).with_fixed_chunk_size(points.unwrap_or(CHUNK_POINTS)).build())
}

/// Takes records, and writes compressed chunks.
///
/// Memory: the records under way, at most `ahead_max` bytes of them and one more chunk.
pub(crate) struct ChunkWriter {
    vlr: LazVlr,
    chunk_len: usize,
    /// The records of the next chunk.
    records: Vec<u8>,
    pool: OrderedPool<Vec<u8>, Result<Compressed>>,
    table: ChunkTable,
    record_len: usize,
    /// A buffer to use again.
    spare: Vec<u8>,
}

struct Compressed {
    bytes: Vec<u8>,
    records: Vec<u8>,
}

impl ChunkWriter {
    /// Starts `threads` threads.
    pub(crate) fn start(
        vlr: &LazVlr,
        is_layered: bool,
        threads: usize,
        ahead_max: u64,
    ) -> Result<ChunkWriter> {
        let items = vlr.items().clone();
        let record_len = vlr.items_size() as usize;
        let work = move |records: Vec<u8>| compress(&items, is_layered, records);
        let chunk_len = vlr.chunk_size() as usize * record_len;
        Ok(ChunkWriter {
            vlr: vlr.clone(),
            chunk_len,
            records: Vec::new(),
            pool: OrderedPool::start("encoder", threads, ahead_max, work)?,
            table: ChunkTable::default(),
            record_len,
            spare: Vec::new(),
        })
    }

    /// Whether points of a format are compressed in layers.
    pub(crate) fn is_layered(format: u8) -> bool {
        format >= LAYERED_FORMAT
    }

    /// Takes whole records.
    pub(crate) fn take(&mut self, mut records: &[u8], output: &mut impl Write) -> Result<()> {
        while !records.is_empty() {
            let room = self.chunk_len - self.records.len();
            let (now, later) = records.split_at(room.min(records.len()));
            self.records.extend_from_slice(now);
            records = later;
            if self.records.len() == self.chunk_len {
                self.give(output)?;
            }
        }
        Ok(())
    }

    /// Writes the last chunks, and returns the table of all.
    pub(crate) fn finish(mut self, output: &mut impl Write) -> Result<Vec<u8>> {
        if !self.records.is_empty() {
            self.give(output)?;
        }
        while self.write_one(output)? {}
        let mut table = Vec::new();
        self.table.write_to(&mut table, &self.vlr).map_err(|e| Error::io("compressing points", e))?;
        Ok(table)
    }

    /// Gives the chunk to the threads, after writing others while too many are under way.
    fn give(&mut self, output: &mut impl Write) -> Result<()> {
        while self.pool.is_full() {
            self.write_one(output)?;
        }
        let next = std::mem::take(&mut self.spare);
        let records = std::mem::replace(&mut self.records, next);
        let weight = records.len() as u64;
        self.pool.give(records, weight);
        Ok(())
    }

    /// Writes the oldest chunk under way; returns false if there is none.
    fn write_one(&mut self, output: &mut impl Write) -> Result<bool> {
        let Some(compressed) = self.pool.take() else { return Ok(false) };
        let Compressed { bytes, mut records } = compressed?;
        output.write_all(&bytes).map_err(|e| Error::io("writing", e))?;
        let point_count = (records.len() / self.record_len) as u64;
        self.table.push(ChunkTableEntry { point_count, byte_count: bytes.len() as u64 });
        records.clear();
        self.spare = records;
        Ok(true)
    }
}

fn compress(items: &Vec<LazItem>, is_layered: bool, records: Vec<u8>) -> Result<Compressed> {
    let output = Cursor::new(Vec::with_capacity(records.len() / 4));
    let mut compressor: Box<dyn RecordCompressor<Cursor<Vec<u8>>>> = if is_layered {
        Box::new(LayeredPointRecordCompressor::new(output))
    } else {
        Box::new(SequentialPointRecordCompressor::new(output))
    };
    compressor.set_fields_from(items).map_err(|e| Error::usage(format!("compressing points: {e}")))?;
    let mut work = || {
        compressor.compress_many(&records)?;
        compressor.done()
    };
    work().map_err(|e| Error::io("compressing points", e))?;
    Ok(Compressed { bytes: compressor.box_into_inner().into_inner(), records })
}
