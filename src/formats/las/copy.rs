//! Writes a LAS or LAZ file again, with changed records and one more field.

use std::io::{Seek, SeekFrom, Write};

use crate::las::chunks::{ChunkWriter, laszip};
use crate::las::field::{ExtraField, with_field};
use crate::las::file::LasFile;
use crate::las::raw::RawHeader;
use crate::las::records::{RecordList, copy_range};
use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};

/// Places in the header of a file.
const POINTS_START: usize = 96;
const VLR_COUNT: usize = 100;
const FORMAT: usize = 104;
const RECORD_LEN: usize = 105;
const LEGACY_POINTS: usize = 107;
const OFFSET_Z: usize = 171;
const MAX_Z: usize = 211;
const WAVEFORM_START: usize = 227;
const EVLR_START: usize = 235;
const EVLR_COUNT: usize = 243;
const POINTS: usize = 247;

/// The bit of the format that says that points are compressed.
const COMPRESSED: u8 = 0x80;
/// Bits of the format that are no part of its number.
const FORMAT_FLAGS: u8 = 0xc0;

/// What of a file changes beside the values in its records.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    /// A field at the end of each record.
    pub field: Option<ExtraField>,
    /// Whether z counts from zero: its offset becomes zero, and the header states its new range.
    pub has_new_z: bool,
    /// Whether points are compressed.
    pub is_compressed: bool,
}

/// A LAS or LAZ file that is written again. The header, all other records and their order stay as they are,
/// except that a COPC file becomes a LAZ file: its index would be that of another file.
///
/// Memory: 64 KiB, and the chunks that are being compressed.
pub struct LasCopy<W: Write + Seek> {
    output: W,
    file: FileView,
    /// The header of the file, and that of the output.
    raw: RawHeader,
    header: Vec<u8>,
    extended: RecordList,
    /// Bytes after the points that are no records.
    tail: std::ops::Range<u64>,
    record_len: usize,
    has_new_z: bool,
    /// The least and the greatest stored z so far.
    range_z: Option<[i32; 2]>,
    chunks: Option<ChunkWriter>,
    /// First byte of points.
    points_start: u64,
    /// Records to be written, and those written.
    points: u64,
    written: u64,
    notices: Vec<String>,
}

impl<W: Write + Seek> LasCopy<W> {
    /// Writes all that precedes the points. `threads` compress points, of which at most `ahead_max` bytes are
    /// under way.
    ///
    /// # Errors
    /// Usage, if the output is a pipe or not at its start, or records cannot take the field; if reading or
    /// writing fails.
    pub fn start(
        source: &LasFile,
        mut output: W,
        changes: &Changes,
        threads: usize,
        ahead_max: u64,
    ) -> Result<LasCopy<W>> {
        let position = output.stream_position().map_err(|_| {
            Error::usage("LAS and LAZ files cannot be written to a pipe: their header is completed last")
        })?;
        if position != 0 {
            return Err(Error::usage(
                "LAS and LAZ files cannot follow what a file holds already: give --output",
            ));
        }
        let file = source.view()?;
        let raw = source.header.raw;
        let mut header = read_header(&file, raw.header_len)?;
        let (first, points_start) = (u64::from(raw.header_len), source.header.points_start);
        let mut vlrs = RecordList::read(&file, first, points_start, raw.records, false)?;
        let padding = vlrs.end..points_start;
        let list = extended_records(&file, &raw)?;
        // Records that are cut off, or older than their count in the header, are copied as they are.
        let tail = if list.is_some() { 0..0 } else { source.header.points_end..source.header.file_len };
        let mut extended = list.unwrap_or_default();
        let mut extra_len = source.record_len() - source.core_len();
        let mut notices = Vec::new();
        if vlrs.drop_arrangement() | extended.drop_arrangement() {
            notices.push("COPC is written as LAZ, without its index".to_string());
        }
        if let Some(field) = &changes.field {
            let (mut described, place) = vlrs.take_descriptions(&file)?;
            described.extend(extended.take_descriptions(&file)?.0);
            let described = with_field(&described, extra_len, field, &mut notices)?;
            vlrs.put_descriptions(place.unwrap_or(vlrs.records.len()), described)?;
            extra_len += ExtraField::LEN;
        }
        let record_len = source.core_len() + extra_len;
        let mut chunks = None;
        if changes.is_compressed {
            let vlr = laszip(source, extra_len)?;
            let mut body = Vec::new();
            vlr.write_to(&mut body).map_err(|e| Error::io("writing", e))?;
            vlrs.push_laszip(body)?;
            let is_layered = ChunkWriter::is_layered(source.header.format);
            chunks = Some(ChunkWriter::start(&vlr, is_layered, threads, ahead_max)?);
        }
        let new_start = first + vlrs.len() + (padding.end - padding.start);
        let too_long = |_| Error::usage("the records before the points are too long for a LAS file");
        put(&mut header, POINTS_START, &u32::try_from(new_start).map_err(too_long)?.to_le_bytes());
        put(&mut header, VLR_COUNT, &(vlrs.records.len() as u32).to_le_bytes());
        let long =
            |_| Error::usage(format!("point records of {record_len} bytes are too long for a LAS file"));
        put(&mut header, RECORD_LEN, &u16::try_from(record_len).map_err(long)?.to_le_bytes());
        header[FORMAT] = header[FORMAT] & !FORMAT_FLAGS | if changes.is_compressed { COMPRESSED } else { 0 };
        if changes.has_new_z {
            put(&mut header, OFFSET_Z, &0f64.to_le_bytes());
        }
        let mut copy = LasCopy {
            output,
            file,
            raw,
            header,
            tail,
            extended,
            record_len,
            has_new_z: changes.has_new_z,
            range_z: None,
            chunks,
            points_start: new_start,
            points: source.points(),
            written: 0,
            notices,
        };
        copy.put_bytes(|copy| copy.header.clone())?;
        vlrs.write(&copy.file, &mut copy.output)?;
        copy_range(&copy.file, padding, &mut copy.output)?;
        if copy.chunks.is_some() {
            // The position of the chunk table, which is not known yet.
            copy.put_bytes(|_| (-1i64).to_le_bytes().to_vec())?;
        }
        Ok(copy)
    }

