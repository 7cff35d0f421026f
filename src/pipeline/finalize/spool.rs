//! Decoded points of the first pass, kept in a temporary file for later passes.
//!
//! Decompressing and parsing cost more than writing 12 bytes per point and reading them back. The file has no
//! name, and consists of blocks: the length of the payload, its CRC-32C, and the points of a batch as
//! records.

use std::path::{Path, PathBuf};

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::system;
use spmesh_base::temporary::{FrozenFile, TemporaryFile, Windows};
use spmesh_formats::source::{Description, PointReader};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Header, Kind, decode_points, encode_points};

const BLOCK_HEADER_LEN: usize = 8;

/// The operation, for messages.
const READING: &str = "reading points back";

/// Bytes after which an automatic spool checks the free space again.
const SPACE_CHECK_LEN: u64 = 16 << 20;

/// When decoded points are kept for later passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spooling {
    /// If decoding again would cost more, and the file takes no more than a quarter of the free space on a
    /// disk. If the file cannot be written, the input is decoded again.
    #[default]
    Auto,
    /// Always; it is an error if the file cannot be written.
    Always,
    /// Never.
    Never,
}

/// How points are encoded.
fn header_of(description: &Description) -> Header {
    let Description { coordinates, dims, has_elevation, ref attributes, .. } = *description;
    let header = Header::new(Kind::Points, coordinates, dims, has_elevation);
    Header { attributes: attributes.clone(), ..header }
}

/// Points in a temporary file, in input order.
pub(super) struct Spool {
    file: FrozenFile,
    header: Header,
    bytes: u64,
    points: u64,
    invalid: u64,
}

impl Spool {
    /// Number of points.
    pub(super) fn points(&self) -> u64 {
        self.points
    }

    /// Length in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Starts a pass over the points.
    pub(super) fn read(&self) -> SpoolReader<'_> {
        SpoolReader { spool: self, windows: self.file.windows(), at: 0, rows: Vec::new() }
    }
}

/// A spool while it is written.
struct SpoolWriter {
    file: TemporaryFile,
    header: Header,
    bytes: u64,
    points: u64,
}

impl SpoolWriter {
    fn create(folder: &Path, description: &Description) -> Result<SpoolWriter> {
        let file = TemporaryFile::create(Some(folder))?;
        Ok(SpoolWriter { file, header: header_of(description), bytes: 0, points: 0 })
    }

    /// Ends the spool of an input with so many points that are not finite.
    fn finish(self, invalid: u64) -> Result<Spool> {
        let SpoolWriter { file, header, bytes, points } = self;
        Ok(Spool { file: file.freeze()?, header, bytes, points, invalid })
    }

    /// Appends points, then their rows.
    fn append(&mut self, points: &[Point], rows: &[u8], block: &mut Vec<u8>) -> Result<()> {
        block.clear();
        block.resize(BLOCK_HEADER_LEN, 0);
        encode_points(&self.header, points, block)?;
        block.extend_from_slice(rows);
        let payload = &block[BLOCK_HEADER_LEN..];
        let (len, checksum) = (payload.len() as u32, crc32c::crc32c(payload));
        block[..4].copy_from_slice(&len.to_le_bytes());
        block[4..BLOCK_HEADER_LEN].copy_from_slice(&checksum.to_le_bytes());
        self.file.write_at("keeping decoded points", block, self.bytes)?;
        self.bytes += block.len() as u64;
        self.points += points.len() as u64;
        Ok(())
    }
}

/// One pass over a spool.
pub(super) struct SpoolReader<'a> {
    spool: &'a Spool,
    windows: Windows<'a>,
    at: u64,
    rows: Vec<u8>,
}

impl SpoolReader<'_> {
    fn read_block(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        let head = self.windows.bytes(READING, self.at, BLOCK_HEADER_LEN)?;
        self.at += BLOCK_HEADER_LEN as u64;
        let (len, checksum) = head.split_at(4);
        let number = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
        let (len, checksum) = (number(len), number(checksum));
        if u64::from(len) > self.spool.bytes - self.at {
            return Err(damaged());
        }
        let payload = self.windows.bytes(READING, self.at, len as usize)?;
        self.at += u64::from(len);
        if crc32c::crc32c(payload) != checksum {
            return Err(damaged());
        }
        let header = &self.spool.header;
        let points = payload.len() / header.record_len();
        let (points, rows) = payload.split_at(points * header.point_len());
        decode_points(header, points, batch);
        self.rows.extend_from_slice(rows);
        Ok(())
    }
}

