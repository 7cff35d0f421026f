//! Writes products that are not streams.

use std::io::Write;

use crate::slices::{Slice, Surface};
use spmesh_base::error::{Error, Result};
use spmesh_formats::drivers::Format;
use spmesh_formats::sink::{SinkOptions, surface_header, write_volume};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, Totals};

/// Writes sites with their values as lines of x, y, z, t and value, separated by tabs, below a line of names.
/// Values outside the hull and unknown values are `nan`.
///
/// # Errors
/// If writing fails.
pub fn write_values(sites: &[Point4], values: &[Option<f64>], output: &mut impl Write) -> Result<()> {
    let mut write = || -> std::io::Result<()> {
        output.write_all(b"x\ty\tz\tt\tvalue\n")?;
        for ([x, y, z, t], value) in sites.iter().zip(values) {
            write!(output, "{x}\t{y}\t{z}\t{t}\t")?;
            match value.filter(|value| !value.is_nan()) {
                Some(value) => writeln!(output, "{value}")?,
                None => output.write_all(b"nan\n")?,
            }
        }
        output.flush()
    };
    write().map_err(|e| Error::io("writing", e))
}

/// Writes a slice as VTU, with its values, or as Medit's text without them. Returns notices for the user.
///
/// # Errors
/// Usage, if the format is another one; I/O.
pub fn write_slice(slice: &Slice, format: Format, output: &mut impl Write) -> Result<Vec<String>> {
    let Slice { points, values, tetrahedra, .. } = slice;
    match format {
        Format::VtkXml => write_volume(output, points, values.as_deref(), tetrahedra)?,
        Format::Medit => {
            let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
            write_mesh(format, &header, points, tetrahedra, output)?;
        }
        _ => {
            return Err(Error::usage("a slice has to be written as VTU (.vtu) or Medit (.mesh)"));
        }
    }
    let has_lost = values.is_some() && format == Format::Medit;
    Ok(has_lost
        .then(|| "Medit's meshes hold no values: dropped; VTU (.vtu) has them".into())
        .into_iter()
        .collect())
}

/// Writes a surface as PLY, OBJ, VTU or Medit's text.
///
/// # Errors
/// Usage, if the format is another one; I/O.
pub fn write_surface(surface: &Surface, format: Format, output: &mut impl Write) -> Result<()> {
    let header = surface_header(&Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false));
    write_mesh(format, &header, &surface.points, &surface.triangles, output)
}

/// Writes a mesh as one patch.
fn write_mesh<const N: usize>(
    format: Format,
    header: &Header,
    points: &[Point],
    simplices: &[[u32; N]],
    output: &mut impl Write,
) -> Result<()> {
    let mut sink = format.open_sink(output, header, &SinkOptions::default())?;
    let (vertices, count) = (points.len() as u64, simplices.len() as u64);
    let corners = simplices.as_flattened().to_vec();
    sink.event(&Event::Patch(Patch { new: points.to_vec(), simplices: corners, ..Patch::default() }), &[])?;
    sink.event(&Event::End(Totals { vertices, simplices: count, ..Totals::default() }), &[])
}
