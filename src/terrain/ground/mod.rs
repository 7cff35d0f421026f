//! `spground`: which of some points are on the ground. What is defined, and why: `docs/theory/ground.md`.
//!
//! `cells` keeps the lowest point of each cell, tile by tile. `rounds` marks cells that are pits or objects:
//! openings of blocks of cells (`opening`). `surface` triangulates what is left, and has the heights of all
//! cells above that; a second round marks objects among these. `classify` compares points with the surface
//! that is left then; `noise` finds points far above others. `files` writes LAS files again, `points` makes
//! an input of the points of the ground.

mod cells;
mod classify;
mod files;
mod noise;
mod opening;
mod parameters;
mod points;
mod rounds;
mod surface;

use std::path::PathBuf;
use std::sync::Mutex;

pub use classify::{Class, Classifier};
pub use files::{ClassCounts, RewriteOptions, write_classes, write_stream_classes, write_text_classes};
pub use parameters::Parameters;
pub use points::GroundPoints;

use crate::height::Ground;
use crate::meshing::Meshing;
use cells::{Cells, Extent, Lowest, Lows};
use noise::{COLUMN, Columns, NoiseLimits};
use rounds::{Rules, Work};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::crs::System;
use spmesh_formats::source::Input;
use spmesh_pipeline::reduce::Duplicates;
use spmesh_stream::model::bounds::Bounds;
use surface::Frame;

/// Resources of a run.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Memory for cells, blocks and triangulations. Units: bytes.
    pub memory: u64,
    /// Threads that read, open and triangulate.
    pub threads: usize,
    /// Folder for temporary files; that of the system if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// What a run is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Reading points: how many so far.
    Reading,
    /// Opening blocks: how many are done, in the first or second round.
    Opening,
    /// Triangulating the cells that are left.
    Surface,
}

/// The ground of some points.
pub struct Found {
    surface: Ground,
    /// Its tiles may come back from a temporary file.
    noise: Mutex<NoiseLimits>,
    cells: Cells,
    parameters: Parameters,
    /// The slope in the world of one in stored coordinates.
    slope: f64,
    /// The length of a metre in units of x and y, and of z.
    metre: [f64; 2],
    /// How far from its triangles the surface is known. Units: stored ones of the surface.
    reach: f64,
    counts: FoundCounts,
}

/// What was found on the way.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FoundCounts {
    /// Points that were looked at.
    pub points: u64,
    /// Cells with a point.
    pub cells: u64,
    /// Those whose lowest point is noise.
    pub noise: u64,
    /// Cells of objects, by the first and the second round.
    pub objects: [u64; 2],
    /// Triangles of the surface.
    pub triangles: u64,
}

