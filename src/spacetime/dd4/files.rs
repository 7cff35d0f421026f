//! Writes products that are not streams.

use std::io::Write;

use crate::slices::{Slice, Surface};
use spmesh_base::error::{Error, Result};
use spmesh_formats::sink::{
    EventSink, MeditSink, ObjSink, PlyEncoding, PlySink, VtuSink, surface_header, write_volume,
};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, Totals};

/// File formats of meshes in space, other than streams.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// VTK's XML: volumes with values, surfaces.
    Vtu,
    /// Medit's text: volumes without values, surfaces.
    Medit,
    /// Binary PLY: surfaces.
    Ply,
    /// OBJ: surfaces.
    Obj,
}

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
pub fn write_slice(slice: &Slice, form: Form, output: &mut impl Write) -> Result<Vec<String>> {
    let Slice { points, values, tetrahedra, .. } = slice;
    match form {
        Form::Vtu => write_volume(output, points, values.as_deref(), tetrahedra)?,
        Form::Medit => {
            let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
            let sink = MeditSink::new(output, &header, None)?;
            feed(sink, points, tetrahedra.as_flattened(), tetrahedra.len())?;
        }
        Form::Ply | Form::Obj => {
            return Err(Error::usage("a slice has to be written as VTU (.vtu) or Medit (.mesh)"));
        }
    }
    let has_lost = values.is_some() && form == Form::Medit;
    Ok(has_lost
        .then(|| "Medit's meshes hold no values: dropped; VTU (.vtu) has them".into())
        .into_iter()
        .collect())
}

/// Writes a surface as PLY, OBJ, VTU or Medit's text.
///
/// # Errors
/// Usage, if the format is another one; I/O.
pub fn write_surface(surface: &Surface, form: Form, output: &mut impl Write) -> Result<()> {
    let header = surface_header(&Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false));
    let Surface { points, triangles } = surface;
    let (corners, count) = (triangles.as_flattened(), triangles.len());
    match form {
        Form::Ply => feed(PlySink::new(output, &header, PlyEncoding::Binary, None)?, points, corners, count),
        Form::Obj => feed(ObjSink::new(output, &header)?, points, corners, count),
        Form::Vtu => feed(VtuSink::new(output, &header, None)?, points, corners, count),
        Form::Medit => feed(MeditSink::new(output, &header, None)?, points, corners, count),
    }
}

/// Passes a mesh to a sink as one patch.
fn feed(mut sink: impl EventSink, points: &[Point], corners: &[u32], count: usize) -> Result<()> {
    let patch = Patch { new: points.to_vec(), simplices: corners.to_vec(), ..Patch::default() };
    sink.event(&Event::Patch(patch), &[])?;
    let totals = Totals { vertices: points.len() as u64, simplices: count as u64, ..Totals::default() };
    sink.event(&Event::End(totals), &[])
}
