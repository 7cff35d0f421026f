//! Lines that become edges of a mesh: text, GeoJSON, Shapefiles and GeoPackages, each recognized by its
//! content.

pub(crate) mod collect;
pub(crate) mod dbase;
pub(crate) mod geojson;
#[cfg(feature = "geopackage")]
pub(crate) mod geopackage;
pub(crate) mod mask;
pub(crate) mod polygon;
pub(crate) mod polylines;
pub(crate) mod rings;
pub(crate) mod shapefile;
pub(crate) mod systems;
pub(crate) mod text;
#[cfg(feature = "geopackage")]
pub(crate) mod wkb;
pub(crate) mod wkt;
pub(crate) mod write_geojson;

use std::io::{BufReader, Read};
use std::path::Path;
use std::sync::Arc;

use crate::detect::{self, BYTE_ORDER_MARK, Format, read_head};
use crate::source::gzip::Plain;
use crate::source::origin::{name_of, open_stdin};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::LINE_VERTEX_BYTES;
use spmesh_base::places::file_and_layer;
use spmesh_stream::model::points::Point2;

use collect::Collector;
use systems::LineSystem;

/// First bytes of a GeoPackage, which is an SQLite database.
const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";

/// First bytes of the main file of a Shapefile.
const SHAPEFILE_MAGIC: &[u8] = &[0, 0, 0x27, 0x0a];

/// A line, or a ring of a polygon.
#[derive(Debug, Clone, PartialEq)]
pub struct Breakline {
    /// Its vertices, in world coordinates; at least one. The first vertex of a ring is also its last.
    pub vertices: Vec<Point2>,
    /// Elevation of each vertex, where the file states one.
    pub elevations: Vec<Option<f64>>,
    /// Whether its only vertex is a point of the file. Those of a multipoint share one `position`.
    pub is_point: bool,
    /// Number of the polygon in the file that it is a ring of.
    pub polygon: Option<u32>,
    /// Those of its feature, which all of its lines share.
    pub properties: Arc<Properties>,
    /// Position in the file, for messages.
    pub position: Arc<str>,
}

/// What a feature says about water or splines, as text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Properties {
    /// Elevation of a lake.
    pub level: Option<String>,
    /// Name that the lines and polygons of a river have in common.
    pub river: Option<String>,
    /// Side of a river that a line is the bank of.
    pub bank: Option<String>,
    /// Role in a spline.
    pub spline: Option<String>,
    /// What the property that [`Reading::elevation`] names says.
    pub elevation: Option<String>,
    /// This name.
    pub elevation_name: Option<Arc<str>>,
    /// What the property that [`Reading::label`] names says.
    pub label: Option<String>,
    /// This name.
    pub label_name: Option<Arc<str>>,
}

/// How lines are read.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Memory has room for so many vertices.
    pub vertices_max: usize,
    /// Name of a property that states the elevation of all vertices of a feature that has it, in place of
    /// third coordinates.
    pub elevation: Option<Arc<str>>,
    /// Name of a property that says what a feature is.
    pub label: Option<Arc<str>>,
}

impl Default for Reading {
    fn default() -> Self {
        Reading { vertices_max: usize::MAX, elevation: None, label: None }
    }
}

impl Reading {
    /// Lines that take so many bytes at most.
    pub fn within(bytes: u64) -> Reading {
        let vertices_max = usize::try_from(bytes / LINE_VERTEX_BYTES).unwrap_or(usize::MAX);
        Reading { vertices_max, ..Reading::default() }
    }

    /// The properties of a feature that states none.
    fn properties(&self) -> Properties {
        let (elevation_name, label_name) = (self.elevation.clone(), self.label.clone());
        Properties { elevation_name, label_name, ..Properties::default() }
    }
}

impl Properties {
    /// The property of this name, in any case; `None` if it has no meaning here.
    fn of_name(&mut self, name: &str) -> Option<&mut Option<String>> {
        let is = |own: &Option<Arc<str>>| own.as_deref().is_some_and(|own| name.eq_ignore_ascii_case(own));
        match name {
            _ if is(&self.label_name) => Some(&mut self.label),
            _ if is(&self.elevation_name) => Some(&mut self.elevation),
            _ if name.eq_ignore_ascii_case("level") => Some(&mut self.level),
            _ if name.eq_ignore_ascii_case("river") => Some(&mut self.river),
            _ if name.eq_ignore_ascii_case("bank") => Some(&mut self.bank),
            _ if name.eq_ignore_ascii_case("spline") => Some(&mut self.spline),
            _ => None,
        }
    }

    /// The elevation of all vertices of the feature; `None` if third coordinates are theirs.
    fn elevation(&self) -> Result<Option<f64>> {
        let stated = self.elevation.as_deref().unwrap_or_default().trim();
        let Some(name) = self.elevation_name.as_deref().filter(|_| !stated.is_empty()) else {
            return Ok(None);
        };
        match stated.parse() {
            Ok(z) if f64::is_finite(z) => Ok(Some(z)),
            _ => Err(Error::malformed(format!("the property {name} is {stated:?}, expected a number"))),
        }
    }
}

/// The lines of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Breaklines {
    /// In the order of the file.
    pub lines: Vec<Breakline>,
    /// What the file says about their coordinate reference system.
    pub system: LineSystem,
    /// What to say to the user about the layers of the file, if it has several and none was chosen.
    pub layers: Option<String>,
    /// Of a Shapefile: that its table of attributes is missing.
    pub missing: Option<String>,
}

