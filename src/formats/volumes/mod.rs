//! Points of four dimensions: lines of x y z t, grids, volumes that change over time (NRRD, NIfTI, raw), and
//! streams. All points are read, or those that a condition or a random choice selects.
//!
//! Coordinates are grid indices unless world coordinates are requested. So they are integers, and cells are
//! cospherical exactly where the grid is. The selection depends only on the input and the seed.

pub(crate) mod budget;
pub(crate) mod condition;
pub(crate) mod data;
pub(crate) mod lattice;
pub(crate) mod nifti;
pub(crate) mod nrrd;
pub(crate) mod orientation;
pub(crate) mod raw;
pub(crate) mod sample;
pub(crate) mod scan;
pub(crate) mod select;
pub(crate) mod stream;
pub(crate) mod text;
pub(crate) mod volume;
pub(crate) mod world;
pub(crate) mod write;

use std::path::{Path, PathBuf};

pub use condition::Condition;
pub use orientation::Orientation;
pub use raw::{RawLayout, parse_sizes};
pub use sample::Share;

use self::budget::Budget;
use self::lattice::Lattice;
use self::scan::Supply;
use crate::detect::{DD4, read_head};
use crate::source::origin::{Admitted, Origin, name_of};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::Point4;

/// Points of four dimensions in the order of the input. Sites of a grid are in the order of volume files,
/// where x changes fastest. Equal points of a text are all kept.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selected4 {
    /// The points, all finite, and none with -0.0.
    pub points: Vec<Point4>,
    /// How the coordinates of the points lie in the world, if they are those along the axes of an oblique
    /// grid.
    pub orientation: Option<Orientation>,
    /// A value for each point, if the input has values.
    pub values: Option<Vec<f64>>,
    /// Name of the input in messages.
    pub name: String,
    /// Number of points in the input, selected or not.
    pub sites: u64,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// The points to be read.
#[derive(Debug, Clone)]
pub struct Request {
    /// The source of the points.
    pub from: From4,
    /// The coordinates of volumes.
    pub spacing: Spacing,
    /// Which points are selected.
    pub selection: Selection,
    /// Folder of spools; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
    /// Whether the whole diagram of the points will be in memory.
    pub in_memory: bool,
}

/// A source of points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum From4 {
    /// A file whose content tells the format; "-" is standard input.
    File(PathBuf),
    /// A file that holds only the values of a volume.
    Raw(PathBuf, RawLayout),
    /// A full grid of this many sites along x, y, z and t, without values.
    Grid([u64; 4]),
}

/// The kind of coordinates of volumes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spacing {
    /// Grid indices, from 0.
    #[default]
    Index,
    /// World coordinates as the file states them, in its units, rounded to f64. Points of an oblique grid
    /// have distances along its axes instead ([`Orientation`]); conditions apply to their world coordinates.
    World,
}

/// Which points are selected.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selection {
    /// Selects only points that fulfil this condition.
    pub condition: Option<Condition>,
    /// Whether points whose value is missing (NaN) are selected too.
    pub keep_nan: bool,
    /// Selects only this share of them, at random.
    pub share: Option<Share>,
    /// Seed of the random choice.
    pub seed: u64,
}

/// Reads or generates the requested points.
///
/// Cost: a pass over the input, and one before it if points of a file are chosen at random, or if there may
/// be too many; sites of a whole grid are chosen without a pass. Memory: 32 bytes per selected point, 8 per
/// value, and about 24 more per point chosen at random. An input that cannot be read twice is copied to an
/// unlinked temporary file.
///
/// # Errors
/// If the input cannot be read, is malformed (with the position), or of no known format; if the request does
/// not suit the input, or selects more than [`spmesh_base::limits`] or the memory allow: before any point is
/// kept, except for lines and streams.
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
            let admitted = match &request.from {
                // One byte more shows that the sizes are wrong.
                From4::Raw(_, layout) => Admitted::First(layout.bytes().saturating_add(1)),
                _ => Admitted::Formats(&DD4),
            };
            let origin = Origin::new(path, admitted, &temp_dir, &mut warnings)?;
            let is_stdin = path.as_os_str() == "-";
            let name = name_of(path);
            let path = (!is_stdin).then_some(path.as_path());
            let supply = match &request.from {
                From4::Raw(_, layout) => raw::open(origin, path, layout).map(Supply::of_volume),
                _ => open(origin, path, &mut warnings),
            };
            (supply.map_err(|e| e.of_input(&name))?, name)
        }
    };
    read(supply, request, name, warnings)
}

/// Recognizes the format of `origin` and reads its header; `path` is the file's path, if it has one.
fn open(origin: Origin, path: Option<&Path>, warnings: &mut Vec<String>) -> Result<Supply> {
    let head = read_head(&mut origin.plain()?).map_err(|e| Error::io("reading", e))?;
    if head.is_empty() {
        return Err(Error::malformed("found no point"));
    }
    let open = DD4.detect(&head)?.row().sites.expect("the tool reads only what has sites");
    open(origin, path, &head, warnings)
}

fn read(mut supply: Supply, request: &Request, name: String, warnings: Vec<String>) -> Result<Selected4> {
    let orientation = match request.spacing {
        Spacing::World => supply.place_in_world().map_err(|e| e.of_input(&name))?,
        Spacing::Index => None,
    };
    let budget = Budget::of(&supply, request.in_memory);
    let selected = select::select(&supply, &request.selection, orientation.as_ref(), budget);
    let mut points = selected.map_err(|e| e.of_input(&name))?;
    if request.spacing == Spacing::World {
        points.warnings.extend(supply.units());
        points.warnings.extend(supply.is_rounded().then(|| ROUNDED.to_string()));
    }
    points.warnings.splice(0..0, warnings);
    Ok(Selected4 { name, orientation, ..points })
}

const ROUNDED: &str = "coordinates in world units are rounded: sites that are cospherical in the grid may be \
    so no \
    more, or coincide; cells are those of the rounded points";

/// A usage error for exceeding a limit.
fn too_many(what: &str, count: u64, most: u64, remedy: &str) -> Error {
    Error::usage(format!("{count} {what}, more than {most}: {remedy}"))
}
