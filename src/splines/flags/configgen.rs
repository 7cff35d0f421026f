//! `configgen`: flags.

mod report;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;

use crate::configgen::{
    Border, BoxName, Flips, Made, Options, Places, RuleName, Sites, SpecialKind, read_features, read_patches,
};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::source::{name_of, read_values};
use spmesh_shell::compression::Compression;
use spmesh_shell::endings;
use spmesh_shell::{Common, StatsFlag, advise_on_memory, named, notice, open_held, progress::Progress};

const TOOL: &str = "configgen";

const EXAMPLES: &str = "\
Examples:
  Configurations up to degree 2, for splines of degree 2 or, by their links, 3:
    configgen --degree 2 knots.csv -o knots2.spm
  Of a LIDAR tile in which points that coincide are one knot; the counts of each degree:
    spfinalize tile.laz | spdelaunay2d | configgen --degree 1 --stats -o tile1.spm
  Splines that sum to one up to the border and interpolate at its corners:
    configgen --degree 2 --boundary clamped knots.txt -o clamped.spm
  Edges along level lines of the third coordinate; the centroid triangulation of order 2:
    configgen --degree 1 --rule data knots.xyz --centroids -o centroids.spm
  From a triangulation with 100 random flips, by random triangulations of links:
    configgen --degree 3 --flip random:100:7 --rule random --seed 7 knots.txt -o random.spm
  With a crease along a ridge of knots, and a sharp corner:
    printf 'crease 4 8 15 16\\ncorner 23\\n' > sharp.txt; configgen --features sharp.txt knots.txt -o sharp.spm
  Box splines on two grids that meet at an angle; lines are X Y, two steps, and the numbers of cells:
    printf '0 0  1 0  0 1  8 6\\n8 0  1 1  0 1  8 6\\n' > grids.txt; configgen --patches grids.txt -o boxes.spm
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
A configuration of degree k is three knots B and k knots I; with the rule delaunay, those inside of the \
circle through B. The configurations of each degree triangulate the links of the degree before, by a rule. \
The start is the Delaunay triangulation, or with the rules lifted:... the regular one; a mesh that is not \
the Delaunay triangulation of its vertices is the start itself.

Rules: delaunay; lifted:heights (values are those of a strictly convex function) and lifted:weights (power \
circles), which give projective configurations; min-weight; ear; fan; random; aligned:ANGLE (edges near a \
direction, in degrees counterclockwise from the x axis); data (edges along which values differ least or, \
where they are gradients, slopes). Values are elevations, or those of --values.

Special configurations of degree 1 are for quadratic splines. --box zp cuts the links of knots amid four \
unit squares so that half the sum of the B-splines of the sides of a square is a box spline. --patches does \
the same on grids, with the knots of the input, if there is one, between them. --features reads lines of a \
word and ids: corner (splines interpolate there), crease (sharp up to its ends, which are interpolated), \
smooth-crease (smooth at its ends) or linear (values along it are interpolated linearly). Segments between \
consecutive ids become edges of the triangulation; they may touch at knots only. Patches may touch along \
whole sides. In both files # starts a comment. --stats counts the functions that splines are made of.

Knots are numbered in the order of the input, from 0. Knots at one place are repeated knots, which lowers \
the smoothness of splines there; spdelaunay2d makes one of them. Knots that are added come last: copies, \
then those amid the edges of smooth creases. Knots of --patches come first, row by row.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, knots on one line, or too few of them, 3 malformed \
or truncated input, 4 a link that theory excludes, 5 not enough memory, 6 input of another \
version of spmesh, 141 output closed by its reader.";

/// Delaunay configurations of any degree, and their generalisation.
///
/// Reads points in the plane (text, csv, LAS, LAZ, COPC, SPA, SPB, NPY, vertices of PLY, OBJ and VTK, point
/// streams) or a triangle mesh stream, and writes the configurations of all degrees up to --degree, which
/// define bivariate splines. The result is exact, even if points are cocircular, collinear or coincident.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
#[command(mut_arg("stats", |stats| stats.help("Print what the run did on stderr, with the counts of each degree")))]
pub struct Flags {
    /// Files of points, read as one input, or one triangle mesh; - is stdin [default: -, or none with
    /// --patches]
    #[arg(value_name = "FILE")]
    inputs: Vec<PathBuf>,

    /// Where the configurations go; - is stdout
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,

    /// Highest degree
    #[arg(short, long, value_name = "K", default_value_t = 1)]
    degree: u32,

    /// How links are triangulated: delaunay, lifted:heights, lifted:weights, min-weight, ear, fan, random,
    /// data or aligned:ANGLE
    #[arg(long, value_name = "RULE", default_value = "delaunay")]
    rule: RuleName,

    /// Values of the knots for rules that need some, instead of elevations: lines of one number, or of two
    /// for gradients
    #[arg(long, value_name = "FILE")]
    values: Option<PathBuf>,

    /// Flip edges of the start triangulation: random:N:SEED, or aligned:ANGLE for those that come nearer to a
    /// direction
    #[arg(long, value_name = "FLIPS")]
    flip: Option<Flips>,

    /// Repeat knots on the border, so that splines sum to one up to it: corners as often as the degree needs,
    /// or all of them once, which is for degree 1
    #[arg(long, value_name = "clamped|pulled-apart", hide_possible_values = true)]
    #[arg(value_parser = named(&[("clamped", Border::Clamped), ("pulled-apart", Border::PulledApart)]))]
    boundary: Option<Border>,

