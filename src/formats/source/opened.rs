//! Opens an input as points of any source, or as a stream of a kind that the program prefers.

use std::path::{Path, PathBuf};

use crate::detect::{Format, read_head};
use crate::drivers::Events;
use crate::source::input::Input;
use crate::source::options::SourceOptions;
use crate::source::origin::{Origin, name_of};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Kind;

/// An opened input.
pub enum Opened {
    /// Points of any source.
    Points(Box<Input>),
    /// A stream of a preferred kind, or its text twin.
    Events(Events),
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

/// Opens a path ("-" is standard input) as a stream of configurations or of a spline if it is one, and
/// otherwise as points.
///
/// Cost: that of [`open_planar`].
///
/// # Errors
/// As [`Input::open`].
pub fn open_knots(path: &Path, options: &SourceOptions) -> Result<Opened> {
    open(path, options, Kind::has_knots)
}

fn open(path: &Path, options: &SourceOptions, is_wanted: impl Fn(Kind) -> bool) -> Result<Opened> {
    // No notice of the spool: the whole input will be held in memory anyway.
    let origin = Origin::new(path, options.admitted(), &options.temp_dir(), &mut Vec::new())?;
    let origin = origin.of_use(options.purpose());
    let name = name_of(path);
    let events = open_events(&origin, &name, options).map_err(|e| e.of_input(&name))?;
    match events.filter(|events| is_wanted(events.header().kind)) {
        Some(events) => Ok(Opened::Events(events)),
        None => Ok(Opened::Points(Box::new(Input::of_origin(origin, name, options)?))),
    }
}

/// The events of the input; `None` if it is neither a stream nor the text twin of one.
fn open_events(origin: &Origin, name: &str, options: &SourceOptions) -> Result<Option<Events>> {
    let head = read_head(&mut origin.plain()?).map_err(|e| Error::io("reading", e))?;
    let format = options.reader.detect(&head)?;
    let open = format.events().filter(|_| matches!(format, Format::Stream | Format::Twin));
    open.map(|open| open(Box::new(origin.plain()?), name, options.dims)).transpose()
}
