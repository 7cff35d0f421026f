//! The header: kind, coordinates, and what the producer knows before the first block.

use std::cmp::Ordering;

use super::constraints::Constrained;
use super::coordinates::{Coordinates, is_grid};
use super::kind::Kind;
use super::part::PartName;
use super::weights::Weighted;
use crate::model::attributes::Attributes;
use crate::model::bounds::{Bounds, Region};
use crate::model::cells::CellTree;
use spmesh_base::limits::PRODUCER_LEN_MAX;

/// The number of points in the header when it is unknown.
pub(super) const COUNT_UNKNOWN: u64 = u64::MAX;

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
    /// Whether blocks may be compressed. A writer compresses those that become smaller; readers take both
    /// alike.
    pub compressed: bool,
    /// Coordinate reference system.
    pub crs: Crs,
    /// What points carry beside their coordinates. A program that makes a stream from another either passes
    /// attributes on or states none.
    pub attributes: Attributes,
    /// How a triangle mesh is constrained; `None` if it is not. A program that makes a mesh from another
    /// either passes segments and sides on or states none.
    pub constrained: Option<Constrained>,
    /// Whether points of space are weighted: a mesh is then the regular one. A program that makes a stream
    /// from another either passes weights on or states none.
    pub weighted: Option<Weighted>,
    /// Which part of a mesh in parts the stream is; `None` if it is none. A program that makes a stream from
    /// another either passes on what vertices parts share or states none.
    pub part: Option<PartName>,
    /// Program and version that wrote the stream.
    pub producer: String,
}

impl Header {
    /// A header of `kind` that states nothing else about the contents.
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
            compressed: false,
            crs: Crs::Unknown,
            attributes: Attributes::default(),
            constrained: None,
            weighted: None,
            part: None,
            producer: concat!("spmesh ", env!("CARGO_PKG_VERSION")).to_string(),
        }
    }

    /// Numbers stored per point: the dimensions, and one more for an elevation or a value.
    pub fn coordinates_per_point(&self) -> usize {
        usize::from(self.dims) + usize::from(self.has_elevation)
    }

    /// Bytes of one stored point.
    pub fn point_len(&self) -> usize {
        self.coordinates_per_point() * self.coordinates.width()
    }

    /// Bytes of a point with its row.
    pub fn record_len(&self) -> usize {
        self.point_len() + self.attributes.row_len()
    }

    /// Checks the rules between fields; writer and reader share them.
    ///
    /// # Errors
    /// A text about the rule that is broken.
    pub fn check(&self) -> std::result::Result<(), String> {
        self.check_dims()?;
        self.check_4d()?;
        if self.points == Some(COUNT_UNKNOWN) {
            return Err(format!("{COUNT_UNKNOWN} points are beyond counting, at most 2^64 - 2"));
        }
        if self.producer.len() > PRODUCER_LEN_MAX {
            let len = self.producer.len();
            return Err(format!("a producer of {len} bytes, the maximum is {PRODUCER_LEN_MAX}"));
        }
        if let Coordinates::I32 { scale, offset } = &self.coordinates
            && !scale.iter().zip(offset).all(|(&scale, &offset)| is_grid(scale, offset))
        {
            return Err("scale is not positive, or scale and offset are too far apart".into());
        }
        self.check_scales()?;
        self.check_bounds()?;
        if let Some(tree) = &self.tree
            && (tree.dims() != self.dims || (self.dims == 2 && tree.origin()[2] != 0.0))
        {
            return Err("the finalization tree has other dimensions than the points".into());
        }
        check_tree(self.kind, self.tree.is_some())?;
        if !self.attributes.is_empty() && !self.kind.may_have_attributes() {
            return Err(format!("a stream of kind {} has no attributes", self.kind.name()));
        }
        if let Some(constrained) = self.constrained {
            constrained.check(self.kind)?;
        }
        if let Some(weighted) = self.weighted {
            weighted.check(self)?;
        }
        match self.part {
            Some(part) => part.check(self)?,
            None if self.kind.is_residual() => return Err("a residual without the part that it is of".into()),
            None => {}
        }
        if self.chunked && (self.kind != Kind::Points || self.tree.is_none()) {
            return Err("only points with a finalization tree can be chunked".into());
        }
        self.check_region()
    }

    /// Checks that the kind can have these dimensions, with or without an elevation.
    pub(super) fn check_dims(&self) -> std::result::Result<(), String> {
        let (kind, dims) = (self.kind.name(), self.dims);
        if !matches!((dims, self.has_elevation), (2 | 4, _) | (3, false)) {
            return Err(format!("{dims} dimensions with elevation {}", self.has_elevation));
        }
        if self.kind.dims().contains(&dims) {
            return Ok(());
        }
        Err(if self.kind.is_4d() {
            format!("dims {dims} in a stream of kind {kind}, expected 4")
        } else {
            format!("a {kind} in {dims} dimensions")
        })
    }

    fn check_bounds(&self) -> std::result::Result<(), String> {
        let Some(Bounds { min, max }) = &self.bounds else { return Ok(()) };
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
        Ok(())
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
        if self.kind.has_region() != self.region.is_some() {
            return Err("a region goes with a partial mesh or a residual, and only with one".into());
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

    /// Checks what the header of points in four dimensions cannot state.
    fn check_4d(&self) -> std::result::Result<(), String> {
        let kind = self.kind.name();
        if !self.kind.is_4d() {
            return Ok(());
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

/// Checks that the kind may have a finalization tree if there is one.
pub(super) fn check_tree(kind: Kind, has_tree: bool) -> std::result::Result<(), String> {
    if has_tree && !kind.may_have_tree() {
        return Err(format!("a stream of kind {} has no finalization tree", kind.name()));
    }
    Ok(())
}
