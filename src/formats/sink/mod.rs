//! Writers of every format that a stream can be converted to. Their input is the events of a stream.
//! Tables, and arrays and sparse matrices for numpy, get their rows from their caller.

mod constrained;
mod constraint_geojson;
mod dxf;
mod elements;
mod historical_cells;
mod hull;
mod landxml;
mod medit;
mod mesh;
mod npy;
mod obj;
mod ply;
mod ply_properties;
mod rows;
mod sma;
mod smb;
mod spa;
mod sparse_matrix;
mod spb;
mod spm;
mod spool;
mod table;
mod triangles;
mod twin;
mod twin4;
mod twin_configurations;
mod twin_constraints;
mod twin_functions;
mod volume;
mod vtu;
mod world;

pub use constraint_geojson::GeoJsonSink;
pub use dxf::DxfSink;
pub use hull::{HullSink, surface_header};
pub use landxml::LandXmlSink;
pub use medit::MeditSink;
pub use mesh::{Mesh, Shape, Table};
pub use npy::{NPY_F64, NpyRows, npy_header};
pub use obj::ObjSink;
pub use ply::{PlyEncoding, PlySink};
pub use sma::SmaSink;
pub use smb::SmbSink;
pub use spa::SpaSink;
pub use sparse_matrix::{MatrixFormat, SparseRows};
pub use spb::SpbSink;
pub use spm::SpmSink;
pub use table::{Column, ColumnKind, TableFormat, TableSink};
pub use twin::TwinSink;
pub use volume::write_volume;
pub use vtu::VtuSink;

use historical_cells::HistoricalCells;
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Coordinates, Crs, Event, Header, Kind};

/// An output that takes the events of a stream, whatever its format.
pub trait EventSink {
    /// Writes an event. `rows` are the attributes of its points; empty if the header lists none. The last
    /// event is [`Event::End`]; after it the output is complete and flushed.
    ///
    /// # Errors
    /// If the format cannot express the event, or writing fails.
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()>;

    /// Notices for the user about what the format could not hold. Complete after the end.
    fn notices(&self) -> Vec<String>;
}

fn write_error(cause: std::io::Error) -> Error {
    Error::io("writing", cause)
}

/// Rejects a stream of a kind that `format` does not hold.
fn expect_kind(header: &Header, format: &str, kinds: &[Kind]) -> Result<()> {
    if kinds.contains(&header.kind) {
        return Ok(());
    }
    let held: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
    Err(Error::usage(format!(
        "a stream of kind {} cannot be written as {format}, which holds {}",
        header.kind.name(),
        held.join(" or ")
    )))
}

/// Notices about header fields that the format cannot hold.
fn lost_of_header(header: &Header, format: &str) -> Vec<String> {
    let crs = (header.crs != Crs::Unknown).then(|| format!("{format} holds no CRS: dropped"));
    let is_grid = header.coordinates != Coordinates::F64;
    let grid = is_grid.then(|| {
        format!(
            "{format} holds no integer grid: coordinates are rounded to the nearest number of 64 bits or less"
        )
    });
    let segments =
        header.constrained.map(|_| format!("{format} holds no segments: the mesh is written without them"));
    crs.into_iter().chain(grid).chain(segments).collect()
}

/// Notices about scales and unknown numbers of attributes, in a format that holds the stored numbers.
fn lost_of_attributes(header: &Header, format: &str) -> Vec<String> {
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
fn lost_attributes(header: &Header, format: &str) -> Option<String> {
    let attributes = &header.attributes;
    (!attributes.is_empty()).then(|| format!("{format} holds no attributes: {} dropped", attributes.names()))
}

/// Notices about what a historical points format cannot hold.
fn lost_of_points(header: &Header, format: &str, cells: Option<&HistoricalCells>) -> Vec<String> {
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
