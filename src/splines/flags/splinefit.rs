//! `splinefit`: subcommands.

mod eval;
mod eval_format;
mod fit;
mod info;
mod mesh;
mod report;

use std::path::Path;

use clap::{Parser, Subcommand};

use spmesh_base::error::{Error, Result};
use spmesh_shell::{Common, advise_on_memory, notice};

const TOOL: &str = "splinefit";

const EXAMPLES: &str = "\
Examples:
  A spline for a LIDAR tile; the program searches for knots:
    splinefit fit --keep-class 2 tile.laz -o tile.spline.spm
  Within 0.1 of all points, with 20,000 knots at most, and statistics:
    splinefit fit --tol 0.1 --max-knots 20000 --stats points.txt -o fine.spline.spm
  Over given knots, smoothed by generalised cross-validation:
    configgen --boundary pulled-apart knots.txt | splinefit fit --knots - --lambda gcv points.txt -o smooth.spline.spm
  Without gross errors, which are listed:
    splinefit fit --robust tukey --rejected errors.txt points.txt -o terrain.spline.spm
  A raster of elevations, and one of slopes:
    splinefit eval terrain.spline.spm --step 0.5 -o terrain.tif
    splinefit eval terrain.spline.spm --step 0.5 --kind slope -o slope.tif
  Values at sites:
    splinefit eval terrain.spline.spm --at sites.txt
  Properties of the spline, and residuals of points:
    splinefit info terrain.spline.spm points.txt
  Its control mesh for other programs:
    splinefit mesh terrain.spline.spm | spconvert --to ply -o control.ply
    splinefit mesh terrain.spline.spm -o control.svg
";

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "
A spline is a sum of functions over configurations of knots. Its domain is where all functions sum to one; \
with a border that is pulled apart, that is the convex hull of the knots. There splines of degree k \
reproduce polynomials of degree k. Outside of the domain nothing is evaluated: sites get nan, cells no data.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, or points that do not determine a spline, 3 \
malformed or truncated input, 5 not enough memory, 6 input of another version of spmesh, \
141 output closed by its reader.";

/// Bivariate splines fitted to scattered points.
///
/// Reads points with elevations, and writes a stream of a spline: knots, configurations, functions and
/// coefficients. It evaluates such streams at sites and in cells of rasters.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = format!("{EXAMPLES}{NOTES}"))]
pub struct Flags {
    #[command(subcommand)]
    action: Action,

    #[command(flatten)]
    common: Common,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
enum Action {
    /// Fit a spline to points
    Fit(Box<fit::Flags>),
    /// Evaluate a spline at sites, or in the cells of a raster
    Eval(Box<eval::Flags>),
    /// Report domain, condition, smoothness and residuals of a spline
    Info(info::Flags),
    /// Write the control mesh of a spline: Greville sites with coefficients as elevations, as a triangle mesh
    /// or a picture
    Mesh(mesh::Flags),
}

/// Runs the tool.
///
/// # Errors
/// As [`crate::splinefit`].
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "take fewer knots");
    Ok(match &flags.action {
        Action::Fit(action) => action.run(&flags.common),
        Action::Eval(action) => action.run(&flags.common),
        Action::Info(action) => action.run(&flags.common),
        Action::Mesh(action) => action.run(),
    }?)
}

/// Refuses two inputs from stdin. Each input comes with its name in messages.
fn check_stdin<'a>(inputs: impl IntoIterator<Item = (&'a str, &'a Path)>) -> Result<()> {
    let mut of_stdin = inputs.into_iter().filter(|(_, path)| path.as_os_str() == "-");
    match (of_stdin.next(), of_stdin.next()) {
        (Some((first, _)), Some((second, _))) => {
            Err(Error::usage(format!("{first} and {second} cannot both come from stdin")))
        }
        _ => Ok(()),
    }
}

fn say(common: &Common, message: &str) {
    notice(TOOL, common, message);
}
