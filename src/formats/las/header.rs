//! The header and variable length records of a LAS file, each length checked against the file before use.

use std::ops::Range;
use std::sync::Arc;

use laz::{DecompressionSelection, LazVlr};

use crate::las::fields;
use crate::las::index::{Part, copc};
use crate::las::laz_chunks::Chunks;
use crate::las::laz_codec::Codec;
use crate::las::laz_salvage;
use crate::las::laz_table;
use crate::las::raw::{HEADER_LEN_MIN, RawHeader};
use crate::source::crs;
use crate::source::origin::FileView;
use crate::source::row_plan::Offer;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::HEADER_BODY_MAX;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// Length of a point record per format, without extra bytes.
pub(crate) const RECORD_LENS: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

pub(crate) const VLR_HEADER_LEN: u64 = 54;
pub(crate) const EVLR_HEADER_LEN: u64 = 60;
/// User and number of the records that describe extra bytes.
const EXTRA_BYTES: (&[u8], u16) = (b"LASF_Spec", 4);
/// User and number of the records with an index: COPC, and LAStools.
const COPC: (&[u8], u16) = (b"copc", 1);
pub(crate) const LAX: (&[u8], u16) = (b"LAStools", 30);
/// Steps from the offset that must be finite numbers: as many as grids of streams need.
const STEPS_MAX: f64 = (1u64 << 51) as f64;
const GLOBAL_ENCODING_WKT: u16 = 1 << 4;

/// What reading the points needs.
#[derive(Debug, Clone)]
pub(crate) struct LasHeader {
    /// The fields as the file states them.
    pub(crate) raw: RawHeader,
    /// Point data record format, 0 to 10.
    pub(crate) format: u8,
    /// Length of a point record in bytes.
    pub(crate) record_len: usize,
    /// Number of point records.
    pub(crate) points: u64,
    /// Byte at which point data starts.
    pub(crate) points_start: u64,
    /// Byte at which point data ends at the latest: that of extended records, waveforms, or the file's end.
    pub(crate) points_end: u64,
    /// Length of the file when the header was read: a file that grows is that of this moment.
    pub(crate) file_len: u64,
    /// How the points are compressed, if they are.
    pub(crate) laz: Option<Laszip>,
    /// Scale and offset.
    pub(crate) coordinates: Coordinates,
    /// Bounding box as stated, in stored coordinates; `None` if it makes no sense.
    pub(crate) bounds: Option<Bounds>,
    /// Coordinate reference system.
    pub(crate) crs: Crs,
    /// Whether the points before a cut are wanted, and how many are behind it.
    pub(crate) is_salvaged: bool,
    pub(crate) lost: u64,
    /// Fields of the records beside the coordinates.
    pub(crate) offers: Vec<Offer>,
    /// Where the file has an index.
    pub(crate) indices: Indices,
    /// The records to read, in the order of the file; `None` for all of them.
    pub(crate) parts: Option<Arc<[Part]>>,
}

/// Bytes of the records that hold an index, without their heads.
#[derive(Debug, Clone, Default)]
pub(crate) struct Indices {
    pub(crate) copc: Option<Range<u64>>,
    pub(crate) lax: Option<Range<u64>>,
}

/// The laszip record.
#[derive(Debug, Clone)]
pub(crate) struct Laszip {
    /// What the library makes of it.
    pub(crate) vlr: LazVlr,
    /// Whether the points are in chunks. Old files have them in one piece, without a chunk table.
    pub(crate) is_chunked: bool,
    /// Byte of the extended record that LAStools appends to files whose header has no place for it.
    pub(crate) appended: Option<u64>,
}

