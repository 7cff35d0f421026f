//! Points from streams of this project and their text twins, whose cell tags are checked, but not used; and
//! the vertices of PLY and OBJ.

use std::io::BufReader;

use super::checked::Checked;
use super::events::EventSource;
use super::obj::{self, ObjVertices};
use super::origin::Bytes;
use super::pass::{Pass, Stated};
use super::placement::Placement;
use super::ply::{self, PlyVertices};
use super::twin::TwinSource;
use super::vertices::VertexPoints;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::Point;
use spmesh_stream::{Event, Kind, StreamReader};

/// Reads the header of a stream.
pub(super) fn state(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&StreamReader::new(BufReader::new(file), name)?)
}

/// Reads the header of a text twin.
pub(super) fn state_of_twin(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&TwinSource::new(file, name)?)
}

/// Reads the header of a PLY, whose vertices are the points.
pub(super) fn state_of_ply(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&ply::open_vertices(file, name)?)
}

/// What is known of an OBJ, whose vertices are the points, before it is read.
pub(super) fn state_of_obj(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&obj::open_vertices(file, name))
}

fn state_of(source: &impl EventSource) -> Result<Stated> {
    let header = source.header();
    if header.kind != Kind::Points {
        return Err(Error::usage(format!("is a stream of kind {}, expected points", header.kind.name())));
    }
    Ok(Stated {
        coordinates: header.coordinates,
        has_z: Some(header.dims == 3 || header.has_elevation),
        crs: header.crs.clone(),
        bounds: header.bounds,
        points: header.points,
    })
}

/// One pass over the points of a stream, of a text twin, or of a mesh.
pub(super) struct EventPass<S>(S);

/// Starts a pass over a stream.
pub(super) fn pass(file: Bytes, name: &str) -> Result<EventPass<Checked<StreamReader<BufReader<Bytes>>>>> {
    let reader = StreamReader::new(BufReader::with_capacity(1 << 18, file), name)?;
    Ok(EventPass(Checked::new(reader)))
}

/// Starts a pass over a text twin.
pub(super) fn pass_of_twin(file: Bytes, name: &str) -> Result<EventPass<Checked<TwinSource<Bytes>>>> {
    Ok(EventPass(Checked::new(TwinSource::new(file, name)?)))
}

/// Starts a pass over the vertices of a PLY.
pub(super) fn pass_of_ply(file: Bytes, name: &str) -> Result<EventPass<VertexPoints<PlyVertices<Bytes>>>> {
    ply::open_vertices(file, name).map(EventPass)
}

/// Starts a pass over the vertices of an OBJ.
pub(super) fn pass_of_obj(file: Bytes, name: &str) -> EventPass<VertexPoints<ObjVertices<Bytes>>> {
    EventPass(obj::open_vertices(file, name))
}

impl<S: EventSource + Send> Pass for EventPass<S> {
    fn next_batch(&mut self, placement: &mut Placement, batch: &mut Vec<Point>) -> Result<bool> {
        while let Some(event) = self.0.next_event()? {
            if let Event::Points(points) = event {
                let put = points.into_iter().try_for_each(|point| placement.put(point, batch));
                put.map_err(|error| self.0.locate(error))?;
                return Ok(true);
            }
        }
        Ok(false)
    }
}
