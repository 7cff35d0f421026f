//! Points from streams of this project; what their cell tags promise is ignored.

use std::io::BufReader;

use super::input::{Pass, Stated};
use super::origin::FileView;
use super::placement::Placement;
use crate::bounds::Point;
use crate::error::{Error, Result};
use crate::stream::{Event, Kind, StreamReader};

/// Reads the header of a stream.
pub(super) fn state(file: FileView, name: &str) -> Result<Stated> {
    let reader = StreamReader::new(BufReader::new(file), name)?;
    let header = reader.header();
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

/// One pass over the points of a stream.
pub(super) struct StreamPass {
    reader: StreamReader<BufReader<FileView>>,
}

impl StreamPass {
    pub(super) fn new(file: FileView, name: &str) -> Result<Self> {
        Ok(StreamPass { reader: StreamReader::new(BufReader::with_capacity(1 << 18, file), name)? })
    }
}

impl Pass for StreamPass {
    fn next_batch(&mut self, placement: &mut Placement, batch: &mut Vec<Point>) -> Result<bool> {
        while let Some(event) = self.reader.next_event()? {
            if let Event::Points(points) = event {
                let put = points.into_iter().try_for_each(|point| placement.put(point, batch));
                put.map_err(|error| self.reader.locate(error))?;
                return Ok(true);
            }
        }
        Ok(false)
    }
}