impl LasHeader {
    /// Reads the header of `file`. Adds harmless oddities to `notices`. Of a file that was cut off, takes the
    /// points before the cut if `is_salvaged`; the number of points is that of these.
    pub(crate) fn read(file: &FileView, is_salvaged: bool, notices: &mut Vec<String>) -> Result<LasHeader> {
        let raw = RawHeader::read(file)?;
        let format = raw.format & 0x3f;
        let is_compressed = raw.format & 0xc0 != 0;
        let record_len = usize::from(raw.record_len);
        let least = *RECORD_LENS
            .get(usize::from(format))
            .ok_or_else(|| Error::malformed(format!("point format {format}, expected 0 to 10")))?;
        if record_len < least {
            return Err(Error::malformed(format!(
                "point records of {record_len} bytes, format {format} needs {least}"
            )));
        }
        if usize::from(raw.header_len) < HEADER_LEN_MIN || raw.points_start < u32::from(raw.header_len) {
            return Err(Error::malformed(format!(
                "header of {} bytes with points from byte {} on: they overlap",
                raw.header_len, raw.points_start
            )));
        }
        let records = Records::read(file, &raw, notices)?;
        let coordinates = coordinates(&raw)?;
        let mut header = LasHeader {
            raw,
            format,
            record_len,
            points: count(&raw, format, notices),
            points_start: u64::from(raw.points_start),
            points_end: points_end(&raw, file.len()),
            file_len: file.len(),
            laz: records.laz(is_compressed)?,
            coordinates,
            bounds: stored_bounds(&raw, &coordinates),
            is_salvaged,
            lost: 0,
            offers: fields::offers(format, record_len, least, records.extra_bytes.as_deref()),
            crs: crs::of_records(
                records.wkt,
                records.geo_keys,
                raw.global_encoding & GLOBAL_ENCODING_WKT != 0,
                notices,
            ),
            indices: records.indices,
            parts: None,
        };
        header.check_len(file, notices)?;
        if let Some(laszip) = header.laz.as_ref().filter(|_| is_salvaged) {
            let whole = laz_salvage::whole_points(file, &header, laszip)?;
            if whole < header.points {
                header.keep_first(whole, header.truncated(file))?;
            }
        }
        Ok(header)
    }

    /// Rejects a file too short for its stated points, before any point is used. Adds a notice if there is
    /// room for more points than the header states.
    ///
    /// If the check passes, `points * record_len` fits u64.
    fn check_len(&mut self, file: &FileView, notices: &mut Vec<String>) -> Result<()> {
        let record_len = self.record_len as u64;
        if self.points.checked_mul(record_len).is_none() {
            return Err(Error::malformed(format!(
                "the header states {} points of {record_len} bytes, more than any file can hold",
                self.points
            )));
        }
        let room = match self.laz {
            Some(_) => laz_table::room(file, self.points_start, self.points_end)?,
            None => self.points_end.saturating_sub(self.points_start),
        };
        if self.points == 0 {
            // Compressed points start with an uncompressed record.
            if room >= record_len {
                notices.push(format!("the header states no points, although {room} bytes follow it"));
            }
            return Ok(());
        }
        if let Some(laszip) = &self.laz {
            // How many points there are is known when they are decompressed.
            return match room {
                0 => Err(self.truncated(file)),
                _ => self.check_chunks(file, laszip, notices),
            };
        }
        let whole = room / record_len;
        if whole < self.points {
            let position = format!("record {whole} at byte {}", self.points_start + whole * record_len);
            return self.keep_first(whole, self.truncated(file).at(position));
        }
        if whole > self.points {
            notices.push(format!(
                "the header states {} points, but {whole} records fit before byte {}: the last {} are not read",
                self.points,
                self.points_end,
                whole - self.points
            ));
        }
        Ok(())
    }

    /// Checks how points are compressed, and that the chunks and their table are in the file. Whether there
    /// are all points without a table is known when they are decompressed.
    fn check_chunks(&self, file: &FileView, laszip: &Laszip, notices: &mut Vec<String>) -> Result<()> {
        Codec::new(laszip.vlr.clone(), self, DecompressionSelection::all())?;
        if self.is_salvaged || !laszip.is_chunked {
            return Ok(());
        }
        if let Some(place) = laz_table::stated_missing(file, self.points_start)? {
            return Err(self.truncated(file).at(format!("chunk table stated {place}")));
        }
        if let Chunks::Unknown { .. } = Chunks::find(file, self, laszip)? {
            notices
                .push("the chunk table is missing: only reading shows whether all points are there".into());
        }
        self.indices.copc.as_ref().map_or(Ok(()), |info| copc::check_root(file, info))
    }

    /// Keeps the first points, if there are any and they are wanted.
    fn keep_first(&mut self, points: u64, truncated: Error) -> Result<()> {
        if !self.is_salvaged || points == 0 {
            return Err(truncated);
        }
        self.lost = self.points - points;
        self.points = points;
        Ok(())
    }

