//! The command line of `spconvert`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Parser;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::{Options, bounds, convert};
use spmesh_base::error::{Error, ErrorKind};
use spmesh_base::output::Output;
use spmesh_base::system;
use spmesh_formats::drivers::Format;
use spmesh_formats::sink::SinkOptions;
use spmesh_formats::source::AttributeChoice;
use spmesh_shell::compression::Compression;
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::{Common, notice, open_input, progress::Progress};

const EXAMPLES: &str = "\
Formats:
  spm   binary stream                     text  its text twin, lossless both ways
  obj   Wavefront OBJ                     ply   Stanford PLY
  spa, spb   Isenburg's streaming points  sma, smb   Isenburg's streaming meshes
  vtu   VTK, for ParaView (written only)  medit  Medit's .mesh (written only)
  dxf   AutoCAD R12, text (written only)  landxml  LandXML 1.2 (written only)
  glb   glTF 2.0, binary (written only)   stl    binary STL (written only)
  ugrid   UGRID in netCDF (.nc), for QGIS (written only)
  geojson    the edges of a constrained mesh that are on lines (written only)
  points     LAS, LAZ, COPC, lines of coordinates, VTK (read only)

Examples:
  spconvert mesh.spm --to text | less
  spfinalize tile.laz | spdelaunay2d | spconvert --to ply -o tin.ply
  spconvert old.smb -o mesh.spm
  spconvert tile.laz --to text | less
  spconvert protein.spm -o protein.vtu
  spconvert mesh.spm -o tin.xml                   a LandXML surface with breaklines
  spconvert --local-origin mesh.spm -o mesh.obj   for viewers with 32-bit numbers
  spconvert terrain.spm -o terrain.glb            for viewers of glTF, as Blender
  spconvert --compress mesh.spm -o small.spm      without the flag, the stream is expanded
  spconvert mesh.spm --to text | spconvert --to spm | cmp - mesh.spm

The input may be compressed with gzip. Its format is recognized by its content, or its name; that of the \
output by its name. Only spm and text hold a CRS and integer coordinates; the others get world coordinates, \
SMB rounded to 32 bits, glTF and STL as 32-bit differences from an origin that they state. PLY and UGRID have \
the CRS as QGIS reads it. A notice says what is lost. Of tetrahedra, OBJ, PLY, STL and glTF get the hull; VTU has the \
labels of vertices as point data, Medit as references. Of a constrained mesh, DXF has the edges on lines as \
lines of a layer of their own, and LandXML has them as breaklines. Coordinates on a grid become the shortest decimals that \
stand for them: 28016 steps of 0.001 are 28.016. A text twin with a number off its grid is refused. Meshes of OBJ and PLY do not say when vertices are \
final: all of them are at the end. Files of OBJ, PLY, SPA, SPB, SMA and SMB are read twice for a stream, whose header \
states their bounds; through a pipe, it states none.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input,
5 not enough memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// The message after a failed allocation.
const OUT_OF_MEMORY: &str = "spconvert: not enough memory for the vertices of the mesh\n";

/// Convert streams of points and meshes to and from other formats
#[derive(Debug, Parser)]
#[command(name = "spconvert", version, after_help = EXAMPLES)]
pub struct Flags {
    /// Input file; - is stdin
    #[arg(default_value = "-")]
    input: PathBuf,

    /// Output file; - is stdout
    #[arg(short, long, default_value = "-")]
    output: PathBuf,

    /// Format of the output [default: by the name of the output]
    #[arg(long, value_name = "FORMAT", value_parser = formats(Format::written()))]
    to: Option<Format>,

    /// Format of the input [default: by its content, or its name]
    #[arg(long, value_name = "FORMAT", value_parser = formats(Format::read()))]
    from: Option<Format>,

    /// Take attributes of points of LAS, LAZ, COPC or text along: their names, or all. Points of other formats keep
    /// theirs
    #[arg(long, value_name = "NAMES|all", value_delimiter = ',')]
    attributes: Vec<String>,

    #[command(flatten)]
    crs: CrsFlag,

    /// Write PLY as text
    #[arg(long)]
    ascii: bool,

    /// Write coordinates of OBJ, DXF and LandXML as differences from an origin in the middle of the mesh, which
    /// the output states, for programs that compute in 32 bits
    #[arg(long)]
    local_origin: bool,

    #[command(flatten)]
    compression: Compression,

    /// Dimensions of points in formats that do not say: 2 (z is an elevation, the default) or 3
    #[arg(long, value_parser = clap::value_parser!(u8).range(2..=3))]
    dims: Option<u8>,

    /// Folder for temporary files: writing PLY, VTU, Medit, LandXML, glTF, STL and UGRID needs them, and
    /// reading points through a pipe
    #[arg(long, value_name = "DIR")]
    temp_dir: Option<PathBuf>,

    #[command(flatten)]
    common: Common,
}

fn formats(formats: impl Iterator<Item = Format>) -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(formats.map(Format::value))
        .map(|value| Format::from_value(&value).expect("the value is one of the values"))
}

/// Runs the tool.
///
/// # Errors
/// See [`convert`]; then no output file is made.
pub fn run(flags: Flags) -> Result<()> {
    system::exit_at_abort(OUT_OF_MEMORY, ErrorKind::Memory.exit_code());
    let to = flags.to.or_else(|| Format::from_path(&flags.output)).ok_or_else(|| {
        Error::usage("the format of the output is not known: give it with --to, or a name like mesh.obj")
    })?;
    let compress = flags.compression.of_output(to == Format::Stream)?;
    let is_binary = to.is_binary() && !(to == Format::Ply && flags.ascii);
    // Fail before the work if the output cannot be created.
    let mut output = Output::create(&flags.output, is_binary)?;
    let (input, name) = open_input(&flags.input)?;
    let mut options = Options {
        from: flags.from,
        dims: flags.dims,
        attributes: AttributeChoice::of_names(&flags.attributes),
        crs: flags.crs.system()?,
        bounds: None,
        path: flags.input.is_file().then(|| flags.input.clone()),
        sink: SinkOptions {
            ascii: flags.ascii,
            local_origin: flags.local_origin,
            compress,
            temp_dir: flags.temp_dir,
        },
    };
    if matches!(to, Format::Stream | Format::Twin) || flags.local_origin {
        options.bounds = match &options.path {
            Some(path) => bounds(open_input(path)?.0, &name, &options)?,
            None => None,
        };
    }
    let mut progress = Progress::new(&flags.common, "converting", None);
    let notices = convert(input, &name, to, &mut output, &options, |points| progress.set(points))?;
    drop(progress);
    output.commit()?;
    for message in &notices {
        notice("spconvert", &flags.common, &format!("{name}: {message}"));
    }
    Ok(())
}