impl Found {
    /// Finds the ground of an input, which is read once; lengths of `parameters` are in metres. With a
    /// `window`, classes are those of all points within this box of the world, if the input has all within
    /// [`Parameters::halo`] of it; points beyond do not count.
    ///
    /// Memory: `settings.memory`, and 48 bytes for each two thousand triangles. Disk: 1 MB for each tile of
    /// 65,536 cells with a point, 1.3 MB for each of as many columns, and two meshes of the cells.
    ///
    /// # Errors
    /// Those of reading; usage, if points are too far from each other or in degrees; memory, if there is too
    /// little; if temporary files fail.
    pub fn find(
        input: &Input,
        parameters: &Parameters,
        settings: &Settings,
        window: Option<&Bounds>,
        progress: &mut dyn FnMut(Step, u64),
    ) -> Result<Found> {
        let description = input.description();
        let of_input = |e: Error| e.of_input(input.name());
        parameters.check()?;
        if !description.has_elevation {
            return Err(of_input(Error::usage("points have no elevation: give points x y z")));
        }
        let units = parameters::units(&System::of(&description.crs)).map_err(of_input)?;
        let (in_units, metre) = (parameters.in_units(units), units.map(f64::recip));
        let rules = Rules::new(&in_units, metre);
        let (memory, temp_dir) = (settings.memory, settings.temp_dir.as_deref());
        let (meshing, opening_threads) = settings.shares(&rules)?;

        let cell = in_units.cell;
        let extent = window.map(|window| Extent::around(window, in_units.halo_of(&rules, metre), cell));
        let mut lows = Lows::new(cell, extent, memory / 4, temp_dir)?;
        let mut columns = Columns::new(COLUMN * metre[0], in_units.gap, memory / 16, temp_dir)?;
        let mut reader = input.read()?;
        let points = lows.add(&mut *reader, &description.coordinates, |placed, points| {
            progress(Step::Reading, points);
            columns.add(placed, cell)
        });
        let points = points.map_err(of_input)?;
        drop(reader);
        let noise = Mutex::new(columns.limits(memory / 16, temp_dir)?);
        let frame = Frame::new(&lows.tiles.tiles(), &in_units, &description.crs).map_err(of_input)?;

        let mut opening = |done| progress(Step::Opening, done);
        let mut work =
            Work { threads: opening_threads, memory: memory / 8, temp_dir, progress: &mut opening, done: 0 };
        rounds::mark_first(&mut lows, &rules, &mut work)?;
        let first = surface::triangulated(&mut lows, &frame, Lowest::OBJECT[0], &meshing)?;
        let heights = surface::heights(&mut lows, &frame, &first, memory / 8, &meshing)?;
        drop(first);
        rounds::mark_objects(&mut lows, heights, 1, &rules, &mut work)?;
        progress(Step::Surface, 0);
        let surface = surface::triangulated(&mut lows, &frame, Lowest::OBJECT[1], &meshing)?;
        let surface = surface.within(window.copied());
        let counts = counts(&mut lows, points, surface.triangles())?;
        let (slope, reach) = (frame.step_of_slope(cell), frame.reach);
        Ok(Found { surface, noise, cells: lows.cells, parameters: in_units, slope, metre, reach, counts })
    }

    /// What was found on the way.
    pub fn counts(&self) -> &FoundCounts {
        &self.counts
    }
}

fn counts(lows: &mut Lows, points: u64, triangles: u64) -> Result<FoundCounts> {
    let mut counts = FoundCounts { points, triangles, ..FoundCounts::default() };
    for tile in lows.tiles.tiles() {
        for cell in lows.tiles.read(tile)?.unwrap_or_default().iter().filter(|cell| cell.is_known()) {
            counts.cells += 1;
            counts.noise += u64::from(!cell.is_sound());
            for (count, mark) in counts.objects.iter_mut().zip(Lowest::OBJECT) {
                *count += u64::from(cell.is_sound() && cell.marks & mark != 0);
            }
        }
    }
    Ok(counts)
}

impl Settings {
    /// How points are triangulated: with half of the memory.
    ///
    /// # Errors
    /// As [`Meshing::of_half`].
    pub fn meshing(&self) -> Result<Meshing> {
        // Only a mesh of all points of the ground has several at one place.
        Meshing::of_half(Duplicates::Lowest, self.memory, self.threads, self.temp_dir.as_deref())
    }

    /// How surfaces are triangulated, and how many threads open blocks, with the same half of the memory.
    fn shares(&self, rules: &Rules) -> Result<(Meshing, usize)> {
        let meshing = self.meshing()?;
        let block = rules.block_memory();
        let half = self.memory / 2;
        if block > half {
            let [block, given] = [2 * block, self.memory].map(|bytes| bytes.div_ceil(1 << 20));
            let what = format!(
                "openings of this window take {block} MiB, and --memory is {given} MiB: raise it, or take a smaller \
                 --window or larger cells"
            );
            return Err(Error::new(ErrorKind::Memory, what));
        }
        Ok((meshing, self.threads.min((half / block) as usize).max(1)))
    }
}