    /// The error of a file with fewer points than stated.
    fn truncated(&self, file: &FileView) -> Error {
        let end = match self.points_end == file.len() {
            true => "the file ends",
            false => "other data start",
        };
        self.cut(Error::malformed(format!(
            "truncated: the header states {} points of {} bytes from byte {} on, {end} at byte {}",
            self.points, self.record_len, self.points_start, self.points_end
        )))
    }

    /// The error of a file that was cut off, with a remedy.
    pub(crate) fn cut(&self, error: Error) -> Error {
        match self.is_salvaged {
            true => error,
            false => error.noting("spfinalize --salvage takes the points before the cut"),
        }
    }
}

/// Byte at which point data ends at the latest.
fn points_end(raw: &RawHeader, file_len: u64) -> u64 {
    let evlrs = if raw.extended > 0 { raw.extended_start } else { 0 };
    let others = [evlrs, raw.waveforms_start];
    let after = others.into_iter().filter(|&start| start > raw.points_start.into());
    after.fold(file_len, u64::min)
}

/// The number of points. Writers of LAS 1.4 also fill a 32-bit field for older readers. If both are filled
/// and differ, the older field counts for the formats that older readers know, as the standard requires.
fn count(raw: &RawHeader, format: u8, notices: &mut Vec<String>) -> u64 {
    let (legacy, large) = (u64::from(raw.legacy_points), raw.points);
    if large == 0 || legacy == large {
        return legacy;
    }
    if legacy == 0 {
        return large;
    }
    let chosen = if format < 6 { legacy } else { large };
    notices.push(format!("the header states both {legacy} and {large} points: reading {chosen}"));
    chosen
}

fn coordinates(raw: &RawHeader) -> Result<Coordinates> {
    let scale = raw.scale;
    // Some writers leave a negative zero behind: adding 0.0 makes it positive.
    let offset = raw.offset.map(|offset| offset + 0.0);
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        if !(scale[axis] > 0.0 && scale[axis].is_finite()) {
            return Err(Error::malformed(format!(
                "header at byte {}: scale of {name} is {:?}, expected a positive number",
                131 + 8 * axis,
                scale[axis]
            )));
        }
        if !offset[axis].is_finite() {
            return Err(Error::malformed(format!(
                "header at byte {}: offset of {name} is {:?}, expected a finite number",
                155 + 8 * axis,
                offset[axis]
            )));
        }
        if !(offset[axis].abs() + scale[axis] * STEPS_MAX).is_finite() {
            return Err(Error::usage(format!(
                "header at byte {}: a scale of {name} of {:?} with an offset of {:?} leads beyond numbers of \
                 64 bits: correct the header",
                131 + 8 * axis,
                scale[axis],
                offset[axis]
            )));
        }
    }
    Ok(Coordinates::I32 { scale, offset })
}

fn stored_bounds(raw: &RawHeader, coordinates: &Coordinates) -> Option<Bounds> {
    let min: Point = coordinates.to_stored(raw.min);
    let max: Point = coordinates.to_stored(raw.max);
    let fits = |corner: Point| corner.iter().all(|&value| coordinates.can_store(value));
    let ordered = (0..3).all(|axis| min[axis] <= max[axis]);
    (fits(min) && fits(max) && ordered).then_some(Bounds { min, max })
}

/// The variable length records that matter here; others are skipped unread.
#[derive(Default)]
struct Records {
    laszip: Option<Vec<u8>>,
    wkt: Option<Vec<u8>>,
    geo_keys: [Option<Vec<u8>>; 3],
    extra_bytes: Option<Vec<u8>>,
    indices: Indices,
}

impl Records {
    fn read(file: &FileView, raw: &RawHeader, notices: &mut Vec<String>) -> Result<Records> {
        let mut records = Records::default();
        let points_start = u64::from(raw.points_start).min(file.len());
        let mut at = u64::from(raw.header_len);
        for index in 0..raw.records {
            let Some(next) = records.read_one(file, at, points_start, false, notices)? else {
                notices.push(format!(
                    "the header states {} variable length records, only {index} fit before the points",
                    raw.records
                ));
                break;
            };
            at = next;
        }
        let mut at = raw.extended_start;
        for index in 0..raw.extended {
            let Some(next) = records.read_one(file, at, file.len(), true, notices)? else {
                let without_index = match records.indices.copc.take() {
                    Some(_) => ", and the COPC index is left out: all points are read",
                    None => "",
                };
                notices.push(format!(
                    "the header states {} extended variable length records, only {index} fit into the file: \
                     it was cut off after its points, or the header is wrong{without_index}",
                    raw.extended
                ));
                break;
            };
            at = next;
        }
        Ok(records)
    }

