//! Points from streams of this project and their text twins, whose cell tags are checked, but not used; and
//! the vertices of PLY and OBJ.

use crate::drivers::{Events, OpenEvents};
use crate::source::pass::{Content, Opening, Pass, Stated};
use crate::source::placement::Placement;
use crate::source::row_plan::{RowPlan, offers_of};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::Attribute;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Header, Kind, Weighted};

/// Opens a file of points whose events `open` reads.
pub(crate) fn open(file: &Opening, open: OpenEvents, is_costly: bool) -> Result<Content> {
    let events = move |file: &Opening| open(Box::new(file.origin.plain()?), file.name, 3);
    let stated = state_of(events(file)?.header())?;
    let content =
        Content::new(stated, move |file, plan| Ok(Box::new(EventPass { source: events(file)?, plan })));
    Ok(Content { is_costly, ..content })
}

fn state_of(header: &Header) -> Result<Stated> {
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
struct EventPass {
    source: Events,
    plan: RowPlan,
}

impl Pass for EventPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
        while let Some(event) = self.source.next_event()? {
            if let Event::Points(points) = event {
                let row_len = self.source.header().attributes.row_len();
                for (number, point) in points.into_iter().enumerate() {
                    let is_put = placement.put(point, batch).map_err(|error| self.source.locate(error))?;
                    if is_put && !self.plan.is_empty() {
                        let row = &self.source.rows()[number * row_len..][..row_len];
                        self.plan.append(row, rows);
                    }
                }
                return Ok(true);
            }
        }
        Ok(false)
    }
}
