//! Points of four dimensions: lines of x y z t, grids, and volumes that change over time (NRRD, NIfTI, raw),
//! and streams, whole or chosen by a condition and at random.
//!
//! Coordinates are grid indices unless the world is asked for, so that they are integers and cells are
//! cospherical exactly where the grid is. What is chosen depends on the input and the seed alone.

mod condition;
mod data;
mod lattice;
mod nifti;
mod nrrd;
mod opening;
mod raw;
mod sample;
mod scan;
mod select;
mod stream;
mod text;
mod volume;

use std::path::PathBuf;

pub use condition::Condition;
pub use raw::{RawLayout, parse_sizes};
pub use sample::Share;

use self::lattice::Lattice;
use self::scan::Supply;
use super::origin::{Origin, name_of};
use spmesh_core::error::{Error, Result};
use spmesh_model::cells4::Point4;

/// Points of four dimensions, in the order of the input: in that of volume files, where x changes fastest, if
/// they are sites of a grid. Equal points of a text stay as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Selected4 {
    /// The points, finite; none is -0.
    pub points: Vec<Point4>,
    /// A value for each point, if the input has values.
    pub values: Option<Vec<f64>>,
    /// What messages call the input.
    pub name: String,
    /// Points of the input, whether they were wanted or not.
    pub sites: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Which points are wanted, and of what.
#[derive(Debug, Clone)]
pub struct Request {
    /// Where they come from.
    pub from: From4,
    /// What the coordinates of volumes are.
    pub spacing: Spacing,
    /// Which of them are wanted.
    pub selection: Selection,
    /// Where spools go; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// Where points come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum From4 {
    /// A file that tells what it is; "-" is standard input.
    File(PathBuf),
    /// A file that holds nothing but the values of a volume.
    Raw(PathBuf, RawLayout),
    /// A full grid of so many sites along x, y, z and t, without values.
    Grid([u64; 4]),
}

/// What the coordinates of volumes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spacing {
    /// Grid indices, from 0.
    #[default]
    Index,
    /// What the file states for them, in its units, rounded to f64.
    World,
}

/// Which points are wanted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selection {
    /// Only points that fulfil it.
    pub condition: Option<Condition>,
    /// Whether points whose value is missing (NaN) are wanted, too.
    pub keep_nan: bool,
    /// Only so many of them, chosen at random.
    pub share: Option<Share>,
    /// What decides on the choice.
    pub seed: u64,
}

/// Reads or makes the points that are asked for.
///
/// Cost: a pass over the input, and a second one if points are chosen at random from a file; from a whole
/// grid they are chosen without a pass. Memory: what is kept, in 32 bytes per point, 8 per value, and some 24
/// more for each that is chosen at random. An input that cannot be read twice is copied to an unlinked
/// temporary file.
///
/// # Errors
/// If the input cannot be read, is malformed (with the position), or of no known format; if what is asked for
/// does not go with it, or would be more than [`spmesh_core::limits`] allows.
pub fn read_points4(request: &Request) -> Result<Selected4> {
    let mut warnings = Vec::new();
    let (supply, name) = match &request.from {
        From4::Grid(lens) => {
            let [x, y, z, t] = lens;
            let name = format!("grid {x}x{y}x{z}x{t}");
            let lattice = Lattice::new(*lens).map_err(|e| e.of_input(&name))?;
            (Supply::Grid(lattice), name)
        }
        From4::File(path) | From4::Raw(path, _) => {
            let temp_dir = request.temp_dir.clone().unwrap_or_else(std::env::temp_dir);
            let origin = Origin::new(path, &temp_dir, &mut warnings)?;
            let is_stdin = path.as_os_str() == "-";
            let name = name_of(path);
            let path = (!is_stdin).then_some(path.as_path());
            let supply = match &request.from {
                From4::Raw(_, layout) => raw::open(origin, path, layout).map(Supply::Volume),
                _ => opening::open(origin, path, &mut warnings),
            };
            (supply.map_err(|e| e.of_input(&name))?, name)
        }
    };
    read(supply, request, name, warnings)
}

fn read(mut supply: Supply, request: &Request, name: String, warnings: Vec<String>) -> Result<Selected4> {
    if request.spacing == Spacing::World {
        supply.place_in_world().map_err(|e| e.of_input(&name))?;
    }
    let mut points = select::select(&supply, &request.selection).map_err(|e| e.of_input(&name))?;
    if request.spacing == Spacing::World && supply.is_rounded() {
        points.warnings.push(ROUNDED.to_string());
    }
    points.warnings.splice(0..0, warnings);
    Ok(Selected4 { name, ..points })
}

const ROUNDED: &str = "coordinates in world units are rounded: sites that are cospherical in the grid may be \
    so no \
    more, or coincide; cells are those of the rounded points";

/// An error of usage that says that something is too much.
fn too_many(what: &str, count: u64, most: u64, remedy: &str) -> Error {
    Error::usage(format!("{count} {what}, more than {most}: {remedy}"))
}