    /// Reads the record at byte `at` and returns the byte after it, or `None` if it does not end before
    /// `end`.
    fn read_one(
        &mut self,
        file: &FileView,
        at: u64,
        end: u64,
        extended: bool,
        notices: &mut Vec<String>,
    ) -> Result<Option<u64>> {
        let header_len = if extended { EVLR_HEADER_LEN } else { VLR_HEADER_LEN };
        if at.checked_add(header_len).is_none_or(|after| after > end) {
            return Ok(None);
        }
        let mut header = [0; EVLR_HEADER_LEN as usize];
        let read = |at: u64, bytes: &mut [u8]| {
            file.read_at(at, bytes).map_err(|e| Error::io("reading", e).at(format!("record at byte {at}")))
        };
        read(at, &mut header[..header_len as usize])?;
        let len = if extended {
            u64::from_le_bytes(header[20..28].try_into().expect("eight bytes"))
        } else {
            u64::from(u16::from_le_bytes([header[20], header[21]]))
        };
        let data = at + header_len;
        let Some(after) = data.checked_add(len).filter(|&after| after <= end) else { return Ok(None) };
        let user = header[2..18].split(|&byte| byte == 0).next().unwrap_or_default();
        let number = u16::from_le_bytes([header[18], header[19]]);
        match (user, number) {
            COPC => _ = self.indices.copc.get_or_insert(data..after),
            LAX => _ = self.indices.lax.get_or_insert(data..after),
            _ => {}
        }
        let Some(slot) = self.slot(user, number) else { return Ok(Some(after)) };
        if len > HEADER_BODY_MAX as u64 {
            notices.push(format!(
                "record {number} of {} at byte {at} is {len} bytes long, the maximum is {HEADER_BODY_MAX}: \
                 leaving it out",
                String::from_utf8_lossy(user)
            ));
        } else {
            let mut bytes = vec![0; len as usize];
            read(data, &mut bytes)?;
            match slot {
                // Some files describe extra bytes in several records, one after the other.
                Some(described) if (user, number) == EXTRA_BYTES => described.extend(bytes),
                Some(_) => {}
                none => *none = Some(bytes),
            }
        }
        Ok(Some(after))
    }

    fn slot(&mut self, user: &[u8], record: u16) -> Option<&mut Option<Vec<u8>>> {
        match (user, record) {
            (b"laszip encoded", 22204) => Some(&mut self.laszip),
            EXTRA_BYTES => Some(&mut self.extra_bytes),
            (b"LASF_Projection", 2112) => Some(&mut self.wkt),
            (b"LASF_Projection", 34735..=34737) => Some(&mut self.geo_keys[usize::from(record - 34735)]),
            _ => None,
        }
    }

    fn laz(&self, is_compressed: bool) -> Result<Option<Laszip>> {
        if !is_compressed {
            return Ok(None);
        }
        let bytes = self.laszip.as_ref().ok_or_else(|| {
            Error::malformed("points are marked as compressed, but the laszip record is missing")
        })?;
        let vlr = LazVlr::from_buffer(bytes).map_err(|e| Error::malformed(format!("laszip record: {e}")))?;
        let appended = appended(bytes);
        match bytes[..] {
            [1, 0, ..] => Ok(Some(Laszip { vlr, is_chunked: false, appended })),
            [2 | 3, 0, ..] => Ok(Some(Laszip { vlr, is_chunked: true, appended })),
            _ => Err(Error::malformed(format!("laszip record: compressor {}, expected 1, 2 or 3", bytes[0]))),
        }
    }
}

/// Byte of the first appended record that a laszip record states, if it states any.
fn appended(laszip: &[u8]) -> Option<u64> {
    let number = |at: usize| Some(i64::from_le_bytes(laszip.get(at..at + 8)?.try_into().ok()?));
    let (count, at) = (number(16)?, number(24)?);
    u64::try_from(at).ok().filter(|_| count > 0)
}
