//! Points from streams of this project and their text twins, whose cell tags are checked, but not used; and
//! the vertices of PLY and OBJ.

use std::io::BufReader;

use crate::obj::read::{self as obj, ObjVertices};
use crate::ply::read::{self as ply, PlyVertices};
use crate::source::checked::Checked;
use crate::source::events::EventSource;
use crate::source::origin::Bytes;
use crate::source::pass::{Pass, Stated};
use crate::source::placement::Placement;
use crate::source::row_plan::{RowPlan, offers_of};
use crate::source::vertices::VertexPoints;
use crate::twin::read::TwinSource;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::Attribute;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Header, Kind, StreamReader, Weighted};

/// Reads the header of a stream.
pub(crate) fn state(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&StreamReader::new(BufReader::new(file), name)?)
}

/// Reads the header of a text twin.
pub(crate) fn state_of_twin(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&TwinSource::new(file, name)?)
}

/// Reads the header of a PLY, whose vertices are the points.
pub(crate) fn state_of_ply(file: Bytes, name: &str) -> Result<Stated> {
    state_of(&ply::open_vertices(file, name)?)
}

/// What is known of an OBJ, whose vertices are the points, before it is read.
pub(crate) fn state_of_obj(file: Bytes, name: &str) -> Result<Stated> {
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
        crs: header.crs.clone().into(),
        bounds: header.bounds,
        points: header.points,
        offers: offers_of(&attributes_of(header)).into(),
    })
}

/// The attributes of the points. Weights are in squared stored units, so they get a scale.
fn attributes_of(header: &Header) -> Vec<Attribute> {
    let mut attributes: Vec<Attribute> = header.attributes.iter().cloned().collect();
    let weight = Weighted::attribute();
    if let (Some(_), Coordinates::I32 { scale, .. }) = (header.weighted, header.coordinates) {
        let of_weights = attributes.iter_mut().filter(|attribute| attribute.name == weight.name);
        of_weights.for_each(|attribute| attribute.scale = Some([scale[0] * scale[0], 0.0]));
    }
    attributes
}

/// One pass over the points of a stream, of a text twin, or of a mesh.
pub(crate) struct EventPass<S> {
    source: S,
    plan: RowPlan,
    row_len: usize,
}

impl<S: EventSource> EventPass<S> {
    /// A pass over `source` with the rows of `plan`.
    fn new(source: S, plan: RowPlan) -> Self {
        let row_len = source.header().attributes.row_len();
        EventPass { source, plan, row_len }
    }
}

/// Starts a pass over a stream.
pub(crate) fn pass(
    file: Bytes,
    name: &str,
    plan: RowPlan,
) -> Result<EventPass<Checked<StreamReader<BufReader<Bytes>>>>> {
    let reader = StreamReader::new(BufReader::with_capacity(1 << 18, file), name)?;
    Ok(EventPass::new(Checked::new(reader), plan))
}

/// Starts a pass over a text twin.
pub(crate) fn pass_of_twin(
    file: Bytes,
    name: &str,
    plan: RowPlan,
) -> Result<EventPass<Checked<TwinSource<Bytes>>>> {
    Ok(EventPass::new(Checked::new(TwinSource::new(file, name)?), plan))
}

/// Starts a pass over the vertices of a PLY.
pub(crate) fn pass_of_ply(
    file: Bytes,
    name: &str,
    plan: RowPlan,
) -> Result<EventPass<VertexPoints<PlyVertices<Bytes>>>> {
    Ok(EventPass::new(ply::open_vertices(file, name)?, plan))
}

/// Starts a pass over the vertices of an OBJ.
pub(crate) fn pass_of_obj(file: Bytes, name: &str) -> EventPass<VertexPoints<ObjVertices<Bytes>>> {
    EventPass::new(obj::open_vertices(file, name), RowPlan::default())
}

impl<S: EventSource + Send> Pass for EventPass<S> {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
        while let Some(event) = self.source.next_event()? {
            if let Event::Points(points) = event {
                for (number, point) in points.into_iter().enumerate() {
                    let is_put = placement.put(point, batch).map_err(|error| self.source.locate(error))?;
                    if is_put && !self.plan.is_empty() {
                        let row = &self.source.rows()[number * self.row_len..][..self.row_len];
                        self.plan.append(row, rows);
                    }
                }
                return Ok(true);
            }
        }
        Ok(false)
    }
}
