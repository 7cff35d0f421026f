//! The header as bytes: a preamble, a few fixed fields, then records with tags.

use std::cmp::Ordering;

use byteorder::{ByteOrder, LittleEndian as LE};

use super::attribute_code::{decode_attributes, encode_attributes};
use super::constraints::Constrained;
use super::coordinates::Coordinates;
use super::header::{COUNT_UNKNOWN, Crs, Header, check_tree};
use super::kind::Kind;
use super::part::PartName;
use super::tag_rules::{TagBytes, check_tag, may_be_skipped, needs_newer};
use super::weights::Weighted;
use crate::model::bounds::{Bounds, Region};
use crate::model::cells::CellTree;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::HEADER_BODY_MAX;

/// First bytes of every stream. The first byte is not ASCII, and the line ends reveal damage by text-mode
/// transfer.
pub(super) const MAGIC: [u8; 8] = *b"\x89SPM\r\n\x1a\n";

/// Version of the stream, and of its text twin, that this code reads and writes.
pub const VERSION: u16 = 2;

/// Length of magic, version, kind and body length, in bytes.
pub(super) const PREAMBLE_LEN: usize = 16;

/// Length of the fields of the body before its records, in bytes.
const FIXED_BODY_LEN: usize = 16;
/// Length of tag and length before the payload of a record, in bytes.
const RECORD_HEAD_LEN: usize = 8;

const TYPE_F64: u8 = 1;
const TYPE_I32: u8 = 2;
const FLAG_CHUNKED: u8 = 1;
/// The bit of the features that says that blocks may be compressed.
const FEATURE_COMPRESSED: u32 = 1;

/// Why a record is malformed.
pub(super) type Fault = String;

/// A record of the header.
struct Row {
    tag: TagBytes,
    /// The payload, if the header states what the record holds.
    encode: fn(&Header) -> Option<Vec<u8>>,
    /// Puts the payload into the header, whose fixed fields are known.
    decode: fn(&mut Header, &[u8]) -> std::result::Result<(), Fault>,
}

const GRID: TagBytes = *b"GRID";

/// All records that this version knows, in the order in which they are written.
const ROWS: [Row; 11] = [
    Row { tag: GRID, encode: encode_grid, decode: decode_grid },
    Row { tag: *b"BBOX", encode: encode_bounds, decode: decode_bounds },
    Row { tag: *b"TREE", encode: encode_tree, decode: decode_tree },
    Row { tag: *b"REGN", encode: encode_region, decode: decode_region },
    Row { tag: *b"cWKT", encode: encode_wkt, decode: decode_wkt },
    Row { tag: *b"cGEO", encode: encode_geo_keys, decode: decode_geo_keys },
    Row { tag: *b"attr", encode: encode_attributes, decode: decode_attributes },
    Row { tag: *b"cons", encode: Constrained::encode, decode: Constrained::decode },
    Row { tag: *b"wght", encode: Weighted::encode, decode: Weighted::decode },
    Row { tag: *b"part", encode: PartName::encode, decode: PartName::decode },
    Row { tag: *b"prod", encode: encode_producer, decode: decode_producer },
];

impl Header {
    /// The header as bytes, checksum included.
    pub(super) fn encode(&self) -> Result<Vec<u8>> {
        let refused = |reason: String| Error::usage(format!("cannot write the header: {reason}"));
        self.check().map_err(refused)?;
        let mut bytes = vec![0u8; PREAMBLE_LEN + FIXED_BODY_LEN];
        bytes[0..8].copy_from_slice(&MAGIC);
        LE::write_u16(&mut bytes[8..], VERSION);
        LE::write_u16(&mut bytes[10..], self.kind.code());
        self.encode_fixed(&mut bytes[PREAMBLE_LEN..]);
        for Row { tag, encode, .. } in &ROWS {
            if let Some(payload) = encode(self) {
                bytes.extend_from_slice(tag);
                bytes.extend_from_slice(&(payload.len() as u32).to_le_bytes());
                bytes.extend_from_slice(&payload);
            }
        }
        let body_len = bytes.len() - PREAMBLE_LEN;
        if body_len > HEADER_BODY_MAX {
            return Err(refused(format!(
                "{body_len} bytes with CRS and producer, the maximum is {HEADER_BODY_MAX}"
            )));
        }
        LE::write_u32(&mut bytes[12..], body_len as u32);
        let checksum = crc32c::crc32c(&bytes);
        bytes.extend_from_slice(&checksum.to_le_bytes());
        Ok(bytes)
    }

