//! Writes tetrahedra with a value at each vertex as VTU.

use std::io::Write;

use super::vtu::{Cells, Content, Data, END, arrays, head};
use super::write_error;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::Point;

/// Writes tetrahedra as VTU, with the values of points as the point data `value`, and flushes.
///
/// # Errors
/// Usage, if there is not one value for each point; I/O.
pub fn write_volume(
    output: &mut impl Write,
    points: &[Point],
    values: Option<&[f64]>,
    tetrahedra: &[[u32; 4]],
) -> Result<()> {
    if let Some(values) = values
        && values.len() != points.len()
    {
        return Err(Error::usage(format!("{} values for {} points", values.len(), points.len())));
    }
    let (vertices, count) = (points.len() as u64, tetrahedra.len() as u64);
    let cells = Cells { vertices, cells: count, corners: 4, code: 10 };
    let arrays = arrays(&cells, values.map(|_| Data::values()).as_slice());
    let mut put = |bytes: &[u8]| output.write_all(bytes).map_err(write_error);
    put(head(&cells, &arrays).as_bytes())?;
    for array in &arrays {
        put(&array.len.to_le_bytes())?;
        match array.content {
            Content::Data(_) => {
                values.unwrap_or_default().iter().try_for_each(|value| put(&value.to_le_bytes()))?;
            }
            Content::Vertices => points.as_flattened().iter().try_for_each(|x| put(&x.to_le_bytes()))?,
            Content::Connectivity => {
                let mut corners = tetrahedra.as_flattened().iter();
                corners.try_for_each(|&corner| put(&u64::from(corner).to_le_bytes()))?;
            }
            Content::Offsets => (1..=count).try_for_each(|cell| put(&(4 * cell).to_le_bytes()))?,
            Content::Types => (0..count).try_for_each(|_| put(&[cells.code]))?,
        }
    }
    put(END)?;
    output.flush().map_err(write_error)
}
