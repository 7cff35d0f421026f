//! ESRI ASCII grids.

use std::io::Write;

use super::{Grid, NO_DATA};
use crate::error::{Error, Result};

/// Writes rows as lines of text.
pub(super) fn write_rows(
    output: &mut impl Write,
    grid: &Grid,
    mut row: impl FnMut(u32, &mut [f32]) -> Result<()>,
) -> Result<()> {
    let Grid { left, step, columns, rows, .. } = grid;
    let bottom = grid.bottom();
    let header = format!(
        "ncols {columns}\nnrows {rows}\nxllcorner {left}\nyllcorner {bottom}\ncellsize {step}\nNODATA_value {NO_DATA}\n"
    );
    output.write_all(header.as_bytes()).map_err(write_error)?;
    let mut values = vec![f32::NAN; *columns as usize];
    for number in 0..*rows {
        row(number, &mut values)?;
        let known = values.iter().map(|value| if value.is_nan() { NO_DATA } else { *value });
        let texts: Vec<String> = known.map(|value| value.to_string()).collect();
        writeln!(output, "{}", texts.join(" ")).map_err(write_error)?;
    }
    output.flush().map_err(write_error)
}

fn write_error(error: std::io::Error) -> Error {
    Error::io("writing", error)
}