    fn encode_fixed(&self, body: &mut [u8]) {
        body[0] = match self.coordinates {
            Coordinates::F64 => TYPE_F64,
            Coordinates::I32 { .. } => TYPE_I32,
        };
        body[1] = self.dims;
        body[2] = u8::from(self.has_elevation);
        body[3] = if self.chunked { FLAG_CHUNKED } else { 0 };
        LE::write_u32(&mut body[4..], if self.compressed { FEATURE_COMPRESSED } else { 0 });
        LE::write_u64(&mut body[8..], self.points.unwrap_or(COUNT_UNKNOWN));
    }

    /// Reads the body after a preamble, whose checksum the reader has verified. `kind` is the code in the
    /// preamble. What this version does not know is reported before rules that a newer version may change.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Unsupported`] if the stream needs what this version does not know;
    /// [`spmesh_base::error::ErrorKind::Malformed`] if the header breaks a rule.
    pub(super) fn decode(kind: u16, body: &[u8]) -> Result<Header> {
        let kind = Kind::from_code(kind).ok_or_else(|| needs_newer(format_args!("kind {kind}")))?;
        let (fixed, records) = body.split_first_chunk().expect("the preamble states a sufficient length");
        let mut header = decode_fixed(kind, fixed)?;
        check_tags(records)?;
        header.check_flags_and_dims(fixed).map_err(Error::malformed)?;
        let mut has_grid = false;
        for record in Records(records) {
            let (tag, payload) = record?;
            has_grid |= tag == GRID;
            if let Some(row) = row_of(tag) {
                (row.decode)(&mut header, payload).map_err(|fault| {
                    Error::malformed(format!("header record \"{}\": {fault}", tag.escape_ascii()))
                })?;
            }
        }
        if !has_grid && header.coordinates != Coordinates::F64 {
            return Err(Error::malformed("no header record \"GRID\", which i32 coordinates need"));
        }
        header.check().map_err(Error::malformed)?;
        Ok(header)
    }

    /// Checks the fixed fields that say how records are to be read.
    fn check_flags_and_dims(&self, fixed: &[u8; FIXED_BODY_LEN]) -> std::result::Result<(), Fault> {
        if fixed[2] > 1 {
            return Err(format!("elevation {}, expected 0 or 1", fixed[2]));
        }
        if fixed[3] & !FLAG_CHUNKED != 0 {
            return Err(format!("flags {:#04x}, of which all bits but bit 0 must be 0", fixed[3]));
        }
        self.check_dims()
    }
}

/// Checks the version of a stream or of a text twin.
///
/// # Errors
/// [`spmesh_base::error::ErrorKind::Unsupported`] if it is not [`VERSION`].
pub fn check_version(version: u64) -> Result<()> {
    match version.cmp(&u64::from(VERSION)) {
        Ordering::Equal => Ok(()),
        Ordering::Less => Err(Error::unsupported(format!(
            "version {version}; this program reads version {VERSION} only: an older spmesh made it, make it \
             again from its input"
        ))),
        Ordering::Greater => Err(Error::unsupported(format!(
            "version {version}; this program reads version {VERSION}: a newer spmesh made it"
        ))),
    }
}

/// Checks version and body length in a preamble that starts with the magic; returns the code of the kind and
/// the length.
pub(super) fn decode_preamble(preamble: &[u8]) -> Result<(u16, usize)> {
    check_version(LE::read_u16(&preamble[8..]).into())?;
    let len = LE::read_u32(&preamble[12..]) as usize;
    if !(FIXED_BODY_LEN..=HEADER_BODY_MAX).contains(&len) {
        let range = format!("the minimum is {FIXED_BODY_LEN}, the maximum is {HEADER_BODY_MAX}");
        return Err(Error::malformed(format!("header body of {len} bytes, {range}")));
    }
    Ok((LE::read_u16(&preamble[10..]), len))
}

