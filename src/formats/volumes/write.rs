//! Writes tetrahedra with a value at each vertex as VTU.

use std::io::Write;

use crate::sink::mesh::{Mesh, Shape, Table};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};
use spmesh_stream::model::bounds::Point;

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
    let value = values.map(|_| Attribute::new("value", NumberType::F64));
    let of_points = Table {
        attributes: Attributes::new(value.into_iter().collect()).map_err(Error::usage)?,
        rows: values.unwrap_or_default().iter().flat_map(|value| value.to_le_bytes()).collect(),
    };
    let (shape, corners) = (Shape::Tetrahedra, tetrahedra.as_flattened());
    Mesh { points, shape, corners, of_points, of_cells: Table::default() }.write_vtu(output)
}