fn damaged() -> Error {
    Error::new(
        ErrorKind::Io,
        "reading points back: the checksum does not match, the file was changed or damaged",
    )
}

impl PointReader for SpoolReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        self.rows.clear();
        if self.at == self.spool.bytes {
            return Ok(());
        }
        self.read_block(batch).map_err(|e| e.of_input(self.spool.file.name()))
    }

    fn rows(&self) -> &[u8] {
        &self.rows
    }

    fn invalid(&self) -> u64 {
        self.spool.invalid
    }
}

/// Whether and where a run keeps its points.
#[derive(Debug, Clone)]
pub(super) struct SpoolPlan {
    folder: PathBuf,
    is_strict: bool,
}

impl SpoolPlan {
    /// `None` if points are not kept. `is_costly` tells whether decoding them again is costly.
    pub(super) fn new(
        rule: Spooling,
        is_costly: bool,
        folder: Option<&Path>,
        description: &Description,
    ) -> Option<SpoolPlan> {
        let is_named = folder.is_some();
        let folder = folder.map_or_else(std::env::temp_dir, Path::to_path_buf);
        let record_len = header_of(description).record_len() as u64;
        let bytes = description.stated_points.unwrap_or(0).saturating_mul(record_len);
        let is_kept = match rule {
            Spooling::Always => true,
            Spooling::Never => false,
            // A spool in memory saves nothing: such a folder is used only if the user names it.
            Spooling::Auto => {
                is_costly && has_space(&folder, bytes) && (is_named || !system::is_in_memory(&folder))
            }
        };
        is_kept.then_some(SpoolPlan { folder, is_strict: rule == Spooling::Always })
    }
}

/// Free space that an automatic spool needs, in multiples of its size: for the spool itself, for points that
/// wait for their cell, and for the output, which may all be on one disk.
const FREE_FACTOR: u64 = 4;

/// Whether `folder` has space for a spool of `bytes`. If the system does not tell, assume so: writing will
/// fail if not.
fn has_space(folder: &Path, bytes: u64) -> bool {
    system::free_bytes(folder).is_none_or(|free| bytes <= free / FREE_FACTOR)
}

/// A reader that keeps its points in a spool.
pub(super) struct Tee<'a> {
    reader: Box<dyn PointReader + 'a>,
    plan: SpoolPlan,
    /// The file, or why there is none.
    spool: Result<SpoolWriter>,
    block: Vec<u8>,
    next_space_check: u64,
}

impl<'a> Tee<'a> {
    /// A reader that keeps the points of `reader`.
    pub(super) fn new(
        reader: Box<dyn PointReader + 'a>,
        plan: SpoolPlan,
        description: &Description,
    ) -> Result<Self> {
        let spool = SpoolWriter::create(&plan.folder, description);
        match spool {
            Err(error) if plan.is_strict => Err(error),
            spool => Ok(Tee { reader, plan, spool, block: Vec::new(), next_space_check: SPACE_CHECK_LEN }),
        }
    }

    /// The spool of a whole pass, or the reason why there is none.
    pub(super) fn finish(self) -> Result<Spool> {
        let invalid = self.reader.invalid();
        self.spool?.finish(invalid)
    }

    fn keep(&mut self, batch: &[Point]) -> Result<()> {
        let Ok(spool) = &mut self.spool else { return Ok(()) };
        if !self.plan.is_strict && spool.bytes >= self.next_space_check {
            self.next_space_check += SPACE_CHECK_LEN;
            if system::free_bytes(&self.plan.folder)
                .is_some_and(|free| free < (FREE_FACTOR - 1) * spool.bytes)
            {
                return Err(Error::new(
                    ErrorKind::Io,
                    "more than a quarter of the free space would be used up",
                )
                .of_input(spool.file.name()));
            }
        }
        spool.append(batch, self.reader.rows(), &mut self.block)
    }
}

impl PointReader for Tee<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        self.reader.next_batch(batch)?;
        if batch.is_empty() {
            return Ok(());
        }
        match self.keep(batch) {
            Err(error) if self.plan.is_strict => return Err(error),
            Err(error) => self.spool = Err(error),
            Ok(()) => {}
        }
        Ok(())
    }

    fn rows(&self) -> &[u8] {
        self.reader.rows()
    }

    fn invalid(&self) -> u64 {
        self.reader.invalid()
    }
}
