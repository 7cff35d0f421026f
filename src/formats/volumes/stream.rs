//! Streams of this project with points of four dimensions, and their text twins. Cells are skipped.

use std::io::{BufReader, Read};
use std::path::Path;

use crate::source::origin::Origin;
use crate::source::{EventSource, TwinSource};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::{Event, StreamReader};

const BUFFER_LEN: usize = 1 << 18;

/// A stream whose header has been read.
#[derive(Debug)]
pub(crate) struct Stream {
    origin: Origin,
    name: String,
    is_twin: bool,
    pub has_values: bool,
}

/// The points of the stream in `origin`. They can be scanned any number of times.
pub(crate) fn open(origin: Origin, path: Option<&Path>, is_twin: bool) -> Result<Stream> {
    let name = path.map_or("stdin".to_string(), |path| path.display().to_string());
    let mut stream = Stream { origin, name, is_twin, has_values: false };
    let source = stream.read()?;
    let header = source.header();
    if !header.kind.is_4d() {
        let message = format!(
            "is a stream of kind {} in {} dimensions, expected points, cells or simplices in 4 dimensions",
            header.kind.name(),
            header.dims
        );
        return Err(Error::usage(message));
    }
    stream.has_values = header.has_elevation;
    Ok(stream)
}

impl Stream {
    fn read(&self) -> Result<Box<dyn EventSource>> {
        let input: Box<dyn Read + Send> =
            Box::new(BufReader::with_capacity(BUFFER_LEN, self.origin.plain()?));
        Ok(match self.is_twin {
            true => Box::new(TwinSource::new(input, &self.name)?),
            false => Box::new(StreamReader::new(input, &self.name)?),
        })
    }

    /// Passes every point to `visit`; reads the stream up to its END.
    pub(crate) fn scan(&self, visit: &mut dyn FnMut(Point4, Option<f64>) -> Result<()>) -> Result<()> {
        let mut source = self.read()?;
        while let Some(event) = source.next_event()? {
            let Event::Points4(block) = event else { continue };
            for (number, point) in block.points.into_iter().enumerate() {
                // Adding 0.0 turns -0.0 into 0.0.
                visit(point.map(|x| x + 0.0), block.values.as_ref().map(|values| values[number]))?;
            }
        }
        Ok(())
    }
}
