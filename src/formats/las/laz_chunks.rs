//! Where the chunks of a LAZ file are: its chunk table, checked against the file.

use std::io::{BufReader, ErrorKind, Seek, SeekFrom};

use laz::laszip::ChunkTable;

use crate::las::header::{LasHeader, Laszip};
use crate::las::laz_table::{TABLE_POSITION_LEN, table_position};
use crate::source::origin::FileView;
use crate::source::panic_guard::guarded;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Bounds;

/// Records that are compressed together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chunk {
    /// First byte in the file.
    pub(crate) start: u64,
    /// Length in bytes.
    pub(crate) len: u64,
    /// Number of records.
    pub(crate) points: u64,
    /// Number of the first record in the file.
    pub(crate) first: u64,
    /// A box that an index promises for the records, in stored coordinates.
    pub(crate) within: Option<Bounds>,
}

impl Chunk {
    /// Number of the first record after the chunk.
    pub(crate) fn after(&self) -> u64 {
        self.first.saturating_add(self.points)
    }

    /// Where the chunk is, for messages.
    pub(crate) fn describe(&self) -> String {
        let last = self.after().saturating_sub(1);
        format!("records {} to {last} at byte {}", self.first, self.start)
    }
}

/// Number of records in the chunks of a file without a chunk table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointsPerChunk {
    /// The same number in each chunk but the last.
    Fixed(u64),
    /// Stated in the head of each layered chunk.
    Stated,
}

/// What is known of the chunks of a file.
#[derive(Debug)]
pub(crate) enum Chunks {
    /// All of them, in the order of the file; chunks without points are left out.
    Table(Vec<Chunk>),
    /// The chunks start at `start` and follow each other without a gap.
    Unknown { start: u64, points_per_chunk: PointsPerChunk },
}

impl Chunks {
    /// Reads the chunk table.
    ///
    /// # Errors
    /// If it contradicts the header or the length of the file, or is missing where nothing can be read
    /// without it. A table is missing where the file was cut off or its writer did not finish; the chunks
    /// present can still be read.
    pub(crate) fn find(file: &FileView, header: &LasHeader, laszip: &Laszip) -> Result<Chunks> {
        if header.points == 0 {
            return Ok(Chunks::Table(Vec::new()));
        }
        if !laszip.is_chunked {
            let points_per_chunk = PointsPerChunk::Fixed(header.points);
            return Ok(Chunks::Unknown { start: header.points_start, points_per_chunk });
        }
        let start = header.points_start + TABLE_POSITION_LEN;
        let table = table_position(file, header.points_start)?;
        let found = table.map(|table| {
            read_table(file, header, laszip, table).map_err(|e| e.at(format!("chunk table at byte {table}")))
        });
        // A table that was cut off tells nothing.
        let Some(chunks) = found.filter(|found| found.is_ok() || !header.is_salvaged) else {
            let points_per_chunk = match laszip.vlr.uses_variable_size_chunks() {
                false => PointsPerChunk::Fixed(u64::from(laszip.vlr.chunk_size())),
                true if header.format >= 6 => PointsPerChunk::Stated,
                true => {
                    return Err(Error::malformed(
                        "the chunk table is missing and the chunks differ in length: the file is truncated, \
                         or its writer did not finish; write it again from its source",
                    ));
                }
            };
            return Ok(Chunks::Unknown { start, points_per_chunk });
        };
        chunks.map(Chunks::Table)
    }
}

fn read_table(file: &FileView, header: &LasHeader, laszip: &Laszip, table: u64) -> Result<Vec<Chunk>> {
    let start = header.points_start + TABLE_POSITION_LEN;
    let mut head = [0; 8];
    file.read_at(table, &mut head).map_err(|e| Error::io("reading", e))?;
    let count = u64::from(u32::from_le_bytes(head[4..8].try_into().expect("four bytes")));
    // Each chunk starts with an uncompressed record. Without this limit the library would allocate for any
    // count.
    let most = (table - start) / header.record_len as u64 + 1;
    let fixed = (!laszip.vlr.uses_variable_size_chunks()).then(|| u64::from(laszip.vlr.chunk_size()));
    let needed = fixed.map(|points| header.points.div_ceil(points));
    if count > most || needed.is_some_and(|needed| needed != count) {
        return Err(Error::malformed(format!(
            "{count} chunks for {} points in {} bytes",
            header.points,
            table - start
        )));
    }
    let mut input = BufReader::new(file.range(0, file.len()));
    input.seek(SeekFrom::Start(table)).map_err(|e| Error::io("reading", e))?;
    let entries = guarded(|| ChunkTable::read(&mut &mut input, fixed.is_none()))
        .map_err(|panic| Error::malformed(format!("damaged ({panic})")))?
        .map_err(|e| match e.kind() {
            ErrorKind::UnexpectedEof => header.cut(Error::malformed("truncated: the file ends inside")),
            _ => Error::io("reading", e),
        })?;
    let mut chunks = Vec::with_capacity(count as usize);
    let (mut at, mut left) = (start, header.points);
    for (index, entry) in entries.as_ref().iter().enumerate() {
        let points = fixed.map_or(entry.point_count, |fixed| fixed.min(left));
        if points > left || entry.byte_count > table - at {
            return Err(Error::malformed(format!(
                "chunk {index} has {points} points and {} bytes, {left} points and {} bytes are left",
                entry.byte_count,
                table - at
            )));
        }
        if points > 0 {
            let first = header.points - left;
            chunks.push(Chunk { start: at, len: entry.byte_count, points, first, within: None });
        }
        at += entry.byte_count;
        left -= points;
    }
    if left > 0 {
        return Err(Error::malformed(format!(
            "the header states {} points, the chunks have {}",
            header.points,
            header.points - left
        )));
    }
    Ok(chunks)
}