impl Breaklines {
    /// Checks that features have properties, where these decide.
    ///
    /// # Errors
    /// Malformed, if the file should have a table of them beside it, and has none.
    pub fn check_properties(&self) -> Result<()> {
        self.missing.as_ref().map_or(Ok(()), |message| Err(Error::malformed(message)))
    }

    /// An error about the lines, with the layers that the user can choose.
    pub fn noting_layers(&self, error: Error) -> Error {
        self.layers.iter().fold(error, |error, layers| error.noting(layers))
    }
}

/// Reads the lines of a file; `-` is stdin, from which text and GeoJSON are read. Both may be compressed with
/// gzip.
///
/// In a line of text, the word `line` starts a line with X Y Z of each vertex, and the word `soft` one with X
/// Y. The vertices of a line may continue on the next lines of text. `nan` stands for an unknown Z.
///
/// In GeoJSON, third coordinates are elevations. Points are lines of one vertex. A Shapefile may have Z; its
/// system is in the `.prj` file beside it. Of a GeoPackage, all tables of features are read, or one layer:
/// the layer `rivers` of `map.gpkg` is `map.gpkg:rivers`.
///
/// # Errors
/// If reading fails, or the file has none of these formats; malformed, with the position, if it is damaged, a
/// coordinate is not finite, an elevation is no number, or there are more than `LINE_VERTICES_MAX` vertices;
/// memory, if there are more than `reading` allows.
pub fn read_breaklines(path: &Path, reading: &Reading) -> Result<Breaklines> {
    read(path, text_of_lines, reading).map_err(|error| error.of_input(name_of(path)))
}

/// How what is no GeoJSON, Shapefile or GeoPackage is read: its first bytes, and all of it.
type ReadText = fn(&[u8], &mut dyn Read, &Reading) -> Result<Breaklines>;

fn text_of_lines(head: &[u8], input: &mut dyn Read, reading: &Reading) -> Result<Breaklines> {
    check_text(head)?;
    text::read(input, reading)
}

fn text_or_wkt(head: &[u8], input: &mut dyn Read, reading: &Reading) -> Result<Breaklines> {
    let is_wkt = wkt::is_wkt(head);
    if is_wkt { wkt::read(input, reading) } else { text_of_lines(head, input, reading) }
}

fn read(path: &Path, read_text: ReadText, reading: &Reading) -> Result<Breaklines> {
    let (path, layer) = file_and_layer(path);
    let (input, is_file): (Box<dyn Read>, bool) = if path.as_os_str() == "-" {
        (Box::new(open_stdin()?), false)
    } else {
        let file = inputs::open(path)?;
        let is_file = inputs::is_regular(&file);
        (Box::new(file), is_file)
    };
    let mut input = Plain::held(input).map_err(|e| Error::io("reading", e))?;
    // Other formats are read by their names again, or with files beside them.
    let is_plain = is_file && !input.is_compressed();
    let head = read_head(&mut input).map_err(|e| Error::io("reading", e))?;
    let mut whole = BufReader::with_capacity(1 << 17, head.chain(input));
    let check_plain = |format: &str| if is_plain { Ok(()) } else { Err(not_in_pipe(format)) };
    if head.starts_with(SQLITE_MAGIC) {
        check_plain("GeoPackage")?;
        return read_geopackage(path, layer.as_deref(), reading);
    }
    if let Some(layer) = layer {
        let message = format!("only GeoPackages have layers: give the file without \":{layer}\"");
        return Err(Error::usage(message));
    }
    if head.starts_with(SHAPEFILE_MAGIC) {
        check_plain("Shapefile")?;
        return shapefile::read(whole, path, reading);
    }
    match geojson::is_json(&head) {
        true => geojson::read(whole, reading),
        false => read_text(&head, &mut whole, reading),
    }
}

/// Whether a file that starts with `head` is GeoJSON, a Shapefile or a GeoPackage.
pub(crate) fn is_of_features(head: &[u8]) -> bool {
    head.starts_with(SQLITE_MAGIC) || head.starts_with(SHAPEFILE_MAGIC) || geojson::is_json(head)
}

/// Bytes without the byte order mark before them, if there is one.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// Checks that a file that starts with `head` may be text.
fn check_text(head: &[u8]) -> Result<()> {
    const REMEDY: &str =
        "write the lines as GeoJSON, Shapefile, GeoPackage or text first, for example with ogr2ogr";
    match detect::detect(head)? {
        Format::OtherText | Format::Text | Format::VertexLines => Ok(()),
        other => Err(Error::malformed(format!("found {}, expected lines: {REMEDY}", other.name()))),
    }
}

fn not_in_pipe(format: &str) -> Error {
    let message =
        format!("a {format} is read from a plain file, not from a pipe or compressed: give its path");
    Error::usage(message)
}

#[cfg(feature = "geopackage")]
fn read_geopackage(path: &Path, layer: Option<&str>, reading: &Reading) -> Result<Breaklines> {
    geopackage::read(path, layer, reading)
}

#[cfg(not(feature = "geopackage"))]
fn read_geopackage(_: &Path, _: Option<&str>, _: &Reading) -> Result<Breaklines> {
    Err(Error::usage(
        "this program was built without the feature `geopackage`: convert the file first, for example with ogr2ogr \
         lines.geojson lines.gpkg",
    ))
}