    /// Make two of each of these knots: all, boundary, or ids between commas. Their links are triangulated
    /// from each other, so that splines of degree 2 interpolate there
    #[arg(long, value_name = "KNOTS")]
    pull_apart: Option<Places>,

    /// Make box splines where knots are on the integer grid, or on --patches: zp, optionally with :falling
    /// for the other diagonal of squares and :upright for the other diagonal of links
    #[arg(long = "box", value_name = "zp[:falling][:upright]", conflicts_with = "features")]
    boxes: Option<BoxName>,

    /// Grids with box splines: lines X Y UX UY VX VY COLUMNS ROWS; - is stdin
    #[arg(long, value_name = "FILE", conflicts_with = "features")]
    patches: Option<PathBuf>,

    /// Sharp corners, creases and linear elements: lines of corner, crease, smooth-crease or linear, and
    /// ids; - is stdin
    #[arg(long, value_name = "FILE")]
    features: Option<PathBuf>,

    /// Seed of --rule random, and of flips without one of their own
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,

    /// Write the centroid triangulation of the highest two degrees as a triangle mesh stream instead
    #[arg(long)]
    centroids: bool,

    #[command(flatten)]
    compression: Compression,

    #[command(flatten)]
    stats: StatsFlag,

    #[command(flatten)]
    common: Common,
}

/// Runs the tool.
///
/// # Errors
/// As [`crate::configgen::read_sites`], [`crate::configgen::make`] and the writers.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    Ok(flags.run()?)
}

impl Flags {
    fn run(&self) -> Result<()> {
        let started = Instant::now();
        advise_on_memory(TOOL, "take fewer knots or a lower degree");
        endings::check(&self.output, &[endings::STREAM])?;
        // Fail before the computation if the output cannot be created.
        let mut output = Output::create(&self.output, true)?;
        let options = self.options()?;
        let mut progress = Progress::new(&self.common, "reading", None);
        let sites = self.sites(|points| progress.set(points))?;
        let read_time = started.elapsed();
        drop(progress);
        sites.notices.iter().for_each(|text| self.notice(text));
        let progress = Progress::waiting(&self.common, "configurations");
        let made = crate::configgen::make(sites, &options)?;
        let write_started = Instant::now();
        self.write(&made, &mut output)?;
        let output_bytes = output.bytes_written();
        output.commit()?;
        let times =
            report::Times { read: read_time, write: write_started.elapsed(), total: started.elapsed() };
        drop(progress);
        report::notices(&made.report, &options).iter().for_each(|text| self.notice(text));
        report::print(self.stats, &made, &options, &times, output_bytes)
    }

    fn options(&self) -> Result<Options> {
        if self.values.is_some() && !self.rule.needs_values() {
            return Err(Error::usage("--values is for the rules lifted:heights, lifted:weights and data"));
        }
        let files =
            [("--values", &self.values), ("--patches", &self.patches), ("--features", &self.features)];
        let mut of_stdin = files.iter().filter(|(_, path)| path.as_deref().is_some_and(is_stdin));
        if let Some((flag, _)) = of_stdin.next()
            && (of_stdin.next().is_some() || self.inputs().iter().any(|path| is_stdin(path)))
        {
            return Err(Error::usage(format!(
                "knots, or another file, and {flag} cannot both come from stdin"
            )));
        }
        let values = read(self.values.as_ref(), read_values)?;
        let boxes = self.boxes.unwrap_or_default();
        let special = match (read(self.patches.as_ref(), read_patches)?, &self.boxes) {
            (Some(patches), _) => Some(SpecialKind::Patches(patches, boxes.0)),
            (None, Some(_)) => Some(SpecialKind::Boxes(boxes.0)),
            (None, None) => read(self.features.as_ref(), read_features)?.map(SpecialKind::Features),
        };
        Ok(Options {
            degree: self.degree as usize,
            rule: self.rule,
            seed: self.seed,
            flips: self.flip,
            border: self.boundary.unwrap_or_default(),
            pull_apart: self.pull_apart.clone(),
            special,
            values,
        })
    }

    /// The inputs: stdin by default, if knots are needed.
    fn inputs(&self) -> Vec<PathBuf> {
        match self.inputs.is_empty() && self.patches.is_none() {
            true => vec!["-".into()],
            false => self.inputs.clone(),
        }
    }

    fn sites(&self, done: impl FnMut(u64)) -> Result<Sites> {
        match (&self.inputs[..], &self.patches) {
            ([], Some(patches)) => Ok(Sites::none(name_of(patches))),
            _ => crate::configgen::read_sites(&self.inputs(), done),
        }
    }

    fn write(&self, made: &Made, output: &mut Output) -> Result<()> {
        let compress = self.compression.of_stream();
        if self.centroids {
            let mesh = made.centroids()?;
            return crate::configgen::write_centroids(&made.knots, &made.frame, &mesh, compress, output);
        }
        made.write(compress, output)
    }

    fn notice(&self, message: &str) {
        notice(TOOL, &self.common, message);
    }
}

fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Parses a file, if there is one.
fn read<T>(path: Option<&PathBuf>, parse: impl FnOnce(Box<dyn Read>) -> Result<T>) -> Result<Option<T>> {
    let parsed = path.map(|path| {
        let (input, name) = open_held(path)?;
        parse(input).map_err(|e| e.of_input(name))
    });
    parsed.transpose()
}
