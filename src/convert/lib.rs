//! Conversion between formats: every input becomes the events of a stream, which go to every output that can
//! hold their kind.

#[cfg(feature = "flags")]
pub mod flags;
mod format;
mod recognition;

pub use format::Format;

use std::io::{BufReader, Cursor, Read, Write};
use std::path::{Path, PathBuf};

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::detect::{SPCONVERT, read_head};
use spmesh_formats::sink::{
    DxfSink, EventSink, GeoJsonSink, HullSink, LandXmlSink, MeditSink, ObjSink, PlyEncoding, PlySink,
    SmaSink, SmbSink, SpaSink, SpbSink, SpmSink, TwinSink, VtuSink, surface_header,
};
use spmesh_formats::source::{
    AttributeChoice, Checked, EventSource, Input, PointEvents, SourceOptions, SpEvents, SpaReader, SpbReader,
    TwinSource, open_obj, open_ply, open_sma, open_smb,
};
use spmesh_stream::{Crs, Event, Header, Kind, StreamReader};

/// What a conversion may choose.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Format of the input; by its content and its name if `None`.
    pub from: Option<Format>,
    /// Dimensions of points in formats that do not say: 3, or else 2 with an elevation.
    pub dims: Option<u8>,
    /// What points of formats that `spfinalize` reads carry along.
    pub attributes: AttributeChoice,
    /// Write PLY as text.
    pub ascii: bool,
    /// The coordinate reference system, if not that of the input.
    pub crs: Option<Crs>,
    /// Write coordinates of OBJ as differences from an origin in the middle.
    pub local_origin: bool,
    /// Compress the blocks of a stream.
    pub compress: bool,
    /// The file of the input, compressed or not, if the input is a file. Points are read from it directly;
    /// without it, they are read from a copy.
    pub path: Option<PathBuf>,
    /// Where spools go; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// Reads `input`, whose name is `name`, and writes it to `output` as `to`. Calls `progress` with the number
/// of points or vertices done. Returns notices for the user about what was lost. The output is complete only
/// if the call succeeds.
///
/// Memory: that of [`spmesh_stream::MemoryRules`], which is bounded by the width of a stream; meshes that do not
/// state when vertices are final are held.
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
    let mut sink = open_sink(to, output, source.as_ref(), options)?;
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

/// Opens an input as a source of events.
///
/// # Errors
/// Usage, if the format is not recognized or cannot be read; malformed, if the header is.
pub fn open_source(
    mut input: impl Read + Send + 'static,
    name: &str,
    options: &Options,
) -> Result<Box<dyn EventSource>> {
    let in_input = |error: Error| error.of_input(name);
    let reading = |e| in_input(Error::io("reading", e));
    let (format, head) = match options.from {
        Some(format) => (format, Vec::new()),
        None => {
            let head = read_head(&mut input).map_err(reading)?;
            (recognition::recognize(&head, Path::new(name)).map_err(in_input)?, head)
        }
    };
    let input = Cursor::new(head).chain(input);
    let dims = options.dims.unwrap_or(2);
    Ok(match format {
        Format::Spm => {
            let reader = StreamReader::new(BufReader::with_capacity(1 << 18, input), name)?;
            Box::new(Checked::new(reader))
        }
        Format::Text => Box::new(Checked::new(TwinSource::new(input, name)?)),
        Format::Obj => open_obj(input, name),
        Format::Sma => open_sma(input, name)?,
        Format::Smb => open_smb(BufReader::new(input), name)?,
        Format::Spa => Box::new(SpEvents::new(SpaReader::new(input).map_err(in_input)?, name, dims)),
        Format::Spb => {
            let reader = SpbReader::new(BufReader::with_capacity(1 << 18, input)).map_err(in_input)?;
            Box::new(SpEvents::new(reader, name, dims))
        }
        Format::Ply => open_ply(input, name, dims)?,
        Format::Points => open_points(input, name, options)?,
        Format::Vtu | Format::Medit | Format::Dxf | Format::LandXml | Format::GeoJson => {
            let name = format.name();
            return Err(in_input(Error::usage(format!("{name} is written by this program, but not read"))));
        }
    })
}

/// Points that are read as `spfinalize` does, in order and without finalization.
fn open_points(input: impl Read, name: &str, options: &Options) -> Result<Box<dyn EventSource>> {
    let source = SourceOptions {
        reader: &SPCONVERT,
        dims: options.dims.unwrap_or(2),
        attributes: options.attributes.clone(),
        temp_dir: options.temp_dir.clone(),
        ..SourceOptions::default()
    };
    let input = match &options.path {
        Some(path) => Input::open(std::slice::from_ref(path), &source)?,
        None => Input::copied(input, name, &source)?,
    };
    Ok(Box::new(PointEvents::new(input)?))
}

fn open_sink<'a>(
    to: Format,
    output: &'a mut dyn Write,
    source: &dyn EventSource,
    options: &Options,
) -> Result<Box<dyn EventSink + 'a>> {
    let header = &Header {
        crs: options.crs.clone().unwrap_or(source.header().crs.clone()),
        ..source.header().clone()
    };
    let temp_dir = options.temp_dir.as_deref();
    let encoding = if options.ascii { PlyEncoding::Ascii } else { PlyEncoding::Binary };
    if options.local_origin && to != Format::Obj {
        return Err(Error::usage("--local-origin is for OBJ: leave it out, or add --to obj"));
    }
    let obj = if options.local_origin { ObjSink::with_local_origin } else { ObjSink::new };
    if header.kind == Kind::TetrahedralMesh {
        let surface = surface_header(header);
        match to {
            Format::Obj => {
                return Ok(Box::new(HullSink::new(obj(output, &surface)?, "OBJ", header)));
            }
            Format::Ply => {
                let ply = PlySink::new(output, &surface, encoding, temp_dir)?;
                return Ok(Box::new(HullSink::new(ply, "PLY", header)));
            }
            _ => {}
        }
    }
    Ok(match to {
        Format::Spm => {
            let header = Header { compressed: options.compress, ..header.clone() };
            Box::new(SpmSink::new(output, &header)?)
        }
        Format::Text => Box::new(TwinSink::new(output, header)?),
        Format::Obj => Box::new(obj(output, header)?),
        Format::Ply => Box::new(PlySink::new(output, header, encoding, temp_dir)?),
        Format::Vtu => Box::new(VtuSink::new(output, header, temp_dir)?),
        Format::Medit => Box::new(MeditSink::new(output, header, temp_dir)?),
        Format::Dxf => Box::new(DxfSink::new(output, header)?),
        Format::LandXml => Box::new(LandXmlSink::new(output, header, temp_dir)?),
        Format::GeoJson => Box::new(GeoJsonSink::new(output, header)?),
        Format::Spa => Box::new(SpaSink::new(output, header)?),
        Format::Spb => Box::new(SpbSink::new(output, header)?),
        Format::Sma => Box::new(SmaSink::new(output, header)?),
        Format::Smb => Box::new(SmbSink::new(output, header, temp_dir)?),
        Format::Points => {
            return Err(Error::usage("points is a format that this program reads, but does not write"));
        }
    })
}