/// A header with the fixed fields. The grid of integers comes with its record.
fn decode_fixed(kind: Kind, fixed: &[u8; FIXED_BODY_LEN]) -> Result<Header> {
    let features = LE::read_u32(&fixed[4..]);
    let unknown = features & !FEATURE_COMPRESSED;
    if unknown != 0 {
        return Err(needs_newer(format_args!("feature bit {}", unknown.trailing_zeros())));
    }
    let coordinates = match fixed[0] {
        TYPE_F64 => Coordinates::F64,
        TYPE_I32 => Coordinates::I32 { scale: [0.0; 3], offset: [0.0; 3] },
        code => return Err(needs_newer(format_args!("coordinate type {code}"))),
    };
    let points = LE::read_u64(&fixed[8..]);
    Ok(Header {
        points: (points != COUNT_UNKNOWN).then_some(points),
        chunked: fixed[3] & FLAG_CHUNKED != 0,
        compressed: features & FEATURE_COMPRESSED != 0,
        producer: String::new(),
        ..Header::new(kind, coordinates, fixed[1], fixed[2] == 1)
    })
}

/// The records of a body: tag and payload of each. After an error nothing follows.
struct Records<'a>(&'a [u8]);

impl<'a> Iterator for Records<'a> {
    type Item = Result<(TagBytes, &'a [u8])>;

    fn next(&mut self) -> Option<Self::Item> {
        let bytes = std::mem::take(&mut self.0);
        if bytes.is_empty() {
            return None;
        }
        let Some((head, rest)) = bytes.split_first_chunk::<RECORD_HEAD_LEN>() else {
            let message = format!("{} bytes after the last header record", bytes.len());
            return Some(Err(Error::malformed(message)));
        };
        let tag = [head[0], head[1], head[2], head[3]];
        let len = LE::read_u32(&head[4..]);
        let Some((payload, after)) = rest.split_at_checked(len as usize) else {
            return Some(Err(Error::malformed(format!(
                "header record \"{}\" of {len} bytes, but {} are left in the header",
                tag.escape_ascii(),
                rest.len()
            ))));
        };
        self.0 = after;
        Some(Ok((tag, payload)))
    }
}

fn row_of(tag: TagBytes) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.tag == tag)
}

/// Checks frames and tags of all records, then that none is unknown that must not be skipped.
fn check_tags(records: &[u8]) -> Result<()> {
    let mut tags = Vec::new();
    for record in Records(records) {
        let (tag, _) = record?;
        check_tag(tag, "header record")?;
        tags.push(tag);
    }
    let needed = tags.iter().find(|&&tag| row_of(tag).is_none() && !may_be_skipped(tag)).copied();
    tags.sort_unstable();
    if let Some(pair) = tags.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Error::malformed(format!("two header records \"{}\"", pair[0].escape_ascii())));
    }
    match needed {
        None => Ok(()),
        Some(tag) => Err(needs_newer(format_args!("header record \"{}\"", tag.escape_ascii()))),
    }
}

fn floats_to_bytes<'a>(parts: impl IntoIterator<Item = &'a [f64]>) -> Vec<u8> {
    parts.into_iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
}

/// The numbers of a payload, which must have `len` bytes; a shorter last number is left out.
fn floats(payload: &[u8], len: usize) -> std::result::Result<Vec<f64>, Fault> {
    if payload.len() != len {
        return Err(format!("{} bytes, expected {len}", payload.len()));
    }
    Ok(payload.chunks_exact(8).map(LE::read_f64).collect())
}

/// Two triples of numbers.
fn triples(payload: &[u8]) -> std::result::Result<[[f64; 3]; 2], Fault> {
    let numbers = floats(payload, 48)?;
    let triple = |at: usize| [numbers[at], numbers[at + 1], numbers[at + 2]];
    Ok([triple(0), triple(3)])
}

fn text(payload: &[u8], what: &str) -> std::result::Result<String, Fault> {
    String::from_utf8(payload.to_vec()).map_err(|_| format!("{what} is not UTF-8"))
}

fn encode_grid(header: &Header) -> Option<Vec<u8>> {
    match &header.coordinates {
        Coordinates::F64 => None,
        Coordinates::I32 { scale, offset } => Some(floats_to_bytes([&scale[..], offset])),
    }
}

