//! Points that become knots, or knots with all that was made of them: whichever an input is.

use std::io::BufReader;
use std::path::Path;

use super::detect::{self, detect};
use super::events::EventSource;
use super::origin::{Origin, name_of};
use super::twin::TwinSource;
use super::{Input, SourceOptions};
use crate::error::Result;
use crate::stream::StreamReader;

/// What an input is.
pub enum KnotSource {
    /// Points of any source.
    Points(Box<Input>),
    /// A stream of configurations or of a spline, or the text twin of one.
    Set(Box<dyn EventSource>),
}

/// Opens a path ("-" is standard input) as a stream of knots if it is one, and otherwise as points.
///
/// Cost: the headers; what cannot be read twice is copied to an unlinked temporary file.
///
/// # Errors
/// As [`Input::open`].
pub fn open_knots(path: &Path, options: &SourceOptions) -> Result<KnotSource> {
    let temp_dir = options.temp_dir.clone().unwrap_or_else(std::env::temp_dir);
    // That a pipe is copied tells nobody anything: all of it is held in memory later.
    let origin = Origin::new(path, &temp_dir, &mut Vec::new())?;
    let name = name_of(path);
    if let Some(set) = open_set(&origin, &name).map_err(|e| e.of_input(&name))? {
        return Ok(KnotSource::Set(set));
    }
    Ok(KnotSource::Points(Box::new(Input::of_origin(origin, name, options)?)))
}

/// `None` if it is no stream of knots.
fn open_set(origin: &Origin, name: &str) -> Result<Option<Box<dyn EventSource>>> {
    let view = origin.view()?;
    let source: Box<dyn EventSource> = match detect(&view)? {
        detect::Format::Stream => Box::new(StreamReader::new(BufReader::with_capacity(1 << 18, view), name)?),
        detect::Format::Twin => Box::new(TwinSource::new(view, name)?),
        _ => return Ok(None),
    };
    Ok(source.header().kind.has_knots().then_some(source))
}
