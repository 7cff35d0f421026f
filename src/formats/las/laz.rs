//! Point records of LAZ files: chunks are decompressed on several threads, a few ahead of the reader.
//! Chunks too long for memory are decompressed as they are read.

use std::io::{BufReader, Seek};

use laz::DecompressionSelection;

use crate::las::header::{LasHeader, Laszip};
use crate::las::index;
use crate::las::laz_chunks::{Chunk, Chunks, PointsPerChunk};
use crate::las::laz_codec::{Codec, Decompressor, decompression};
use crate::source::origin::FileView;
use crate::source::panic_guard::guarded;
use crate::source::record_reader::RecordReader;
use spmesh_base::error::{Error, Result};
use spmesh_base::parallel::OrderedPool;
use spmesh_stream::model::bounds::Bounds;

/// Greatest number of record bytes that the chunks under way decompress to, per thread and in total.
const AHEAD_LEN_PER_THREAD: u64 = 2 << 20;
const AHEAD_LEN_MAX: u64 = 32 << 20;

/// Record bytes from which chunks make up a job: several small chunks form one job.
const JOB_LEN: u64 = 1 << 20;

/// Record bytes above which a chunk is decompressed as it is read.
const CHUNK_LEN_MAX: u64 = 32 << 20;

/// Record bytes returned at a time from a chunk that is decompressed as it is read.
const STREAMED_LEN: usize = 1 << 20;

/// Chunks to be decompressed one after the other, and buffers for them.
#[derive(Default)]
struct Job {
    /// Of consecutive records.
    chunks: Vec<Chunk>,
    compressed: Vec<u8>,
    records: Vec<u8>,
}

impl Job {
    /// Approximate bytes that the job needs. Compressed data may be slightly longer than its records.
    fn len(&self, record_len: u64) -> u64 {
        self.chunks.iter().map(|chunk| (chunk.points * record_len).max(chunk.len)).sum()
    }

    fn run(&mut self, file: &FileView, codec: &Codec) -> Result<()> {
        let points: u64 = self.chunks.iter().map(|chunk| chunk.points).sum();
        self.records.resize(points as usize * codec.record_len, 0);
        let mut rest = &mut self.records[..];
        for chunk in &self.chunks {
            let (records, later) = rest.split_at_mut(chunk.points as usize * codec.record_len);
            rest = later;
            self.compressed.resize(chunk.len as usize, 0);
            let read = file.read_at(chunk.start, &mut self.compressed);
            read.map_err(|e| Error::io("reading compressed points", e).at(chunk.describe()))?;
            codec.decompress(&self.compressed, records).map_err(|e| e.at(chunk.describe()))?;
            index::check_records(records, codec.record_len, chunk.first, chunk.within.as_ref())?;
        }
        Ok(())
    }

    fn first(&self) -> u64 {
        self.chunks.first().map_or(0, |chunk| chunk.first)
    }

    /// Whether the records of `chunk` follow those of the job.
    fn continues_with(&self, chunk: &Chunk) -> bool {
        self.chunks.last().is_none_or(|last| last.after() == chunk.first)
    }
}

/// Records of a compressed file.
pub(crate) struct LazRecords {
    file: FileView,
    codec: Codec,
    threads: usize,
    chunks: std::iter::Peekable<std::vec::IntoIter<Chunk>>,
    decoders: Option<OrderedPool<Job, Result<Job>>>,
    /// Finished jobs, whose buffers are reused.
    spare: Vec<Job>,
    streamed: Option<Streamed>,
    /// Number of the first of the last records, and the one after them.
    first: u64,
    after: u64,
}

impl LazRecords {
    /// The records of the parts of `header`, of which the fields of `selection` are decompressed.
    pub(crate) fn new(
        file: FileView,
        header: &LasHeader,
        laszip: &Laszip,
        threads: usize,
        selection: DecompressionSelection,
    ) -> Result<LazRecords> {
        let codec = Codec::new(laszip.vlr.clone(), header, selection)?;
        let (chunks, streamed) = match Chunks::find(&file, header, laszip)? {
            Chunks::Table(chunks) => (index::chunks_of_parts(chunks, header.parts.as_deref()), None),
            Chunks::Unknown { start, points_per_chunk } => {
                let len = header.points_end.saturating_sub(start);
                let chunk = Chunk { start, len, points: header.points, first: 0, within: None };
                let per_chunk = laszip.is_chunked.then_some(points_per_chunk);
                (Vec::new(), Some(Streamed::new(&file, &codec, &chunk, per_chunk)?))
            }
        };
        let chunks = chunks.into_iter().peekable();
        let (decoders, spare) = (None, Vec::new());
        Ok(LazRecords { file, codec, threads, chunks, decoders, spare, streamed, first: 0, after: 0 })
    }

    /// Whether the next chunk must be decompressed as it is read; `None` at the end.
    fn next_is_long(&mut self) -> Result<Option<bool>> {
        let record_len = self.codec.record_len as u64;
        let Some(chunk) = self.chunks.peek() else { return Ok(None) };
        let records_len = chunk.points.checked_mul(record_len).ok_or_else(|| {
            Error::malformed(format!("more points of {record_len} bytes than any file can hold"))
                .at(chunk.describe())
        })?;
        Ok(Some(records_len > CHUNK_LEN_MAX || chunk.len > 2 * CHUNK_LEN_MAX))
    }