fn decode_grid(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    if header.coordinates == Coordinates::F64 {
        return Err("f64 coordinates have no grid".into());
    }
    let [scale, offset] = triples(payload)?;
    header.coordinates = Coordinates::I32 { scale, offset };
    Ok(())
}

fn encode_bounds(header: &Header) -> Option<Vec<u8>> {
    header.bounds.map(|bounds| floats_to_bytes([&bounds.min[..], &bounds.max]))
}

fn decode_bounds(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    let [min, max] = triples(payload)?;
    header.bounds = Some(Bounds { min, max });
    Ok(())
}

fn encode_tree(header: &Header) -> Option<Vec<u8>> {
    let tree = header.tree?;
    let mut payload = floats_to_bytes([&tree.origin()[..usize::from(tree.dims())], &[tree.side()]]);
    payload.extend_from_slice(&u32::from(tree.depth()).to_le_bytes());
    Some(payload)
}

fn decode_tree(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    check_tree(header.kind, true)?;
    let dims = usize::from(header.dims);
    let numbers = floats(payload, 8 * (dims + 1) + 4)?;
    let mut origin = [0.0; 3];
    origin[..dims].copy_from_slice(&numbers[..dims]);
    let depth = u8::try_from(LE::read_u32(&payload[8 * (dims + 1)..])).ok();
    let tree = depth.and_then(|depth| CellTree::new(header.dims, depth, origin, numbers[dims]));
    header.tree = Some(tree.ok_or("the finalization tree is out of range or not exact")?);
    Ok(())
}

fn encode_region(header: &Header) -> Option<Vec<u8>> {
    let dims = usize::from(header.dims);
    header.region.map(|region| floats_to_bytes([&region.min[..dims], &region.max[..dims]]))
}

fn decode_region(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    let dims = usize::from(header.dims);
    let sides = floats(payload, 16 * dims)?;
    header.region = Some(Region::of_sides(&sides[..dims], &sides[dims..]));
    Ok(())
}

/// Puts a CRS into the header, which must have none: the two encodings exclude each other.
fn set_crs(header: &mut Header, crs: Crs) -> std::result::Result<(), Fault> {
    if header.crs != Crs::Unknown {
        return Err("the header has the CRS in another record already".into());
    }
    header.crs = crs;
    Ok(())
}

fn encode_wkt(header: &Header) -> Option<Vec<u8>> {
    match &header.crs {
        Crs::Wkt(text) => Some(text.clone().into_bytes()),
        _ => None,
    }
}

fn decode_wkt(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    set_crs(header, Crs::Wkt(text(payload, "CRS")?))
}

fn encode_geo_keys(header: &Header) -> Option<Vec<u8>> {
    let Crs::GeoKeys { directory, doubles, ascii } = &header.crs else { return None };
    let mut payload = Vec::with_capacity(12 + directory.len() + doubles.len() + ascii.len());
    for record in [directory, doubles, ascii] {
        payload.extend_from_slice(&(record.len() as u32).to_le_bytes());
        payload.extend_from_slice(record);
    }
    Some(payload)
}

fn decode_geo_keys(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    let [directory, doubles, ascii] = geo_records(payload).ok_or("GeoKey records do not fit the CRS")?;
    set_crs(header, Crs::GeoKeys { directory, doubles, ascii })
}

/// Three byte strings, each after its length, that fill the payload.
fn geo_records(payload: &[u8]) -> Option<[Vec<u8>; 3]> {
    let mut rest = payload;
    let mut record = || {
        let (len, after) = rest.split_first_chunk::<4>()?;
        let (record, after) = after.split_at_checked(u32::from_le_bytes(*len) as usize)?;
        rest = after;
        Some(record.to_vec())
    };
    let records = [record()?, record()?, record()?];
    rest.is_empty().then_some(records)
}

fn encode_producer(header: &Header) -> Option<Vec<u8>> {
    (!header.producer.is_empty()).then(|| header.producer.clone().into_bytes())
}

fn decode_producer(header: &mut Header, payload: &[u8]) -> std::result::Result<(), Fault> {
    header.producer = text(payload, "producer")?;
    Ok(())
}
