//! ESRI ASCII grids.

use std::io::Write;

use crate::raster::{Grid, NoData, RasterFile};
use spmesh_base::error::{Error, Result};

/// Writes rows as lines of text.
pub(super) fn write_rows(
    output: &mut impl Write,
    file: &RasterFile,
    mut row: impl FnMut(u32, &mut [f32]) -> Result<()>,
) -> Result<()> {
    let (Grid { left, step, columns, rows, .. }, no_data) = (file.grid, file.no_data());
    let bottom = file.grid.bottom();
    let header = format!(
        "ncols {columns}\nnrows {rows}\nxllcorner {left}\nyllcorner {bottom}\ncellsize {step}\nNODATA_value {no_data}\n"
    );
    output.write_all(header.as_bytes()).map_err(write_error)?;
    let mut values = vec![f32::NAN; columns as usize];
    for number in 0..rows {
        row(number, &mut values)?;
        let texts: Vec<String> =
            values.iter().map(|value| NoData(no_data.stored(*value)).to_string()).collect();
        writeln!(output, "{}", texts.join(" ")).map_err(write_error)?;
    }
    output.flush().map_err(write_error)
}

fn write_error(error: std::io::Error) -> Error {
    Error::io("writing", error)
}