    /// Takes chunks from the table until they make up a job; `None` if the next chunk is too long for a job,
    /// none is left, or records between are left out.
    fn next_job(&mut self) -> Result<Option<Job>> {
        let record_len = self.codec.record_len as u64;
        let mut job = self.spare.pop().unwrap_or_default();
        job.chunks.clear();
        while job.len(record_len) < JOB_LEN && self.next_is_long()? == Some(false) {
            let Some(chunk) = self.chunks.next_if(|chunk| job.continues_with(chunk)) else { break };
            job.chunks.push(chunk);
        }
        Ok((!job.chunks.is_empty()).then_some(job))
    }

    /// Passes jobs to the decoders until their pool is full.
    fn decode_ahead(&mut self) -> Result<()> {
        while !self.decoders.as_ref().is_some_and(OrderedPool::is_full) {
            let Some(job) = self.next_job()? else { break };
            let len = job.len(self.codec.record_len as u64);
            let decoders = match &mut self.decoders {
                Some(decoders) => decoders,
                None => {
                    let (file, codec) = (self.file.clone(), self.codec.clone());
                    let decode = move |mut job: Job| job.run(&file, &codec).map(|()| job);
                    let ahead_max = (AHEAD_LEN_PER_THREAD * self.threads as u64).min(AHEAD_LEN_MAX);
                    let pool = OrderedPool::start("decoder", self.threads, ahead_max, decode)?;
                    self.decoders.insert(pool)
                }
            };
            decoders.give(job, len);
        }
        Ok(())
    }
}

impl RecordReader for LazRecords {
    fn next_records(&mut self, records: &mut Vec<u8>) -> Result<()> {
        records.clear();
        loop {
            if let Some(streamed) = &mut self.streamed {
                let count = streamed.next_records(&self.file, &self.codec, records);
                let count = count.map_err(|e| e.at(format!("after record {}", self.after)))?;
                (self.first, self.after) = (self.after, self.after + count);
                index::check_records(records, self.codec.record_len, self.first, streamed.within.as_ref())?;
                if !records.is_empty() {
                    return Ok(());
                }
                self.streamed = None;
            }
            self.decode_ahead()?;
            if let Some(decoded) = self.decoders.as_mut().and_then(OrderedPool::take) {
                let mut job = decoded?;
                std::mem::swap(records, &mut job.records);
                self.first = job.first();
                self.spare.push(job);
                return Ok(());
            }
            if self.next_is_long()?.is_none() {
                return Ok(());
            }
            let chunk = self.chunks.next().expect("it is long");
            self.after = chunk.first;
            self.streamed = Some(Streamed::new(&self.file, &self.codec, &chunk, None)?);
        }
    }

    fn first(&self) -> u64 {
        self.first
    }
}

/// Records that are decompressed as they are read: from one chunk, or from consecutive chunks without a
/// table.
pub(crate) struct Streamed {
    decompressor: Decompressor<BufReader<FileView>>,
    /// Records left to return, and records left in the current chunk.
    left: u64,
    left_in_chunk: u64,
    points_per_chunk: PointsPerChunk,
    /// Byte at which the records must end; `None` without a table, as other data may follow.
    end: Option<u64>,
    /// A box that an index promises for the records.
    within: Option<Bounds>,
}

impl Streamed {
    /// Without `per_chunk`, the records are one chunk.
    pub(crate) fn new(
        file: &FileView,
        codec: &Codec,
        chunk: &Chunk,
        per_chunk: Option<PointsPerChunk>,
    ) -> Result<Self> {
        let input = BufReader::new(file.range(chunk.start, chunk.start + chunk.len));
        Ok(Streamed {
            decompressor: codec.decompressor(input)?,
            left: chunk.points,
            left_in_chunk: 0,
            points_per_chunk: per_chunk.unwrap_or(PointsPerChunk::Fixed(chunk.points)),
            end: per_chunk.is_none().then_some(chunk.start + chunk.len),
            within: chunk.within,
        })
    }

    /// Whether a chunk ends with the last records returned.
    pub(crate) fn is_between_chunks(&self) -> bool {
        self.left_in_chunk == 0
    }

    /// Replaces `records` with the next ones and returns their number.
    pub(crate) fn next_records(
        &mut self,
        file: &FileView,
        codec: &Codec,
        records: &mut Vec<u8>,
    ) -> Result<u64> {
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
        if let Some(end) = self.end.filter(|_| self.left == 0) {
            codec.check_end(end.saturating_sub(self.position()?))?;
        }
        Ok(count)
    }

    /// Byte of the file up to which the decompressor has read.
    fn position(&mut self) -> Result<u64> {
        self.decompressor.get_mut().stream_position().map_err(|e| Error::io("reading", e))
    }

    fn start_chunk(&mut self, file: &FileView, codec: &Codec) -> Result<()> {
        let mut points = self.left;
        if codec.layers > 0 {
            let at = self.position()?;
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
