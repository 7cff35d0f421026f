//! Conversion between formats: every input becomes the events of a stream, which go to every output that can
//! hold their kind.

#[cfg(feature = "flags")]
pub mod flags;

use std::borrow::Cow;
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::detect::{SPCONVERT, detect, read_head};
use spmesh_formats::drivers::{Events, Format};
use spmesh_formats::sink::SinkOptions;
use spmesh_formats::source::{AttributeChoice, Input, PointEvents, SourceOptions};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Crs, Event, Header};

/// What a conversion may choose.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Format of the input; by its content and its name if `None`.
    pub from: Option<Format>,
    /// Dimensions of points in formats that do not say: 3, or else 2 with an elevation.
    pub dims: Option<u8>,
    /// What points of formats that `spfinalize` reads carry along.
    pub attributes: AttributeChoice,
    /// The coordinate reference system, if not that of the input.
    pub crs: Option<Crs>,
    /// The bounding box, if the input does not state it: see [`bounds`].
    pub bounds: Option<Bounds>,
    /// The file of the input, compressed or not, if the input is a file. Points are read from it directly;
    /// without it, they are read from a copy.
    pub path: Option<PathBuf>,
    /// How the output is written, and where spools go.
    pub sink: SinkOptions,
}

/// Reads `input`, whose name is `name`, and writes it to `output` as `to`. Calls `progress` with the number
/// of points or vertices done. Returns notices for the user about what was lost. The output is complete only
/// if the call succeeds.
///
/// Memory: that of [`spmesh_stream::MemoryRules`], which is bounded by the width of a stream; meshes that do
/// not state when vertices are final are held.
///
/// # Errors
/// Malformed, if the input is; usage, if its format is not recognized or `to` cannot hold it; I/O.
pub fn convert(
    input: impl Read + Send + 'static,
    name: &str,
    to: Format,
    output: &mut dyn Write,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<Vec<String>> {
    let mut done = 0;
    let mut source = open_source(input, name, options)?;
    let header = source.header().clone();
    let crs = options.crs.clone().unwrap_or(header.crs);
    let bounds = header.bounds.or(options.bounds);
    let mut sink = to.open_sink(output, &Header { crs, bounds, ..header }, &options.sink)?;
    while let Some(event) = source.next_event()? {
        sink.event(&event, source.rows()).map_err(|error| match error.kind() {
            ErrorKind::Malformed | ErrorKind::Usage => source.locate(error),
            _ => error,
        })?;
        done += match &event {
            Event::Points(points) => points.len() as u64,
            Event::Patch(patch) => patch.new.len() as u64,
            Event::Points4(points) => points.points.len() as u64,
            _ => 0,
        };
        progress(done);
    }
    let mut notices = source.notices();
    notices.extend(sink.notices());
    Ok(notices)
}

/// The bounding box of an input of another program, whose format does not state it; `None` if the header of the
/// input may, or if it is empty. Reads the whole input. Memory: as [`convert`].
///
/// # Errors
/// As [`convert`].
pub fn bounds(input: impl Read + Send + 'static, name: &str, options: &Options) -> Result<Option<Bounds>> {
    let (format, mut source) = open(input, name, options)?;
    if matches!(format, Format::Stream | Format::Twin) || format.events().is_none() {
        return Ok(None);
    }
    let mut bounds: Option<Bounds> = None;
    while let Some(event) = source.next_event()? {
        let points = match &event {
            Event::Points(points) => points,
            Event::Patch(patch) => &patch.new,
            _ => continue,
        };
        for &point in points {
            bounds.get_or_insert(Bounds::of_point(point)).extend(point);
        }
    }
    Ok(bounds)
}

/// Opens an input as a source of events.
///
/// # Errors
/// Usage, if the format is not recognized or cannot be read; malformed, if the header is.
pub fn open_source(input: impl Read + Send + 'static, name: &str, options: &Options) -> Result<Events> {
    open(input, name, options).map(|(_, source)| source)
}

/// An input of some format as a source of events.
fn open(mut input: impl Read + Send + 'static, name: &str, options: &Options) -> Result<(Format, Events)> {
    let in_input = |error: Error| error.of_input(name);
    let (format, head) = match options.from {
        Some(format) if !format.is_read() => {
            let name = format.value();
            return Err(in_input(Error::usage(format!("{name} is written by this program, but not read"))));
        }
        Some(format) => (format, Vec::new()),
        None => {
            let head = read_head(&mut input).map_err(|e| in_input(Error::io("reading", e)))?;
            (recognize(&head, Path::new(name)).map_err(in_input)?, head)
        }
    };
    let input = Box::new(Cursor::new(head).chain(input));
    let source = match format.events() {
        Some(open) => open(input, name, options.dims.unwrap_or(2)),
        None => open_points(input, name, options),
    };
    Ok((format, source?))
}

/// The format of an input that starts with `head`: by its content, and by the name of the file where that
/// leaves a doubt.
///
/// # Errors
/// Malformed, if the input is empty or of a format that is not read; usage, if its format is unknown or
/// ambiguous.
fn recognize(head: &[u8], name: &Path) -> Result<Format> {
    let found = detect(head)?;
    if matches!(found, Format::VertexLines | Format::OtherText | Format::Binary) {
        let by_name = Format::from_path(&without_gz(name)).filter(|format| format.is_read());
        return by_name.ok_or_else(|| {
            Error::usage("cannot tell the format from the first bytes and the name: give it with --from")
        });
    }
    if !SPCONVERT.reads(found) {
        return Err(Error::malformed(SPCONVERT.refusal(found, head)));
    }
    Ok(found)
}

/// The name of a compressed file without its last extension.
fn without_gz(name: &Path) -> Cow<'_, Path> {
    let is_gz = name.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_gz { name.with_extension("").into() } else { name.into() }
}

/// Points that are read as `spfinalize` does, in order and without finalization.
fn open_points(input: impl Read, name: &str, options: &Options) -> Result<Events> {
    let source = SourceOptions {
        reader: &SPCONVERT,
        dims: options.dims.unwrap_or(2),
        attributes: options.attributes.clone(),
        temp_dir: options.sink.temp_dir.clone(),
        ..SourceOptions::default()
    };
    let input = match &options.path {
        Some(path) => Input::open(std::slice::from_ref(path), &source)?,
        None => Input::copied(input, name, &source)?,
    };
    Ok(Box::new(PointEvents::new(input)?))
}
