//! Writes diagrams as streams.

use std::io::Write;

use crate::slices::Subdivision;
use spmesh_base::error::Result;
use spmesh_stream::model::cells4::Cell4;
use spmesh_stream::model::diagram4::Diagram4;
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter};

/// Writes the diagram as a stream of cells, whose blocks may be compressed.
///
/// # Errors
/// If writing fails.
pub fn write_diagram(diagram: &Diagram4, compress: bool, output: impl Write) -> Result<()> {
    write_cells(diagram, compress, output, |give| diagram.cells.iter().try_for_each(give))
}

/// The same with the cells that `each` gives to the function that writes them.
pub(super) fn write_cells(
    diagram: &Diagram4,
    compress: bool,
    output: impl Write,
    each: impl FnOnce(&mut dyn FnMut(Cell4) -> Result<()>) -> Result<()>,
) -> Result<()> {
    let Diagram4 { points, values, merged, .. } = diagram;
    let count = points.len() as u64 + merged;
    let header = Header { compressed: compress, ..header(Kind::Cells4, values.is_some(), count) };
    let mut writer = StreamWriter::new(output, header)?;
    writer.points4(points, values.as_deref())?;
    each(&mut |cell| writer.cell4(cell))?;
    writer.end(count, *merged).map(drop)
}

/// Writes a subdivision as a stream of simplices, whose blocks may be compressed. Barycentres count as points of the input, after which come
/// `merged`.
///
/// # Errors
/// If a value is infinite, or writing fails.
pub fn write_simplices(parts: &Subdivision, merged: u64, compress: bool, output: impl Write) -> Result<()> {
    let Subdivision { points, values, simplices, .. } = parts;
    let count = points.len() as u64 + merged;
    let header = Header { compressed: compress, ..header(Kind::Simplices4, values.is_some(), count) };
    let mut writer = StreamWriter::new(output, header)?;
    writer.points4(points, values.as_deref())?;
    writer.simplices4(simplices)?;
    writer.end(count, merged).map(drop)
}

/// The header of a stream made of `count` points.
fn header(kind: Kind, has_values: bool, count: u64) -> Header {
    Header {
        points: Some(count),
        producer: concat!("dd4 ", env!("CARGO_PKG_VERSION")).to_string(),
        ..Header::new(kind, Coordinates::F64, 4, has_values)
    }
}
