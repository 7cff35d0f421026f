//! `spdiff`: volumes between two triangle meshes, or between a mesh and levels or a plane.
//!
//! Both meshes are put on one `grid` of integers, and their triangles wait in temporary files, in blocks of
//! neighbours. `join` finds the triangles that overlap, `overlap` what two of them have in common, exactly. A
//! `piece` of this kind is cut where the surfaces cross, its volumes and areas are computed to about 100
//! binary digits, and each is rounded once before it goes to a `sum` without rounding. `regions` divides
//! pieces by polygons, `levels` cuts triangles at horizontal planes. Why sums are the same for all orders and
//! divisions: `docs/theory/volumes.md`.

mod grid;
mod join;
mod levels;
mod overlap;
mod piece;
mod regions;
mod sum;

use std::cell::RefCell;
use std::io::Read;
use std::path::Path;

use num_bigint::BigInt;
use num_traits::ToPrimitive;

use crate::height::{Blocks, Ground};
use grid::{Grid, LEVEL_BITS};
use join::{Cut, Join, THREAD_LEN};
use levels::Table;
use piece::Totals;
use regions::Regions;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_delaunay::predicates::{Pair, area};
use spmesh_formats::source::Polygon;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, StreamReader};
use sum::{Sum, UNIT};

/// A number to about 100 binary digits.
type Real = Pair<false>;

/// Is told how many blocks of how many are done.
pub type Progress<'p> = dyn FnMut(u64, u64) + 'p;

/// A triangle mesh in a temporary file.
#[derive(Debug)]
pub struct Surface {
    ground: Ground,
    /// Of stored vertices; around nothing if there is no triangle.
    bounds: Bounds,
    area: f64,
}

impl Surface {
    /// Reads a triangle mesh with elevations, as [`Ground::read`] does.
    ///
    /// # Errors
    /// As [`Ground::read`].
    pub fn read<R: Read>(
        reader: &mut StreamReader<R>,
        temp_dir: Option<&Path>,
        memory: u64,
        progress: impl FnMut(u64),
    ) -> Result<Surface> {
        let seen = RefCell::new((None::<Bounds>, Sum::default()));
        let look = |&[a, b, c]: &[[f64; 3]; 3]| {
            let (bounds, sum) = &mut *seen.borrow_mut();
            let own = [a, b, c].map(Bounds::of_point).into_iter().reduce(Bounds::union);
            *bounds = bounds.iter().copied().chain(own).reduce(Bounds::union);
            let [p, q, r] = [a, b, c].map(|[x, y, _]| [x, y]);
            sum.add(Pair(area(p, q, r), 0.0));
            true
        };
        let ground = Ground::read_where(reader, temp_dir, memory, look, progress)?;
        let (bounds, sum) = seen.into_inner();
        let step = match ground.coordinates() {
            Coordinates::F64 => 1.0,
            Coordinates::I32 { scale, .. } => scale[0],
        };
        let area = number(&sum.units()) * UNIT * step * step;
        Ok(Surface { ground, bounds: bounds.unwrap_or(Bounds::of_point([0.0; 3])), area })
    }

    /// The mesh.
    pub fn ground(&self) -> &Ground {
        &self.ground
    }

    /// Its area in the plane, in world units.
    pub fn area(&self) -> f64 {
        self.area
    }

    fn blocks(&self) -> &Blocks {
        self.ground.blocks()
    }

    fn placed(&self) -> (Coordinates, Bounds) {
        (*self.ground.coordinates(), self.bounds)
    }
}

/// What a mesh is compared with.
#[derive(Debug, Clone, Copy)]
pub enum Other<'o> {
    /// Another mesh.
    Mesh(&'o Surface),
    /// Levels, in increasing order.
    Levels(&'o [f64]),
    /// A plane by its elevation at the origin, and what this gains for one unit of x and of y. It is sampled
    /// at the vertices of the mesh.
    Plane([f64; 3]),
}

/// How surfaces are compared.
#[derive(Debug, Clone, Copy)]
pub struct Options<'o> {
    /// Polygons by which volumes are told apart, in world coordinates.
    pub polygons: &'o [Polygon],
    /// Memory for blocks and sums. Units: bytes.
    pub memory: u64,
    /// Number of threads.
    pub threads: usize,
}

/// Volumes and areas in units of [`Comparison`], without rounding.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Volumes {
    /// Volume and area where the second surface is lower than the first.
    pub cut: BigInt,
    /// Area of `cut`.
    pub cut_area: BigInt,
    /// Volume where it is higher.
    pub fill: BigInt,
    /// Area of `fill`.
    pub fill_area: BigInt,
    /// Area where both are the same.
    pub level_area: BigInt,
}

impl Volumes {
    fn of(totals: &Totals) -> Volumes {
        Volumes {
            cut: totals.cut[0].units(),
            cut_area: totals.cut[1].units(),
            fill: totals.fill[0].units(),
            fill_area: totals.fill[1].units(),
            level_area: totals.level.units(),
        }
    }

    /// The integral of the second surface minus the first.
    pub fn net(&self) -> BigInt {
        &self.fill - &self.cut
    }

    /// The area of both surfaces.
    pub fn area(&self) -> BigInt {
        &self.cut_area + &self.fill_area + &self.level_area
    }
}

