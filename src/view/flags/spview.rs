//! `spview`: flags.

mod outputs;
mod solid;
mod tee;

use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use clap::Parser;

use crate::{Extent, Fill, Form, Moments, Options, Picture, When};
use outputs::{Every, Format, Moment, Outputs};
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::Light;
use spmesh_shell::cells::window_of;
use spmesh_shell::crs::CrsFlag;
use spmesh_shell::outline::OutlineFlags;
use spmesh_shell::progress::Progress;
use spmesh_shell::{Common, Names, advise_on_memory, named, notice, open_input, open_within, parse_numbers};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Header, Kind, StreamReader, check_part};
use tee::{Passed, Tee};

const TOOL: &str = "spview";

/// The direction of the light by default.
const LIGHT: &str = "315,45";

const EXAMPLES: &str = "\
Examples:
  A terrain as a picture, coloured by elevation and lit from the north-west:
    spview terrain.spm -o terrain.png
  The same as a page for browsers, with pan and zoom:
    spview terrain.spm -o terrain.html
  Without the long triangles around a survey that is no rectangle, and only in a park:
    spview --concave 30 terrain.spm -o terrain.png
    spview --mask park.geojson terrain.spm -o park.png
  Only the triangles of a part, for print:
    spview --fill none --bounds 4000,7000,4100,7080 terrain.spm -o part.svg
  When each cell of a finalized stream got its first and last point:
    spfinalize tiles/*.laz | spview -o order.png
  A triangulation after two fifths of its triangles, with its live vertices:
    spview --at 0.4 terrain.spm -o front.png
  Pictures of a pipe at work, one per million points:
    spfinalize big.laz | spview --tee --snapshot every=1000000 -o shots/%04d.png | spdelaunay2d -o big.spm
  A control mesh, seen obliquely:
    splinefit mesh spline.spm | spview --oblique -o control.svg
  The centroid triangulation of configurations, and the link of a pair of knots:
    spview --order 2 knots.spm -o order2.svg
    spview --set 3,7 knots.spm -o link.svg
  The surface of a molecule, from the y axis and a little above:
    tess3 1abc.cif --sasa --probe 0 -o 1abc.ply && spview --eye 90,20 1abc.ply -o 1abc.png
  Knots that were pulled apart, as two each, in their triangulation:
    configgen --pull-apart all knots.txt | spview --apart --order 1 -o pulled.svg
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
Up to 20,000 triangles or points are drawn one by one. More are painted as pixels, with memory proportional \
to the picture: some 64 bytes for each pixel. The picture needs the bounds of the stream. If the header does \
not state them, a file is read twice, and a long pipe needs --bounds.

Streams in the plane and points in space are seen from above. Colours of time show the position in the \
stream; a cell shows the time of its first point in the middle and that of its last point at the border. \
Units are those of the coordinates.

Colours of elevations and attributes span 2 to 98 percent of the visible values, by area; tips at the ends of the \
colour bar stand for values beyond, and the legend states the range of all values.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input, 5 not enough \
memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Length of the input buffer. Units: bytes.
const BUFFER_LEN: usize = 1 << 18;

/// Draw a stream as a picture: a mesh, points and their cells, or configurations.
///
/// Reads a stream and writes SVG, PNG, or an HTML page that pans and zooms. By default it draws the relief of
/// a terrain, the edges of other triangle meshes, the cells of finalized points, and the knots and centroid
/// triangulation of configurations. With --tee, it draws a stream that passes through a pipe. A surface in a
/// PLY file, such as tess3 makes of a molecule, is drawn in space.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    /// Stream of points, of a triangle mesh, or of configurations, or a surface in PLY; - is stdin
    #[arg(value_name = "STREAM", default_value = "-")]
    input: PathBuf,

    /// File for the picture; - is stdout. With --snapshot, a name with one %d, or %04d for numbers of four
    /// digits
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// SVG, PNG, or an HTML page that pans and zooms [default: by the extension of the output, else svg]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<Format>,

    /// What triangles or points show [default: relief where there are elevations, time for points]
    #[arg(long, value_name = "WHAT", value_parser = named(FILLS))]
    fill: Option<Fill>,

    /// Show an attribute of the points: its name, with :1, :2 ... for one of several components. One of three
    /// components, such as rgb, is taken as a colour
    #[arg(long, value_name = "NAME", conflicts_with_all = ["fill", "oblique"])]
    colour_by: Option<String>,

    /// Whether to draw the edges of triangles
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    #[arg(value_parser = named(&[("auto", When::Auto), ("always", When::Always), ("never", When::Never)]))]
    edges: When,

    /// Draw finalized points without their cells
    #[arg(long)]
    no_cells: bool,

    /// Draw an oblique view instead of one from above
    #[arg(long)]
    oblique: bool,

    /// Direction of the light, in degrees: clockwise from north, and above the horizon
    #[arg(long, value_name = "AZIMUTH,ALTITUDE", value_parser = parse_numbers::<2>, default_value = LIGHT, allow_hyphen_values = true)]
    light: [f64; 2],

    #[command(flatten)]
    outline: OutlineFlags,

    /// The percentiles of the visible elevations or values that the colours span, or none for all of them;
    /// values beyond have the colours of the ends, and the legend shows it [default: 2,98; none with --at or
    /// --snapshot]
    #[arg(long, value_name = "LOW,HIGH|none", value_parser = parse_stretch, conflicts_with = "range")]
    stretch: Option<Stretch>,

    /// The range of elevations or values that the colours span, instead of percentiles; those beyond have the
    /// colours of the ends
    #[arg(long, value_name = "LOW,HIGH", value_parser = parse_numbers::<2>, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,

    /// Use a diverging colour map with its middle at this elevation
    #[arg(long, value_name = "Z", allow_negative_numbers = true)]
    middle: Option<f64>,

    #[command(flatten)]
    crs: CrsFlag,

    /// Width of the picture in pixels
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(320..=8192))]
    width: u32,

    /// The part of the plane to draw, in world coordinates; of a mesh in parts, only the parts there are read
    /// [default: all]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse_numbers::<4>, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,

    /// Draw any number of triangles or points one by one
    #[arg(long, conflicts_with = "raster")]
    vector: bool,

    /// Paint any number of triangles or points as pixels
    #[arg(long)]
    raster: bool,

    /// Draw this moment instead of the end: a part of the stream, such as 0.4, or a number of triangles or
    /// points
    #[arg(long, value_name = "MOMENT", value_parser = outputs::parse_moment)]
    at: Option<Moment>,

    /// Draw further pictures, one after every N triangles or points
    #[arg(long, value_name = "every=N", value_parser = outputs::parse_every)]
    snapshot: Option<Every>,

    /// Copy the stream to stdout, byte for byte
    #[arg(long)]
    tee: bool,

    /// For configurations: draw the centroid triangulation of this order [default: the greatest]
    #[arg(long, value_name = "K", conflicts_with = "set", value_parser = clap::value_parser!(u16).range(1..))]
    order: Option<u16>,

    /// For configurations: draw the link of this set of knots
    #[arg(long, value_name = "KNOT,KNOT,...", value_delimiter = ',')]
    set: Option<Vec<u32>>,

    /// For configurations: draw the copies of a knot around their place, instead of on each other
    #[arg(long)]
    apart: bool,

    /// For surfaces in PLY: where the eye is, in degrees counterclockwise from the x axis, and above the
    /// plane of x and y [default: 30,20]
    #[arg(long, value_name = "AZIMUTH,ALTITUDE", value_parser = parse_numbers::<2>)]
    #[arg(allow_hyphen_values = true)]
    eye: Option<[f64; 2]>,

    #[command(flatten)]
    common: Common,
}

/// The value of `--stretch`: two percentiles, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch(Option<[f64; 2]>);

fn parse_stretch(text: &str) -> std::result::Result<Stretch, String> {
    if text == "none" {
        return Ok(Stretch(None));
    }
    match parse_numbers(text)? {
        [low, high] if 0.0 <= low && low < high && high <= 100.0 => Ok(Stretch(Some([low, high]))),
        _ => Err("expected two percentages from 0 to 100, the lesser first, or none".to_string()),
    }
}

/// The values of `--fill`.
const FILLS: Names<Fill> = &[
    ("none", Fill::None),
    ("elevation", Fill::Elevation),
    ("hillshade", Fill::Hillshade),
    ("relief", Fill::Relief),
    ("time", Fill::Time),
];

/// Runs the tool.
///
/// # Errors
/// As [`crate::draw`], and if the input or an output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "take less --width, or --raster");
    let mut options = flags.options()?;
    let is_numbered = flags.snapshot.is_some();
    let mut outputs = Outputs::new(&flags.output, flags.format, is_numbered, flags.tee)?;
    let (mut input, name, whole) = open_within(&flags.input, |header| flags.needed(header))?;
    options.whole = whole;
    let head = solid::head(&mut input).map_err(|e| Error::io("reading", e).of_input(&name))?;
    let is_surface = solid::is_surface(&head);
    let input = Cursor::new(head).chain(input);
    if is_surface {
        outputs.put(&solid::draw(&flags, input, &name)?)?;
        outputs.finish()?;
        return Ok(());
    }
    if flags.eye.is_some() {
        return Err(Error::usage("--eye is for surfaces in PLY, this is none").of_input(name).into());
    }
    let input = BufReader::with_capacity(BUFFER_LEN, input);
    draw_stream(&flags, options, outputs, input, name)
}

/// Draws a stream, and passes it on if `--tee` is given.
fn draw_stream(
    flags: &Flags,
    mut options: Options,
    mut outputs: Outputs,
    input: impl Read + 'static,
    name: String,
) -> anyhow::Result<()> {
    let passed = flags.tee.then(Passed::to_stdout).transpose()?;
    let input: Box<dyn Read> = match &passed {
        Some(passed) => Box::new(Tee::new(input, passed.clone())),
        None => Box::new(input),
    };
    let mut reader = StreamReader::new(input, name)?;
    let beyond = options.concave.map(|_| "a concave outline");
    check_part(reader.header(), beyond).map_err(|e| e.of_input(reader.name()))?;
    // The header is right.
    passed.iter().for_each(Passed::confirm);
    let extent = flags.extent(&reader)?;
    let crs = options.crs.as_ref().unwrap_or(&reader.header().crs);
    options.mask = flags.outline.mask(crs, None, |text| notice(TOOL, &flags.common, text))?;
    options.extent = extent.and_then(|extent| extent.bounds);
    let moments =
        Moments { at: flags.moment(&reader, extent)?, every: flags.snapshot.map(|Every(count)| count) };
    let mut progress = Progress::new(&flags.common, "drawing", reader.header().points);
    let mut take = |picture: &Picture| outputs.put(picture);
    let drawn = crate::draw(&mut reader, &options, moments, &mut take, |count| {
        passed.iter().for_each(Passed::confirm);
        progress.set(count);
    });
    drop(progress);
    drawn?;
    drop(reader);
    let summary = outputs.finish()?;
    // The end of the stream waits for the pictures: if one fails, the next program must not see a whole
    // stream.
    passed.iter().try_for_each(Passed::finish)?;
    if let Some(summary) = summary {
        notice(TOOL, &flags.common, &summary);
    }
    Ok(())
}

impl Flags {
    fn options(&self) -> Result<Options> {
        if !self.light.iter().all(|angle| angle.is_finite()) {
            return Err(Error::usage("--light takes two angles in degrees"));
        }
        if self.middle.is_some_and(|middle| !middle.is_finite()) {
            return Err(Error::usage("--middle takes an elevation"));
        }
        if self.range.is_some_and(|[low, high]| !(low < high && low.is_finite() && high.is_finite())) {
            return Err(Error::usage("--range takes the least elevation and the greatest"));
        }
        let name = Path::new(&self.input).file_name().map(|name| name.to_string_lossy().into_owned());
        let [azimuth, altitude] = self.light;
        let defaults = Options::new(name.filter(|name| name != "-").unwrap_or("stdin".to_string()));
        Ok(Options {
            fill: self.fill,
            colour_by: self.colour_by.clone(),
            edges: self.edges,
            cells: !self.no_cells,
            form: match (self.vector, self.raster) {
                (true, _) => Form::Vector,
                (_, true) => Form::Raster,
                _ => Form::Auto,
            },
            width: self.width,
            bounds: self.bounds.map(window_of).transpose()?,
            oblique: self.oblique,
            light: Light::from(azimuth, altitude),
            kill: self.outline.kill()?,
            concave: self.outline.concave()?,
            range: self.range,
            stretch: match self.stretch {
                Some(Stretch(percents)) => percents,
                // Colours mean the same in all pictures of a stream.
                None if self.at.is_some() || self.snapshot.is_some() => None,
                None => defaults.stretch,
            },
            middle: self.middle,
            crs: self.crs.system()?,
            order: self.order.map(usize::from),
            set: self.set.clone(),
            apart: self.apart,
            ..defaults
        })
    }

    /// The box whose triangles a picture of `--bounds` shows; `None` if other triangles decide what it shows:
    /// moments and colours of time count all of them, and a concave outline begins at the border of the mesh.
    fn needed(&self, header: &Header) -> Option<Bounds> {
        let shows_all = self.outline.concave().is_ok_and(|length| length.is_some())
            || self.at.is_some()
            || self.snapshot.is_some()
            || self.tee
            || self.fill == Some(Fill::Time)
            || self.colour_by.is_some();
        // Colours span the elevations that the header states. Without elevations, they may be those of time.
        let is_known = header.bounds.is_some() && header.has_elevation;
        let [x, y, max_x, max_y] = self.bounds.filter(|_| is_known && !shows_all)?;
        Some(Bounds::over([x, y], [max_x, max_y]))
    }

    /// Reads a file to its end, if the header lacks the bounds or counts that the flags need.
    fn extent<R: Read>(&self, reader: &StreamReader<R>) -> Result<Option<Extent>> {
        let header = reader.header();
        if header.kind.has_knots()
            || header.kind.is_4d()
            || !self.input.metadata().is_ok_and(|file| file.is_file())
        {
            return Ok(None);
        }
        let is_counted = header.kind == Kind::Points && header.points.is_some();
        let needs_count = matches!(self.at, Some(Moment::Part(_))) && !is_counted;
        let needs_bounds = header.bounds.is_none() && (self.bounds.is_none() || self.oblique);
        if !(needs_count || needs_bounds) {
            return Ok(None);
        }
        let (input, name) = open_input(&self.input)?;
        let mut reader = StreamReader::new(BufReader::with_capacity(BUFFER_LEN, input), name)?;
        Extent::read(&mut reader).map(Some)
    }

    /// The number of triangles or points that `--at` means.
    fn moment<R: Read>(&self, reader: &StreamReader<R>, extent: Option<Extent>) -> Result<Option<u64>> {
        let part = match self.at {
            None => return Ok(None),
            Some(Moment::Count(count)) => return Ok(Some(count)),
            Some(Moment::Part(part)) => part,
        };
        let header = reader.header();
        let is_mesh = header.kind != Kind::Points;
        let total = match extent {
            Some(Extent { totals, .. }) if is_mesh => Some(totals.simplices),
            Some(Extent { totals, .. }) => Some(totals.points),
            None => header.points.filter(|_| !is_mesh),
        };
        let Some(total) = total else {
            let what = format!(
                "--at {part} needs to know how long the stream is: give a number, or a file instead of a pipe"
            );
            return Err(Error::usage(what).of_input(reader.name()));
        };
        Ok(Some((part * total as f64).round() as u64))
    }
}
