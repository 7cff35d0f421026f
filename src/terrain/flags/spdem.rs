//! `spdem`: flags, and the counts of `--stats`.

mod bends;
mod contours;
mod points;
mod quantity;

use std::path::PathBuf;
use std::slice;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;

use super::sheets::SheetFlags;
use super::spreport::parse_positive;
use crate::contours::LineFormat;
use crate::dem::{self, Options, Quantity, Stats};
use crate::points::Options as PointOptions;
use bends::BendFlags;
use contours::{ContourFlags, Job};
use quantity::QuantityFlags;
use spmesh_base::error::Error;
use spmesh_base::limits::LINE_VERTEX_BYTES;
use spmesh_formats::raster::RasterFormat;
use spmesh_pipeline::finalize::Banks;
use spmesh_shell::cells::{self, CellFlags, RasterFlags};
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::endings;
use spmesh_shell::outline::OutlineFlags;
use spmesh_shell::progress::Progress;
use spmesh_shell::stats::Row;
use spmesh_shell::{
    Common, Mesh, Names, Needs, Report, StatsFlag, advise_on_memory, named, notice, of_ending, parse_size,
    peak_memory,
};
use spmesh_stream::Crs;

const TOOL: &str = "spdem";

/// Memory by default. Units: bytes.
const MEMORY: u64 = 32 << 20;