/// The volumes of a comparison.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// For each polygon, or for the plane if there are none: the volumes of each level; of a mesh or a plane
    /// one.
    pub volumes: Vec<Vec<Volumes>>,
    /// World units of a unit of areas and of volumes; those of x, y and z, which may differ.
    pub units: [f64; 2],
    /// Steps of x and y and of z that coordinates were rounded to.
    pub rounded: Option<[f64; 2]>,
    /// Number of pieces over which both surfaces are planes.
    pub pieces: u64,
}

/// Compares a mesh with another surface; `progress` is told of blocks.
///
/// Memory: `options.memory`; 64 bytes for each two thousand triangles more.
///
/// Cost: proportional to the pieces, if triangles that are close in space are close in the streams.
///
/// # Errors
/// Usage, if systems differ, levels are too far away, or polygons cross themselves; memory, if there is too
/// little; if a temporary file fails.
pub fn compare(
    first: &Surface,
    other: &Other,
    options: &Options,
    progress: &mut Progress<'_>,
) -> Result<Comparison> {
    let levels = match other {
        Other::Mesh(_) => 1,
        Other::Levels(levels) => levels.len(),
        Other::Plane(_) => 1,
    };
    let threads = options.check(levels)?;
    let (volumes, pieces, grid) = match other {
        Other::Mesh(second) => {
            second.ground.check_system(first.ground.crs()).map_err(|e| e.of_input(first.ground.name()))?;
            let grid = Grid::of(&[first.placed(), second.placed()], None)?;
            let regions = Regions::new(options.polygons, &grid)?;
            let join = Join { grid: &grid, surfaces: [first, second], regions: &regions, threads };
            let found = join.run(progress)?;
            (found.sums.iter().map(|totals| vec![Volumes::of(totals)]).collect(), found.pieces, grid)
        }
        Other::Levels(levels) => cut(first, levels, None, options, threads, progress)?,
        Other::Plane(plane) => cut(first, &[], Some(*plane), options, threads, progress)?,
    };
    let [area, volume] = grid.sizes();
    let units = [area / 2.0 * UNIT, volume / 6.0 * UNIT];
    Ok(Comparison { volumes, units, rounded: grid.rounded(), pieces })
}

/// What [`cut`] finds: volumes, the number of triangles, and the grid.
type CutFound = (Vec<Vec<Volumes>>, u64, Grid);

fn cut(
    surface: &Surface,
    levels: &[f64],
    plane: Option<[f64; 3]>,
    options: &Options,
    threads: usize,
    progress: &mut Progress<'_>,
) -> Result<CutFound> {
    let heights = plane.map_or_else(|| levels.to_vec(), |plane| at_corners(plane, surface));
    let [low, high] =
        [f64::min, f64::max].map(|choose: fn(f64, f64) -> f64| heights.iter().copied().reduce(choose));
    let range = low.zip(high).map(|(low, high)| [low, high]);
    let grid = Grid::of(&[surface.placed()], range)?;
    let on_grid = |&height: &f64| {
        let far = || Error::usage(format!("a level of {height:?} is too far from the mesh for its steps"));
        grid.level(height).ok_or_else(far)
    };
    let heights = heights.iter().map(on_grid).collect::<Result<Vec<i64>>>()?;
    let levels = if plane.is_some() { vec![0] } else { heights };
    let regions = Regions::new(options.polygons, &grid)?;
    let found =
        Cut { grid: &grid, surface, regions: &regions, levels: &levels, plane, threads }.run(progress)?;
    let volumes = found.sums.iter().map(|table| table.volumes(&levels)).collect();
    Ok((volumes, found.pieces, grid))
}

/// The elevations of a plane at the corners of the box of a mesh.
fn at_corners([z, dx, dy]: [f64; 3], surface: &Surface) -> Vec<f64> {
    let (coordinates, Bounds { min, max }) = surface.placed();
    let [[left, low, _], [right, high, _]] = [min, max].map(|corner| coordinates.to_world(corner));
    let corners = [[left, low], [right, low], [left, high], [right, high]];
    corners.map(|[x, y]| z + dx * x + dy * y).to_vec()
}

impl Options<'_> {
    /// The number of threads for which there is memory: blocks of each, and sums of each and of three more
    /// that wait.
    fn check(&self, levels: usize) -> Result<usize> {
        let sums = (self.polygons.len().max(1) * levels.max(1)) as u64 * (Table::LEVEL_LEN + 64);
        let of_threads = |threads: u64| threads * THREAD_LEN + (3 * threads + 1) * sums;
        let threads = (1..=self.threads as u64).rev().find(|&threads| of_threads(threads) <= self.memory);
        threads.map(|threads| threads as usize).ok_or_else(|| {
            let [given, least] = [self.memory >> 20, of_threads(1).div_ceil(1 << 20)];
            let what = format!("--memory of {given} MiB is too little for these polygons and levels");
            Error::new(ErrorKind::Memory, format!("{what}: give {least}M or more"))
        })
    }
}

/// The number of units that an integer stands for, rounded once.
pub fn number(units: &BigInt) -> f64 {
    units.to_f64().unwrap_or(f64::NAN)
}

const _: () = assert!(LEVEL_BITS < 22, "levels of 2^40 steps fit 62 bits");
