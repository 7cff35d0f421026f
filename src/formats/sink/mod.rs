//! Writers of every format that a stream can be converted to. Their input is the events of a stream.
//! Tables, and arrays and sparse matrices for numpy, get their rows from their caller.

pub(crate) mod constrained;
pub(crate) mod elements;
pub(crate) mod floats;
pub(crate) mod hull;
pub(crate) mod mesh;
pub(crate) mod rows;
pub(crate) mod spm;
pub(crate) mod spool;
pub(crate) mod triangles;
pub(crate) mod world;

pub use crate::npy::sparse_matrix::{MatrixFormat, SparseRows};
pub use crate::npy::write::{NPY_F64, NpyRows, npy_header};
pub use crate::tables::{Column, ColumnKind, TableFormat, TableSink};
pub use crate::twin::write::TwinSink;
pub use crate::volumes::write::write_volume;
pub(crate) use hull::HullSink;
pub use hull::surface_header;
pub use mesh::{Mesh, Shape, Table};
pub use spm::SpmSink;

use std::path::PathBuf;

use crate::crs;
use crate::historical::write_cells::HistoricalCells;
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Coordinates, Crs, Event, Header, Kind};

/// How a format is written.
#[derive(Debug, Clone, Default)]
pub struct SinkOptions {
    /// Write PLY as text.
    pub ascii: bool,
    /// Write coordinates of OBJ, DXF and LandXML as differences from an origin in the middle.
    pub local_origin: bool,
    /// Compress the blocks of a stream.
    pub compress: bool,
    /// Where spools go; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// An output that takes the events of a stream, whatever its format.
pub trait EventSink {
    /// Writes an event. `rows` are the attributes of its points; empty if the header lists none. The last
    /// event is [`Event::End`]; after it the output is complete and flushed.
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()>;

    /// Notices for the user about what the format could not hold. Complete after the end.
    fn notices(&self) -> Vec<String>;
}

pub(crate) fn write_error(cause: std::io::Error) -> Error {
    Error::io("writing", cause)
}

/// Rejects a stream of a kind that `format` does not hold.
pub(crate) fn expect_kind(header: &Header, format: &str, kinds: &[Kind]) -> Result<()> {
    if kinds.contains(&header.kind) {
        return Ok(());
    }
    let held: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
    let remedy = match header.kind {
        Kind::TetrahedralMesh => ": write it as VTU or Medit, or its hull as OBJ, PLY, STL or glTF",
        _ => "",
    };
    Err(Error::usage(format!(
        "a stream of kind {} cannot be written as {format}, which holds {}{remedy}",
        header.kind.name(),
        held.join(" or ")
    )))
}

/// Notices about header fields that the format cannot hold.
pub(crate) fn lost_of_header(header: &Header, format: &str) -> Vec<String> {
    let crs = (header.crs != Crs::Unknown).then(|| format!("{format} holds no CRS: dropped"));
    crs.into_iter().chain(lost_beside_crs(header, format)).collect()
}

/// The same for a format that gets the CRS as text.
pub(crate) fn lost_where_crs_is_text(header: &Header, format: &str) -> Vec<String> {
    match crs::text(&header.crs) {
        Some(_) => lost_beside_crs(header, format),
        None => lost_of_header(header, format),
    }
}

fn lost_beside_crs(header: &Header, format: &str) -> Vec<String> {
    let is_grid = header.coordinates != Coordinates::F64;
    let grid = is_grid.then(|| {
        format!(
            "{format} holds no integer grid: coordinates are rounded to the nearest number of 64 bits or less"
        )
    });
    let segments =
        header.constrained.map(|_| format!("{format} holds no segments: the mesh is written without them"));
    grid.into_iter().chain(segments).collect()
}

/// Notices about scales and unknown numbers of attributes, in a format that holds the stored numbers.
pub(crate) fn lost_of_attributes(header: &Header, format: &str) -> Vec<String> {
    let scaled = header.attributes.iter().filter_map(|attribute| {
        let [scale, offset] = attribute.scale?;
        let name = &attribute.name;
        Some(format!(
            "{format} holds no scale: {name} is the stored number, its value is number * {scale} + {offset}"
        ))
    });
    let unknown = header.attributes.iter().filter_map(|attribute| {
        let number = attribute.number.read(attribute.unknown.as_ref()?);
        Some(format!("{format} has no unknown values: {number} stands for them in {}", attribute.name))
    });
    scaled.chain(unknown).collect()
}

/// The notice about the attributes of a format that holds none.
pub(crate) fn lost_attributes(header: &Header, format: &str) -> Option<String> {
    let attributes = &header.attributes;
    (!attributes.is_empty()).then(|| format!("{format} holds no attributes: {} dropped", attributes.names()))
}

/// Notices about what a historical points format cannot hold.
pub(crate) fn lost_of_points(header: &Header, format: &str, cells: Option<&HistoricalCells>) -> Vec<String> {
    let mut lost = lost_of_header(header, format);
    lost.extend(lost_attributes(header, format));
    match cells {
        None if header.tree.is_some() => {
            lost.push(format!("{format} cannot say the cells of this tree: finalization tags dropped"));
        }
        Some(cells) if cells.skipped() > 0 => lost.push(format!(
            "{} finalization tags dropped: their cells are too deep for {format}",
            cells.skipped()
        )),
        _ => {}
    }
    lost
}
