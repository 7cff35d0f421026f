//! The header: kind, coordinates, and what the producer knows before the first block.

use std::cmp::Ordering;
use std::ops::Range;

use byteorder::{ByteOrder, LittleEndian as LE};

use super::coordinates::{Coordinates, is_grid};
use super::kind::Kind;
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::HEADER_BODY_MAX;
use spmesh_model::bounds::{Bounds, Region};
use spmesh_model::cells::CellTree;

/// First bytes of every stream. The first byte is not ASCII, and the line ends reveal damage by text-mode
/// transfer.
pub(super) const MAGIC: [u8; 8] = *b"\x89SPM\r\n\x1a\n";

/// Version of the container that this code reads and writes.
pub(super) const VERSION: u16 = 1;

/// Length of magic, version, kind and body length, in bytes.
pub(super) const PREAMBLE_LEN: usize = 16;

const FIXED_BODY_LEN: usize = 192;
const COUNT_UNKNOWN: u64 = u64::MAX;
const FLAG_BOUNDS: u8 = 1;
const FLAG_TREE: u8 = 2;
const FLAG_REGION: u8 = 4;
const FLAG_CHUNKED: u8 = 8;

/// Coordinate reference system, carried verbatim.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Crs {
    /// Not stated by the input.
    #[default]
    Unknown,
    /// Well-known text.
    Wkt(String),
    /// The three GeoTIFF records of a LAS file: key directory (34735), doubles (34736), ASCII (34737).
    GeoKeys {
        /// Record 34735: little-endian u16 entries, four per key.
        directory: Vec<u8>,
        /// Record 34736: little-endian f64 values.
        doubles: Vec<u8>,
        /// Record 34737: text values.
        ascii: Vec<u8>,
    },
}

/// Everything a reader knows before the first block.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// What the stream holds.
    pub kind: Kind,
    /// Encoding of the coordinates.
    pub coordinates: Coordinates,
    /// Dimensions of the geometry: 2, 3 or 4.
    pub dims: u8,
    /// Whether two-dimensional points carry an elevation, or four-dimensional ones a value. False in three
    /// dimensions, where z is geometry.
    pub has_elevation: bool,
    /// Box that holds all points of the stream, in stored coordinates; `None` if unknown or empty. Writers
    /// give the smallest one where they can.
    pub bounds: Option<Bounds>,
    /// Number of points that END will state, where known.
    pub points: Option<u64>,
    /// The finalization tree that cell tags refer to.
    pub tree: Option<CellTree>,
    /// The region that a partial mesh covers, in stored coordinates; in the plane it is open in z.
    pub region: Option<Region<3>>,
    /// Whether the points between two tags lie in one cell of the second.
    pub chunked: bool,
    /// Coordinate reference system.
    pub crs: Crs,
    /// Program and version that wrote the stream.
    pub producer: String,
}

impl Header {
    /// A header of `kind` that states nothing else about the contents.
    #[must_use]
    pub fn new(kind: Kind, coordinates: Coordinates, dims: u8, has_elevation: bool) -> Self {
        Header {
            kind,
            coordinates,
            dims,
            has_elevation,
            bounds: None,
            points: None,
            tree: None,
            region: None,
            chunked: false,
            crs: Crs::Unknown,
            producer: concat!("spmesh ", env!("CARGO_PKG_VERSION")).to_string(),
        }
    }

    /// Numbers stored per point: the dimensions, and one more for an elevation or a value.
    #[must_use]
    pub fn coordinates_per_point(&self) -> usize {
        usize::from(self.dims) + usize::from(self.has_elevation)
    }

    /// Bytes of one stored point.
    #[must_use]
    pub fn point_len(&self) -> usize {
        self.coordinates_per_point() * self.coordinates.width()
    }

