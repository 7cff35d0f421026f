//! The formats of `spconvert`: what it reads and writes, by names of formats and of files.

use std::io::Write;
use std::path::Path;

use crate::drivers::{Format, Row};
use crate::sink::{EventSink, HullSink, SinkOptions, surface_header};
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Header, Kind};

/// The formats of `spconvert`, in the order of its help.
const CONVERTED: [Format; 17] = {
    use Format::*;
    [
        Stream, Twin, Obj, Ply, Spa, Spb, Sma, Smb, VtkXml, Medit, Dxf, LandXml, Gltf, Stl, Netcdf, GeoJson,
        Text,
    ]
};

impl Format {
    /// The formats that `spconvert` can be told to read; those that it only recognizes are not among them.
    pub fn read() -> impl Iterator<Item = Format> {
        CONVERTED.into_iter().filter(|format| format.is_read())
    }

    /// Whether `spconvert` can be told to read it.
    pub fn is_read(self) -> bool {
        // A name is that of something to write or, without a writer, that of something to read.
        let Row { value, events, sink, .. } = self.row();
        events.is_some() || !value.is_empty() && sink.is_none()
    }

    /// The formats that streams are converted to.
    pub fn written() -> impl Iterator<Item = Format> {
        CONVERTED.into_iter().filter(|format| format.row().sink.is_some())
    }

    /// The format with this name on the command line, if there is one.
    pub fn from_value(value: &str) -> Option<Self> {
        CONVERTED.into_iter().find(|format| format.value() == value)
    }

    /// The format that the extension of `path` names, if it names one that streams are converted to.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        Format::written().find(|format| format.row().ending.eq_ignore_ascii_case(extension))
    }

    /// Starts an output for the stream that `header` describes. Of tetrahedra, formats of surfaces in
    /// space get the hull.
    ///
    /// # Errors
    /// Usage, if the format is not written, does not hold the kind of stream, or has no use for the options;
    /// or if writing fails.
    pub fn open_sink<'a>(
        self,
        output: &'a mut dyn Write,
        header: &Header,
        options: &SinkOptions,
    ) -> Result<Box<dyn EventSink + 'a>> {
        let Row { value, listed, sink, .. } = self.row();
        if options.local_origin && !matches!(self, Format::Obj | Format::Dxf | Format::LandXml) {
            return Err(Error::usage(
                "--local-origin is for OBJ, DXF and LandXML: leave it out; glTF and STL have one anyway",
            ));
        }
        let Some(open) = sink else {
            return Err(Error::usage(format!(
                "{value} is a format that this program reads, but does not write"
            )));
        };
        let is_of_surfaces = matches!(self, Format::Obj | Format::Ply | Format::Gltf | Format::Stl);
        if header.kind == Kind::TetrahedralMesh && is_of_surfaces {
            let surface = open(output, &surface_header(header), options)?;
            return Ok(Box::new(HullSink::new(surface, listed, header)));
        }
        open(output, header, options)
    }
}
