//! Points from streams of this project, and from their text twins; what their cell tags promise is ignored.

use std::io::BufReader;

use super::events::EventSource;
use super::input::{Pass, Stated};
use super::origin::FileView;
use super::placement::Placement;
use super::twin::TwinSource;
use crate::bounds::Point;
use crate::error::{Error, Result};
use crate::stream::{Event, Kind, StreamReader};

/// Reads the header of a stream.
pub(super) fn state(file: FileView, name: &str) -> Result<Stated> {
    state_of(&StreamReader::new(BufReader::new(file), name)?)
}

/// Reads the header of a text twin.
pub(super) fn state_of_twin(file: FileView, name: &str) -> Result<Stated> {
    state_of(&TwinSource::new(file, name)?)
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

/// One pass over the points of a stream or of a text twin.
pub(super) struct EventPass<S>(S);

/// Starts a pass over a stream.
pub(super) fn pass(file: FileView, name: &str) -> Result<EventPass<StreamReader<BufReader<FileView>>>> {
    StreamReader::new(BufReader::with_capacity(1 << 18, file), name).map(EventPass)
}

/// Starts a pass over a text twin.
pub(super) fn pass_of_twin(file: FileView, name: &str) -> Result<EventPass<TwinSource<FileView>>> {
    TwinSource::new(file, name).map(EventPass)
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