    /// The header as bytes, checksum included.
    ///
    /// # Errors
    /// [`spmesh_core::error::ErrorKind::Usage`] if it breaks a rule of the format or is too long.
    pub(super) fn encode(&self) -> Result<Vec<u8>> {
        self.check().map_err(|reason| Error::usage(format!("cannot write the header: {reason}")))?;
        let (crs_code, crs) = encode_crs(&self.crs);
        let body_len = FIXED_BODY_LEN + crs.len() + self.producer.len();
        if body_len > HEADER_BODY_MAX || self.producer.len() > usize::from(u16::MAX) {
            return Err(Error::usage(format!(
                "cannot write the header: {body_len} bytes with CRS and producer, the maximum is \
                 {HEADER_BODY_MAX}"
            )));
        }
        let mut bytes = vec![0u8; PREAMBLE_LEN + FIXED_BODY_LEN];
        bytes[0..8].copy_from_slice(&MAGIC);
        LE::write_u16(&mut bytes[8..], VERSION);
        LE::write_u16(&mut bytes[10..], self.kind.code());
        LE::write_u32(&mut bytes[12..], body_len as u32);
        self.encode_fixed(&mut bytes[PREAMBLE_LEN..], crs_code, crs.len());
        bytes.extend_from_slice(&crs);
        bytes.extend_from_slice(self.producer.as_bytes());
        let checksum = crc32c::crc32c(&bytes);
        bytes.extend_from_slice(&checksum.to_le_bytes());
        Ok(bytes)
    }

    fn encode_fixed(&self, body: &mut [u8], crs_code: u16, crs_len: usize) {
        let (code, scale, offset) = match self.coordinates {
            Coordinates::F64 => (1, [0.0; 3], [0.0; 3]),
            Coordinates::I32 { scale, offset } => (2, scale, offset),
        };
        body[0] = code;
        body[1] = self.dims;
        body[2] = u8::from(self.has_elevation);
        body[3] = self.bounds.map_or(0, |_| FLAG_BOUNDS)
            | self.tree.map_or(0, |_| FLAG_TREE)
            | self.region.map_or(0, |_| FLAG_REGION)
            | if self.chunked { FLAG_CHUNKED } else { 0 };
        LE::write_u64(&mut body[8..], self.points.unwrap_or(COUNT_UNKNOWN));
        LE::write_f64_into(&scale, &mut body[16..40]);
        LE::write_f64_into(&offset, &mut body[40..64]);
        if let Some(bounds) = &self.bounds {
            LE::write_f64_into(&bounds.min, &mut body[64..88]);
            LE::write_f64_into(&bounds.max, &mut body[88..112]);
        }
        if let Some(tree) = &self.tree {
            LE::write_f64_into(&tree.origin(), &mut body[112..136]);
            LE::write_f64(&mut body[136..], tree.side());
            LE::write_u32(&mut body[144..], u32::from(tree.depth()));
        }
        if let Some(region) = &self.region {
            let dims = usize::from(self.dims);
            let sides = [&region.min[..dims], &region.max[..dims]].concat();
            LE::write_f64_into(&sides, &mut body[region_place(self.kind)]);
        }
        LE::write_u16(&mut body[184..], crs_code);
        LE::write_u16(&mut body[186..], self.producer.len() as u16);
        LE::write_u32(&mut body[188..], crs_len as u32);
    }

    /// Reads the body; `kind` comes from the preamble, whose checksum the reader has verified.
    pub(super) fn decode(kind: Kind, body: &[u8]) -> Result<Header> {
        if body.len() < FIXED_BODY_LEN {
            return Err(Error::malformed(format!(
                "header body of {} bytes, expected at least {FIXED_BODY_LEN}",
                body.len()
            )));
        }
        let flags = body[3];
        let known = FLAG_BOUNDS | FLAG_TREE | FLAG_REGION | FLAG_CHUNKED;
        let behind_tree = &body[148..region_place(kind).start.max(148)];
        let is_reserved_zero = body[4..8].iter().chain(behind_tree).all(|&byte| byte == 0);
        if body[2] > 1 || flags & !known != 0 || !is_reserved_zero {
            return Err(Error::malformed("header sets reserved bits"));
        }
        check_tree(kind, flags & FLAG_TREE != 0).map_err(Error::malformed)?;
        let floats = |range: std::ops::Range<usize>| -> Vec<f64> {
            body[range].chunks_exact(8).map(LE::read_f64).collect()
        };
        let triple = |at: usize| -> [f64; 3] { floats(at..at + 24).try_into().expect("three values") };
        let region = || {
            let sides = floats(region_place(kind));
            let (lower, upper) = sides.split_at(sides.len() / 2);
            Region::of_sides(lower, upper)
        };
        let coordinates = match body[0] {
            1 => Coordinates::F64,
            2 => Coordinates::I32 { scale: triple(16), offset: triple(40) },
            code => return Err(Error::malformed(format!("coordinate type {code}, expected 1 or 2"))),
        };
        let tree = (flags & FLAG_TREE != 0)
            .then(|| {
                let depth = u8::try_from(LE::read_u32(&body[144..])).ok();
                depth
                    .and_then(|depth| CellTree::new(body[1], depth, triple(112), LE::read_f64(&body[136..])))
                    .ok_or_else(|| Error::malformed("the finalization tree is out of range or not exact"))
            })
            .transpose()?;
        let (crs, producer) = decode_tail(body)?;
        let points = LE::read_u64(&body[8..]);
        let header = Header {
            kind,
            coordinates,
            dims: body[1],
            has_elevation: body[2] == 1,
            bounds: (flags & FLAG_BOUNDS != 0).then(|| Bounds { min: triple(64), max: triple(88) }),
            points: (points != COUNT_UNKNOWN).then_some(points),
            tree,
            region: (flags & FLAG_REGION != 0).then(region),
            chunked: flags & FLAG_CHUNKED != 0,
            crs,
            producer,
        };
        header.check().map_err(Error::malformed)?;
        Ok(header)
    }

