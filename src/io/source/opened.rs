//! Points of any source, or the stream that a program would rather have: whichever an input is.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use super::detect::{self, detect};
use super::events::EventSource;
use super::origin::{Origin, name_of};
use super::twin::TwinSource;
use super::{Input, SourceOptions};
use spmesh_core::error::Result;
use spmesh_stream::{Kind, StreamReader};

/// What an input is.
pub enum Opened {
    /// Points of any source.
    Points(Box<Input>),
    /// A stream of a wanted kind, or the text twin of one.
    Events(Box<dyn EventSource>),
}

/// Opens `paths` ("-" is standard input) as points in the plane, or one path as a triangle mesh if it is one.
///
/// Cost: the headers; what cannot be read twice is copied to an unlinked temporary file.
///
/// # Errors
/// As [`Input::open`].
pub fn open_planar(paths: &[PathBuf], options: &SourceOptions) -> Result<Opened> {
    match paths {
        [path] => open(path, options, |kind| kind == Kind::TriangleMesh),
        _ => Ok(Opened::Points(Box::new(Input::open(paths, options)?))),
    }
}

/// Opens a path ("-" is standard input) as a stream of configurations or of a spline if it is one, and otherwise as points.
///
/// Cost: that of [`open_planar`].
///
/// # Errors
/// As [`Input::open`].
pub fn open_knots(path: &Path, options: &SourceOptions) -> Result<Opened> {
    open(path, options, Kind::has_knots)
}

fn open(path: &Path, options: &SourceOptions, is_wanted: impl Fn(Kind) -> bool) -> Result<Opened> {
    let temp_dir = options.temp_dir.clone().unwrap_or_else(std::env::temp_dir);
    // That a pipe is copied tells nobody anything: all of it is held in memory later.
    let origin = Origin::new(path, &temp_dir, &mut Vec::new())?;
    let name = name_of(path);
    let events = open_events(&origin, &name).map_err(|e| e.of_input(&name))?;
    match events.filter(|events| is_wanted(events.header().kind)) {
        Some(events) => Ok(Opened::Events(events)),
        None => Ok(Opened::Points(Box::new(Input::of_origin(origin, name, options)?))),
    }
}

/// `None` if it is neither a stream nor the text twin of one.
fn open_events(origin: &Origin, name: &str) -> Result<Option<Box<dyn EventSource>>> {
    let view = origin.view()?;
    Ok(match detect(&view)? {
        detect::Format::Stream => {
            Some(Box::new(StreamReader::new(BufReader::with_capacity(1 << 18, view), name)?))
        }
        detect::Format::Twin => Some(Box::new(TwinSource::new(view, name)?)),
        _ => None,
    })
}
