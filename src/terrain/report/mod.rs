//! `spreport`: how good points and a mesh are.
//!
//! `tally` counts points of each kind and in large cells (`cell_map`), whose side follows from memory. From
//! the spacing of pulses, `cover` makes small cells, and finds voids among them; `lines` compares flight
//! lines there, with a `sample` of the differences. `fields` reads what points carry. `accuracy` compares a
//! mesh with check points, and has `figures` of the differences. A [`Report`] is written as `json`, and as a
//! `page` with a `picture` for each map.

mod accuracy;
mod cell_map;
mod classes;
mod cover;
mod fields;
mod figures;
mod json;
mod lines;
mod page;
mod picture;
mod sample;
mod tables;
mod tally;

use std::path::PathBuf;

pub use accuracy::{Accuracy, CheckOptions, Group, check, window};
pub use cover::{Cover, cover};
pub use fields::ATTRIBUTES;
pub use figures::Figures;
pub use lines::Overlap;
pub use picture::{Frame, Picture};
pub use sample::{Differences, Pair};
use spmesh_formats::crs::System;
use spmesh_stream::Crs;
pub use tally::{Density, Tally, count};

/// How points are looked at.
#[derive(Debug, Clone)]
pub struct Options {
    /// Side of cells of density; 10 if `None`.
    pub cell: Option<f64>,
    /// The pulse spacing that is asked for; the measured one if `None`.
    pub spacing: Option<f64>,
    /// How many units of x one of z is.
    pub unit_of_z: f64,
    /// Memory for cells. Units: bytes.
    pub memory: u64,
    /// Folder for temporary files; that of the system if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// All that was found.
#[derive(Debug)]
pub struct Report {
    /// What the points are called in messages.
    pub name: String,
    /// The mesh, if there is one: its name, and the number of its triangles.
    pub mesh: Option<(String, u64)>,
    /// The coordinate reference system of the points.
    pub crs: Crs,
    /// Counts of points.
    pub tally: Tally,
    /// Voids; `None` if there are no points.
    pub cover: Option<Cover>,
    /// Differences of flight lines; `None` if there are not two of them.
    pub overlap: Option<Overlap>,
    /// Differences at check points; `None` if there are none.
    pub accuracy: Option<Accuracy>,
}

/// Names of units.
struct Units {
    horizontal: String,
    vertical: String,
}

impl Units {
    /// The units of x and y, and of z; of systems that do not state them, "unit".
    fn of(crs: &Crs) -> Units {
        let system = System::of(crs);
        let horizontal = system.horizontal.as_ref().map(|known| known.unit.symbol.clone());
        let vertical = system.vertical.as_ref().map(|known| known.unit.symbol.clone());
        let horizontal = horizontal.unwrap_or_else(|| "unit".to_string());
        Units { vertical: vertical.unwrap_or_else(|| horizontal.clone()), horizontal }
    }
}

/// A value for each of x and y.
fn of_axes<T>(value: impl Fn(usize) -> T) -> [T; 2] {
    [value(0), value(1)]
}
