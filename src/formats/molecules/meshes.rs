//! Vertices of the tetrahedral meshes of this project as points, with their labels.

use std::io::{BufReader, Read};

use crate::detect::{self, Format};
use crate::molecules::model::Structure;
use crate::molecules::points;
use crate::source::checked::Checked;
use crate::source::events::EventSource;
use crate::twin::read::TwinSource;
use spmesh_base::error::Result;
use spmesh_stream::{Event, Kind, StreamReader};

/// Whether an input that starts with `head` is a tetrahedral mesh, as a stream or a text twin.
pub(crate) fn is_mesh(head: &[u8]) -> bool {
    let kind = match detect::detect(head) {
        Ok(Format::Stream) => StreamReader::new(head, "").map(|reader| reader.header().kind),
        Ok(Format::Twin) => TwinSource::new(head, "").map(|reader| reader.header().kind),
        _ => return false,
    };
    kind.is_ok_and(|kind| kind == Kind::TetrahedralMesh)
}

/// Reads the vertices of a mesh that starts with `head`. Messages call it `name`.
pub(crate) fn read(head: &[u8], input: impl Read + 'static, name: &str) -> Result<Structure> {
    let is_binary = matches!(detect::detect(head), Ok(Format::Stream));
    let mut source: Box<dyn EventSource> = if is_binary {
        Box::new(Checked::new(StreamReader::new(BufReader::new(input), name)?))
    } else {
        Box::new(Checked::new(TwinSource::new(input, name)?))
    };
    let coordinates = source.header().coordinates;
    let (mut vertices, mut labels, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    while let Some(event) = source.next_event()? {
        match event {
            Event::Patch(patch) => vertices.extend(patch.new),
            Event::Labels(next) => labels.extend(next),
            Event::End(totals) if totals.merged > 0 => {
                let merged = totals.merged;
                warnings.push(format!("{merged} coinciding points are one with others in the mesh"));
            }
            _ => {}
        }
    }
    let mut structure = points::structure(vertices, coordinates, name, warnings)?;
    structure.models[0].labels = labels;
    Ok(structure)
}