    /// What of the file could not be kept.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Bytes of a record that is written.
    pub fn record_len(&self) -> usize {
        self.record_len
    }

    /// Appends whole records.
    ///
    /// # Errors
    /// If compressing or writing fails.
    pub fn write(&mut self, records: &[u8]) -> Result<()> {
        debug_assert!(records.len().is_multiple_of(self.record_len));
        self.written += (records.len() / self.record_len) as u64;
        if self.has_new_z {
            for record in records.chunks_exact(self.record_len) {
                let z = i32::from_le_bytes(*record[8..].first_chunk().expect("records are longer"));
                let [min, max] = self.range_z.unwrap_or([z, z]);
                self.range_z = Some([min.min(z), max.max(z)]);
            }
        }
        match &mut self.chunks {
            Some(chunks) => chunks.take(records, &mut self.output),
            None => self.output.write_all(records).map_err(|e| Error::io("writing", e)),
        }
    }

    /// Writes what follows the points, completes the header, and returns the output.
    ///
    /// # Errors
    /// If reading or writing fails.
    pub fn finish(mut self) -> Result<W> {
        if self.written != self.points {
            let what = format!("{} points were read, the header states {}", self.written, self.points);
            return Err(Error::malformed(what));
        }
        if let Some(chunks) = self.chunks.take() {
            let table = chunks.finish(&mut self.output)?;
            let position = self.position()?;
            self.put_bytes(|_| table)?;
            self.seek(self.points_start)?;
            self.put_bytes(|_| (position as i64).to_le_bytes().to_vec())?;
            self.output.seek(SeekFrom::End(0)).map_err(|e| Error::io("writing", e))?;
        }
        let start = self.position()?;
        self.extended.write(&self.file, &mut self.output)?;
        copy_range(&self.file, self.tail.clone(), &mut self.output)?;
        self.complete_header(start);
        self.seek(0)?;
        self.put_bytes(|copy| copy.header.clone())?;
        self.output.seek(SeekFrom::End(0)).map_err(|e| Error::io("writing", e))?;
        Ok(self.output)
    }

    /// Sets the positions of what now starts at byte `start`, the number of points, and the range of z.
    fn complete_header(&mut self, start: u64) {
        let (header, raw) = (&mut self.header, self.raw);
        if raw.waveforms_start > 0 {
            let old = raw.waveforms_start;
            let mut at = start;
            let moved = self.extended.records.iter().find_map(|record| {
                let found = (record.start == old).then_some(at);
                at += record.len();
                found
            });
            let in_tail = self.tail.contains(&old).then(|| start + (old - self.tail.start));
            if let Some(moved) = moved.or(in_tail) {
                put(header, WAVEFORM_START, &moved.to_le_bytes());
            }
        }
        if raw.extended > 0 {
            let count = self.extended.records.len() as u32;
            let is_list = self.tail.is_empty();
            if is_list {
                put(header, EVLR_COUNT, &count.to_le_bytes());
            }
            put(header, EVLR_START, &if is_list && count == 0 { 0 } else { start }.to_le_bytes());
        }
        if raw.points > 0 && raw.legacy_points > 0 {
            // Both numbers, of which only one counted, become that one.
            put(header, POINTS, &self.points.to_le_bytes());
            put(header, LEGACY_POINTS, &u32::try_from(self.points).unwrap_or(0).to_le_bytes());
        }
        if self.has_new_z {
            let [min, max] = self.range_z.unwrap_or_default().map(|z| f64::from(z) * raw.scale[2]);
            put(header, MAX_Z, &max.to_le_bytes());
            put(header, MAX_Z + 8, &min.to_le_bytes());
        }
    }

    fn put_bytes(&mut self, bytes: impl FnOnce(&Self) -> Vec<u8>) -> Result<()> {
        let bytes = bytes(self);
        self.output.write_all(&bytes).map_err(|e| Error::io("writing", e))
    }

    fn position(&mut self) -> Result<u64> {
        self.output.stream_position().map_err(|e| Error::io("writing", e))
    }

    fn seek(&mut self, to: u64) -> Result<()> {
        self.output.seek(SeekFrom::Start(to)).map(drop).map_err(|e| Error::io("writing", e))
    }
}

/// The bytes of the header, up to the first record.
fn read_header(file: &FileView, len: u16) -> Result<Vec<u8>> {
    let mut header = vec![0; usize::from(len)];
    file.read_at(0, &mut header).map_err(|e| Error::io("reading", e).at("header at byte 0"))?;
    Ok(header)
}

/// The extended records that the header counts; `None` if there are none, or not all of them are in the file.
fn extended_records(file: &FileView, raw: &RawHeader) -> Result<Option<RecordList>> {
    if raw.extended == 0 {
        return Ok(None);
    }
    let list = RecordList::read(file, raw.extended_start, file.len(), raw.extended, true)?;
    Ok((list.records.len() == raw.extended as usize).then_some(list))
}

fn put(header: &mut [u8], at: usize, value: &[u8]) {
    header[at..at + value.len()].copy_from_slice(value);
}
