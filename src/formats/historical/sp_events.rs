//! Converts files of the historical point formats SPA and SPB to the events of a stream.

use crate::drivers::Events;
use crate::historical::sp::{SpEvent, SpFinalization, SpReader};
use crate::historical::sp_cells::{cell_of, check_end, tree_of};
use crate::source::events::EventSource;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, FinalizedCells, Header, Kind, check_place};

/// Greatest number of points or tags of an event.
const BATCH_MAX: usize = 4096;

/// An SPA or SPB file as a points stream, in world coordinates.
///
/// Finalization tags are kept if the bounding box of the file, which is halved into cells, is the cube of an
/// exact finalization tree; otherwise they are dropped, with a notice. Tags of cells that are already final
/// are redundant and dropped too.
pub(crate) struct SpEvents<S> {
    reader: S,
    name: String,
    header: Header,
    cells: Option<FinalizedCells>,
    held: Option<SpEvent>,
    /// The last point.
    last: Option<Point>,
    totals: spmesh_stream::Totals,
    dropped: u64,
    ended: bool,
}

impl<S: SpReader + Send + 'static> SpEvents<S> {
    /// Events of `reader`, which messages call `name`. The finalization method decides the dimensions of the
    /// points; without a tree they have `dims` dimensions. With 2, z is an elevation.
    pub(crate) fn open(reader: Result<S>, name: &str, dims: u8) -> Result<Events> {
        let reader = reader.map_err(|e| e.of_input(name))?;
        let dims = match reader.header().finalization {
            SpFinalization::QuadTree => 2,
            SpFinalization::OctTree => 3,
            _ => dims,
        };
        let mut header = Header::new(Kind::Points, Coordinates::F64, dims, dims == 2);
        header.tree = tree_of(reader.header());
        header.points = reader.header().points;
        Ok(Box::new(SpEvents {
            reader,
            name: name.into(),
            cells: header.tree.map(FinalizedCells::new),
            header,
            held: None,
            last: None,
            totals: spmesh_stream::Totals::default(),
            dropped: 0,
            ended: false,
        }))
    }

    /// The next event that is not dropped.
    fn next_kept(&mut self) -> Result<Option<SpEvent>> {
        if let Some(event) = self.held.take() {
            return Ok(Some(event));
        }
        while let Some(event) = self.reader.next_event()? {
            match (event, &self.cells) {
                (SpEvent::Point(_), _) => return Ok(Some(event)),
                (SpEvent::FinalizedCell(index), Some(cells)) => {
                    if !cells.is_final_cell(cell_of(index, cells.tree())?) {
                        return Ok(Some(event));
                    }
                }
                (SpEvent::FinalizedCell(_), None) => self.dropped += 1,
            }
        }
        Ok(None)
    }

    fn check_point(&mut self, point: Point) -> Result<()> {
        if let Some(x) = point.iter().find(|x| !x.is_finite()) {
            return Err(Error::malformed(format!("coordinate {x}")));
        }
        check_place(&self.header, point)?;
        self.cells.as_mut().map_or(Ok(()), |cells| cells.check_point(point))
    }

    fn advance(&mut self) -> Result<Event> {
        let mut points = Vec::new();
        let mut tags = Vec::new();
        while points.len() < BATCH_MAX && tags.len() < BATCH_MAX {
            match self.next_kept()? {
                Some(SpEvent::Point(point)) if tags.is_empty() => {
                    self.check_point(point)?;
                    points.push(point);
                }
                Some(SpEvent::FinalizedCell(index)) if points.is_empty() => {
                    let cells = self.cells.as_mut().expect("tags are kept with a tree only");
                    let cell = cell_of(index, cells.tree())?;
                    cells.finalize(cell)?;
                    tags.push(cell);
                }
                Some(other) => {
                    self.held = Some(other);
                    break;
                }
                None => break,
            }
        }
        self.last = points.last().copied().or(self.last);
        self.totals.points += points.len() as u64;
        self.totals.cells += tags.len() as u64;
        if !points.is_empty() {
            return Ok(Event::Points(points));
        }
        if !tags.is_empty() {
            return Ok(Event::Cells(tags));
        }
        check_end(self.cells.as_ref(), self.last)?;
        self.ended = true;
        Ok(Event::End(self.totals))
    }
}

impl<S: SpReader + Send + 'static> EventSource for SpEvents<S> {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        if self.ended {
            return Ok(None);
        }
        self.advance().map(Some).map_err(|e| self.locate(e))
    }

    fn locate(&self, error: Error) -> Error {
        error.at(self.reader.position()).of_input(&self.name)
    }

    fn notices(&self) -> Vec<String> {
        let notice = format!(
            "{} finalization tags dropped: their cells are not those of an exact tree; pipe the points \
             through \
             spfinalize",
            self.dropped
        );
        (self.dropped > 0).then_some(notice).into_iter().collect()
    }
}