    /// Checks the rules between fields; writer and reader share them.
    ///
    /// # Errors
    /// A text about the rule that is broken.
    pub fn check(&self) -> std::result::Result<(), String> {
        if !matches!((self.dims, self.has_elevation), (2 | 4, _) | (3, false)) {
            return Err(format!("{} dimensions with elevation {}", self.dims, self.has_elevation));
        }
        self.check_kind()?;
        if self.points == Some(COUNT_UNKNOWN) {
            return Err(format!("{COUNT_UNKNOWN} points are beyond counting, at most 2^64 - 2"));
        }
        if let Coordinates::I32 { scale, offset } = &self.coordinates
            && !scale.iter().zip(offset).all(|(&scale, &offset)| is_grid(scale, offset))
        {
            return Err("scale is not positive, or scale and offset are too far apart".into());
        }
        self.check_scales()?;
        if let Some(Bounds { min, max }) = &self.bounds {
            let ordered = (0..3).all(|axis| min[axis] <= max[axis]);
            let storable = min.iter().chain(max).all(|&value| self.coordinates.can_store(value));
            if !ordered || !storable {
                return Err("the bounding box is not ordered or not storable".into());
            }
            if self.coordinates_per_point() == 2 && (min[2], max[2]) != (0.0, 0.0) {
                return Err("the bounding box has a height, but the points have no z".into());
            }
            if self.tree.is_some_and(|tree| !(tree.contains(*min) && tree.contains(*max))) {
                return Err("the bounding box does not lie in the finalization tree".into());
            }
        }
        if let Some(tree) = &self.tree
            && (tree.dims() != self.dims || (self.dims == 2 && tree.origin()[2] != 0.0))
        {
            return Err("the finalization tree has other dimensions than the points".into());
        }
        check_tree(self.kind, self.tree.is_some())?;
        if self.chunked && (self.kind != Kind::Points || self.tree.is_none()) {
            return Err("only points with a finalization tree can be chunked".into());
        }
        self.check_region()
    }

    /// Checks that the axes of the geometry have one scale. Streams that nothing triangulates as they are
    /// stored, which are points without a finalization tree, may have several.
    fn check_scales(&self) -> std::result::Result<(), String> {
        let Coordinates::I32 { scale, .. } = &self.coordinates else { return Ok(()) };
        let is_free = self.kind == Kind::Points && self.tree.is_none();
        let geometry = &scale[..usize::from(self.dims).min(3)];
        if is_free || geometry.iter().all(|&scale| scale == geometry[0]) {
            return Ok(());
        }
        let scales: Vec<String> = geometry.iter().map(f64::to_string).collect();
        Err(format!(
            "the axes of the geometry have the scales {}, expected one scale: stored coordinates would be \
             triangulated out of shape (spfinalize puts points without a finalization tree on one grid)",
            scales.join(", ")
        ))
    }

