//! Diagrams to streams.

use crate::diagram4::Diagram;
use crate::error::Result;
use crate::output::Output;
use crate::stream::{Coordinates, Header, Kind, StreamWriter};

/// Writes the diagram as a stream of cells; says how many bytes that are.
///
/// # Errors
/// If writing fails.
pub fn write_diagram(diagram: &Diagram, output: Output) -> Result<u64> {
    let Diagram { points, values, merged, cells } = diagram;
    let count = points.len() as u64 + merged;
    let mut header = Header::new(Kind::Cells4, Coordinates::F64, 4, values.is_some());
    header.points = Some(count);
    header.producer = concat!("dd4 ", env!("CARGO_PKG_VERSION")).to_string();
    let mut writer = StreamWriter::new(output, header)?;
    writer.points4(points, values.as_deref())?;
    cells.iter().try_for_each(|cell| writer.cell4(cell))?;
    let output = writer.end(count, *merged)?;
    let bytes = output.bytes_written();
    output.commit()?;
    Ok(bytes)
}