const EXAMPLES: &str = "\
Examples:
  A terrain model of the ground points of many tiles, with cells of half a metre:
    spfinalize tiles/*.laz --keep-class 2 | spdelaunay2d | spdem --step 0.5 -o terrain.tif
  No data where points are far apart, as on water:
    spdem --step 1 --kill 30 ground.spm -o terrain.tif
  No data outside of a survey that is no rectangle, but on all of its lakes; and only in a park:
    spdem --step 1 --concave 30 ground.spm -o terrain.tif
    spdem --step 1 --mask park.geojson ground.spm -o park.tif
  Slopes, and a hillshade with light from the north-west:
    spdem --step 1 --kind slope ground.spm -o slope.tif
    spdem --step 1 --kind hillshade ground.spm -o shade.tif
    spdem --step 1 --kind hillshade --multidirectional ground.spm -o shade.tif
    spdem --step 1 --kind shaded-relief ground.spm -o relief.tif
  The highest point and the number of points per square metre, from points:
    spfinalize tiles/*.laz | spdem --points --kind max --step 1 -o highest.tif
    spfinalize tiles/*.laz | spdem --points --kind density --step 5 -o density.tif
  The intensity of the returns, and their classes:
    spfinalize tiles/*.laz --attributes intensity,classification | spdelaunay2d > all.spm
    spdem --step 1 --attribute intensity all.spm -o intensity.tif
    spdem --step 1 --attribute classification --interpolation nearest all.spm -o classes.tif
  For the web, with overviews, and gaps of up to 20 cells filled:
    spdem --step 1 --fill 20 --cog ground.spm -o terrain.tif
  Many rasters of 1000 by 1000 metres, each with a margin of 20 metres: dtm/ground_650000_4820000.tif and so on
    spdem --step 1 --tiles 1000 --buffer 20 ground.spm -o dtm/ground.tif
  Whole squares with names by kilometres, and a virtual raster of all: dtm/D0650_4821.tif and so on, dtm/all.vrt
    spdem --step 1 --tiles 1000 --full --tile-name 'D{x_km:4}_{y_nw_km:4}' --tile-index vrt ground.spm -o dtm/all.tif
  Integers of centimetres, compressed with zstd:
    spdem --step 1 --type int16 --scale 0.01 --compression zstd ground.spm -o terrain.tif
  A part as a text grid:
    spdem --step 1 --bounds 4000,7000,5000,8000 ground.spm -o part.asc
  Contour lines every five metres; then a raster and lines from one pipe:
    spdem --contours 5 ground.spm -o lines.geojson
    spdem --contours 1 --smooth --min-length 20 --concave 30 ground.spm -o lines.geojson
    spfinalize tiles/*.laz | spdelaunay2d | tee >(spdem --step 1 -o terrain.tif) | spdem --contours 5 -o lines.geojson
  Very many lines as a GeoPackage (the lines format cannot state the coordinate system):
    spdem --contours 0.5 ground.spm -o lines.geojsonl
    ogr2ogr -a_srs EPSG:2154 lines.gpkg lines.geojsonl
  A surface without creases at the edges of triangles, by natural neighbours:
    spdem --step 1 --interpolation natural ground.spm -o smooth.tif
  From a mesh of another program:
    spconvert terrain.ply --to spm | spdem --step 1 --bounds 0,0,1000,1000 -o terrain.tif
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
A cell has the value of the mesh at its centre; outside the mesh there is no data (-9999). Triangles are \
drawn as they arrive. A tile of 256 by 256 cells is written as soon as it is full, so only incomplete tiles \
take memory. Tiles beyond --memory wait in a temporary file. ESRI grids are written after the last triangle, \
from the top, with 256 rows in memory. Of a mesh in parts, only the parts in the window of --bounds, --like \
or --mask are read, but all with --concave or --interpolation natural.

The outline is the convex hull. With --concave L, triangles are outside if a chain of triangles leads to them \
from the hull in which every crossed edge, first one of the hull, is longer than L; all others stay, also with \
long edges. Triangles with an edge longer than L wait for the end of the stream, in --memory and a temporary \
file. With integer coordinates, lengths are compared exactly. --mask keeps cells whose centre is in a polygon or \
on its border; rings of a polygon count by the even-odd rule. --fill fills holes inside of the outline and the \
mask, also those of --kill.

An attribute is drawn as elevations are, or with --interpolation nearest as the value of the nearest corner of \
the triangle. With linear interpolation, triangles with a corner whose value is unknown are left out. A raster has \
one band of 32-bit numbers; for a picture in colour, join those of red, green and blue (gdalbuildvrt -separate).

Slopes are angles in degrees. Aspects are directions of steepest descent, in degrees clockwise from north; \
level ground has none. Hillshades are bytes from 1 to 255, and 0 for no data. They equal what gdaldem computes from \
the raster of elevations: from a cell and its eight neighbours, so a cell without all of them has no value. A \
shaded relief has the colours of elevations in that light, and is transparent where there are no data. \
--method triangle takes the slope of one triangle instead. Where the coordinate reference system states the unit of elevations, slopes take it \
into account; otherwise it must be that of x and y, or --z-factor says what it is. Over degrees, slopes need it.

--tiles writes many rasters in one pass. A cell belongs to the raster that has its centre; with --buffer, rasters \
overlap. They have the same values as one raster: slopes have no seams. A raster gets its name when its cells are \
complete. One without data is not written, and a file of its name is removed. STAC items of rasters that are not in \
degrees on WGS 84 have no geometry, since no coordinates are transformed; all state their own system.

With --type, values are rounded to integers times --scale, plus --offset. A value that does not fit, or that would be \
taken for no data, is an error. An ESRI grid gets a .prj file beside it, as WKT 1.

--points draws points without a mesh: how many are in each cell, how dense they are, or the least, the \
greatest, the range, the mean and the standard deviation of their elevations or of an attribute. A point on a \
border is in the right or upper cell. Sums are exact.

--contours D writes lines instead of a raster, at all multiples of D (starting at --contour-base), as \
GeoJSON features with the properties elevation, unit (if it is known), is_closed, index (true for every fifth line from \
the base, or every N-th with --index N) and depression (true for closed lines around lower ground). --mask cuts lines at the polygons. --smooth smooths them; they stay within 0.45 D of \
their level and never cross. --min-length drops short lines. Higher ground is on the left of a line; a \
vertex on a level counts as above it. Open lines are held in memory, 16 bytes for each point; if --memory has no room for them, spdem fails. \
--contour-points bounds them: a line with that many points is cut and continued from its last point. \
Coordinates are those of the mesh, not degrees as RFC 7946 requires; .geojson states their EPSG code as GDAL \
and QGIS read it.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Write the raster or the contour lines of a triangle mesh, in bounded memory.
///
/// Reads a triangle mesh stream with elevations and writes a GeoTIFF, an ESRI grid, or lines as GeoJSON. The
/// triangle of each cell is decided exactly: there are no gaps along edges, and the raster does not depend on
/// the order of triangles.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// Stream of a triangle mesh; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    input: PathBuf,

    /// File for the raster or the lines; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    #[command(flatten)]
    outline: OutlineFlags,

    /// Fill cells without data, inside of the outline and the mask alone, from the nearest data in eight
    /// directions, at most this many cells away (1 to 256)
    #[arg(long, value_name = "CELLS", value_parser = clap::value_parser!(u32).range(1..=256))]
    fill: Option<u32>,

    /// Write how far the ground is below the water, where it is on the shore of this layer, and no data
    /// elsewhere: a layer of lakes and rivers whose levels are stated, as spfinalize --levels writes it.
    /// --stats counts the cells
    #[arg(long, value_name = "FILE", requires = "shore_width", conflicts_with_all = ["kind", "attribute", "points", "sample", "fill", "contours"])]
    below_water: Option<PathBuf>,

    /// Ground is on a shore up to this distance from the water, in world units
    #[arg(long, value_name = "W", requires = "below_water", value_parser = parse_positive)]
    shore_width: Option<f64>,

    /// GeoTIFF or ESRI ASCII grid; for lines, GeoJSON as one collection, or one feature a line [default: by
    /// the extension of the output, else tif or geojson]
    #[arg(long, value_name = "FORMAT", value_parser = named(FORMATS))]
    format: Option<Format>,

    /// Memory for tiles, and for triangles that wait for the outline of --concave; others wait in temporary
    /// files (see --temp-dir). A quarter of it is for vertices that are not final [default: 32M, beside
    /// these]. For contour lines, memory for open lines, too, which have no limit without it
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory: Option<u64>,

    #[command(flatten)]
    crs: CrsFlag,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    cells: CellFlags,

    #[command(flatten)]
    quantity: QuantityFlags,

    #[command(flatten)]
    sheets: SheetFlags,

    #[command(flatten)]
    contours: ContourFlags,

    #[command(flatten)]
    bends: BendFlags,

    #[command(flatten)]
    raster: RasterFlags,
}

/// What is written.
#[derive(Debug, Clone, Copy)]
enum Format {
    Raster(RasterFormat),
    Lines(LineFormat),
}

/// The values of `--format`.
const FORMATS: Names<Format> = &[
    ("tif", Format::Raster(RasterFormat::GeoTiff)),
    ("asc", Format::Raster(RasterFormat::Ascii)),
    ("geojson", Format::Lines(LineFormat::GeoJson)),
    ("geojsonl", Format::Lines(LineFormat::GeoJsonLines)),
];

/// Runs the tool.
///
/// # Errors
/// As [`dem::rasterize`] or [`crate::contours::contour`], and if the input or the output cannot be
/// opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    let started = Instant::now();
    if flags.format.is_none() {
        endings::check(&flags.output, &[endings::RASTER, endings::LINES])?;
    }
    if let Some(options) = flags.contours.options(&flags.outline, flags.memory, flags.crs.system()?)? {
        advise_on_memory(TOOL, contours::LACK_OF_MEMORY);
        let job = Job {
            input: &flags.input,
            output: &flags.output,
            format: flags.line_format()?,
            outline: &flags.outline,
            memory: flags.memory,
            stats: flags.stats,
            common: &flags.common,
        };
        return contours::run(&job, options, started, |message| notice(TOOL, &flags.common, message));
    }
    if flags.bends.bends {
        advise_on_memory(TOOL, "give less --memory");
        let job = bends::Job {
            input: &flags.input,
            output: &flags.output,
            crs: flags.crs.system()?,
            memory: flags.memory.unwrap_or(bends::MEMORY),
            stats: flags.stats,
            common: &flags.common,
        };
        return bends::run(&job, started, |message| notice(TOOL, &flags.common, message));
    }
    if flags.quantity.points {
        advise_on_memory(TOOL, "give less --memory");
        let job = points::Job {
            input: &flags.input,
            output: &flags.output,
            cells: &flags.cells,
            sheets: &flags.sheets,
            raster: &flags.raster,
            stats: flags.stats,
            common: &flags.common,
        };
        return Ok(points::run(&job, &flags.point_options()?, started)?);
    }
    advise_on_memory(TOOL, "take larger cells, or less --memory");
    let mut options = flags.options()?;
    let mut output =
        flags.sheets.create(&flags.output, options.raster.format, &flags.cells, &flags.raster)?;
    let mesh = Mesh::open(&flags.input)?;
    dem::check(mesh.header(), &options.quantity).map_err(|e| e.of_input(mesh.name()))?;
    let window = || dem::window(mesh.header()).map_err(|e| e.of_input(mesh.name()));
    let crs = options.crs.as_ref().unwrap_or(&mesh.header().crs);
    let grid = flags.cells.grid(crs, window)?;
    options.mask = flags.outline.mask(crs, flags.memory, |text| notice(TOOL, &flags.common, text))?;
    options.banks = flags.banks(crs)?;
    if let Some(mask) = options.mask.as_ref().filter(|_| flags.memory.is_some()) {
        options.memory = options.memory.saturating_sub(LINE_VERTEX_BYTES * mask.edges().count() as u64);
    }
    let needs = Needs { window: options.window(&grid, mesh.header()), beyond: options.beyond() };
    let mut reader = mesh.read(&needs)?.reader;
    let mut progress = Progress::new(&flags.common, "rasterizing", reader.header().points);
    let done = |vertices| progress.set(vertices);
    let stats = dem::rasterize(&mut reader, output.destination(), &grid, &options, done)?;
    drop(progress);
    let committed = output.commit(options.crs.as_ref().unwrap_or(&reader.header().crs))?;
    let messages = stats.notices.iter().cloned();
    let messages =
        messages.chain([cells::summary(&grid, stats.cells - stats.known)]).chain(committed.notice());
    messages.for_each(|message| notice(TOOL, &flags.common, &message));
    flags.stats.print(|| {
        let report = Report::of(started.elapsed()).counts(counts(&stats, committed.bytes));
        // A raster breaks no ties.
        report.counts(stats.predicates.rows().into_iter().take(5))
    });
    Ok(())
}

impl Flags {
    fn point_options(&self) -> Result<PointOptions, Error> {
        Ok(PointOptions {
            statistic: self.quantity.statistic()?,
            attribute: self.quantity.attribute.clone(),
            memory: self.memory.unwrap_or(MEMORY),
            raster: self.raster.options(self.format()?)?,
            crs: self.crs.system()?,
        })
    }

    fn options(&self) -> Result<Options, Error> {
        let quantity = self.quantity.quantity()?;
        let format = self.format()?;
        match quantity {
            Quantity::Hillshade(_) => self.raster.check_bytes()?,
            Quantity::ShadedRelief(..) if format == RasterFormat::Ascii => {
                return Err(Error::usage(
                    "a shaded relief has colours, which an ESRI grid cannot hold: write .tif",
                ));
            }
            Quantity::ShadedRelief(..) => self.raster.check_bytes()?,
            _ => {}
        }
        // Few vertices are live, but of a mesh that is not in the order of a stream.
        let vertices_memory = self.memory.map(|memory| (memory / 4).max((memory / 2).min(1 << 20)));
        Ok(Options {
            quantity,
            sample: self.quantity.sample(),
            natural: self.quantity.is_natural(),
            method: self.quantity.method(),
            z_factor: self.quantity.z_factor,
            kill: self.outline.kill()?,
            concave: self.outline.concave()?,
            mask: None,
            banks: None,
            fill: self.fill,
            memory: self.memory.unwrap_or(MEMORY) - vertices_memory.unwrap_or(0),
            vertices_memory,
            raster: self.raster.options(format)?,
            crs: self.crs.system()?,
        })
    }

    /// The shores of `--below-water`.
    fn banks(&self, crs: &Crs) -> Result<Option<Arc<Banks>>, Error> {
        let Some((path, width)) = self.below_water.as_ref().zip(self.shore_width) else { return Ok(None) };
        let (banks, notices) =
            Banks::read(slice::from_ref(path), width, crs, self.memory.unwrap_or(u64::MAX))?;
        notices.iter().for_each(|text| notice(TOOL, &self.common, text));
        Ok(Some(Arc::new(banks)))
    }

    /// The format of `--format`, or of the ending of the output.
    fn named_format(&self) -> Option<Format> {
        let raster = || of_ending(cells::ENDINGS, &self.output).map(Format::Raster);
        let lines = || of_ending(contours::ENDINGS, &self.output).map(Format::Lines);
        self.format.or_else(raster).or_else(lines)
    }

    fn line_format(&self) -> Result<LineFormat, Error> {
        match self.named_format() {
            Some(Format::Lines(format)) => Ok(format),
            Some(_) => Err(Error::usage("lines are no raster: write them to NAME.geojson or NAME.geojsonl")),
            None => Ok(LineFormat::GeoJson),
        }
    }

    fn format(&self) -> Result<RasterFormat, Error> {
        match self.named_format() {
            Some(Format::Raster(format)) => Ok(format),
            Some(_) => Err(Error::usage("GeoJSON holds lines, not rasters: add --contours D")),
            None => Ok(RasterFormat::GeoTiff),
        }
    }
}

fn counts(stats: &Stats, output_bytes: u64) -> [Row<u64>; 14] {
    [
        ("input (bytes)", "input_bytes", stats.input_bytes),
        ("vertices", "vertices", stats.vertices),
        ("triangles", "triangles", stats.triangles),
        ("triangles with a long edge", "killed", stats.killed),
        ("triangles outside of the outline", "outside", stats.outside),
        ("triangles with an unknown value", "unknown", stats.unknown),
        ("width (live vertices)", "width", stats.width),
        ("cells", "cells", stats.cells),
        ("cells with data", "known", stats.known),
        ("cells that were filled", "filled", stats.filled),
        ("tiles sent to the disk", "spilled", stats.spilled),
        ("temporary file (bytes)", "spilled_bytes", stats.spilled_bytes),
        ("output (bytes)", "output_bytes", output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}