    fn check_region(&self) -> std::result::Result<(), String> {
        if self.kind.is_partial() != self.region.is_some() {
            return Err("a region goes with a partial mesh, and only with one".into());
        }
        let Some(Region { min, max }) = &self.region else { return Ok(()) };
        if (0..3).any(|axis| min[axis].partial_cmp(&max[axis]) != Some(Ordering::Less)) {
            return Err("the region is empty or not a number".into());
        }
        if self.dims == 2 && (min[2], max[2]) != (f64::NEG_INFINITY, f64::INFINITY) {
            return Err("the region has sides in z, but the geometry has not".into());
        }
        Ok(())
    }

    /// Checks that the kind can have these dimensions.
    fn check_kind(&self) -> std::result::Result<(), String> {
        let (kind, dims) = (self.kind.name(), self.dims);
        if !self.kind.is_4d() {
            let has_dims = self.kind.dims().contains(&dims);
            return if has_dims { Ok(()) } else { Err(format!("a {kind} in {dims} dimensions")) };
        }
        if dims != 4 {
            return Err(format!("dims {dims} in a stream of kind {kind}, expected 4"));
        }
        if self.coordinates != Coordinates::F64 {
            return Err(format!("integer coordinates in a stream of kind {kind}, expected f64"));
        }
        if self.bounds.is_some() || self.tree.is_some() || self.region.is_some() || self.chunked {
            return Err(format!(
                "a stream of kind {kind} has no bounding box, tree or region, and is not chunked"
            ));
        }
        Ok(())
    }
}

/// The bytes of a header body that hold the region: lower sides, then upper sides. A region of space also
/// takes up the bytes of a tree.
fn region_place(kind: Kind) -> Range<usize> {
    if kind == Kind::PartialTetrahedralMesh { 136..184 } else { 152..184 }
}

/// Checks that the kind may have a finalization tree if there is one.
fn check_tree(kind: Kind, has_tree: bool) -> std::result::Result<(), String> {
    if has_tree && !kind.may_have_tree() {
        return Err(format!("a stream of kind {} has no finalization tree", kind.name()));
    }
    Ok(())
}

fn encode_crs(crs: &Crs) -> (u16, Vec<u8>) {
    match crs {
        Crs::Unknown => (0, Vec::new()),
        Crs::Wkt(text) => (1, text.clone().into_bytes()),
        Crs::GeoKeys { directory, doubles, ascii } => {
            let mut bytes = Vec::with_capacity(12 + directory.len() + doubles.len() + ascii.len());
            for record in [directory, doubles, ascii] {
                bytes.extend_from_slice(&(record.len() as u32).to_le_bytes());
                bytes.extend_from_slice(record);
            }
            (2, bytes)
        }
    }
}

/// Reads CRS and producer after the fixed part of the body.
fn decode_tail(body: &[u8]) -> Result<(Crs, String)> {
    let (producer_len, crs_len) =
        (usize::from(LE::read_u16(&body[186..])), LE::read_u32(&body[188..]) as usize);
    if body.len() - FIXED_BODY_LEN != crs_len + producer_len {
        return Err(Error::malformed("lengths of CRS and producer do not add up to the header's length"));
    }
    let (crs, producer) = body[FIXED_BODY_LEN..].split_at(crs_len);
    let text = |bytes: &[u8], what: &str| {
        String::from_utf8(bytes.to_vec()).map_err(|_| Error::malformed(format!("{what} is not UTF-8")))
    };
    let crs = match LE::read_u16(&body[184..]) {
        0 if crs.is_empty() => Crs::Unknown,
        1 => Crs::Wkt(text(crs, "CRS")?),
        2 => decode_geo_keys(crs).ok_or_else(|| Error::malformed("GeoKey records do not fit the CRS"))?,
        code => return Err(Error::malformed(format!("CRS encoding {code} with {crs_len} bytes"))),
    };
    Ok((crs, text(producer, "producer")?))
}

fn decode_geo_keys(mut bytes: &[u8]) -> Option<Crs> {
    let mut record = || {
        let (len, rest) = bytes.split_first_chunk::<4>()?;
        let (record, rest) = rest.split_at_checked(u32::from_le_bytes(*len) as usize)?;
        bytes = rest;
        Some(record.to_vec())
    };
    let (directory, doubles, ascii) = (record()?, record()?, record()?);
    bytes.is_empty().then_some(Crs::GeoKeys { directory, doubles, ascii })
}
