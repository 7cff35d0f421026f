//! The mesh of the ground, and the heights of points above it.

use std::io::Read;
use std::num::NonZeroUsize;
use std::path::Path;

use super::blocks::{BlockWriter, Blocks, Triangle};
use super::nearest::Nearest;
use super::point_grid::PointGrid;
use super::surface::{height, rounded, shares};
use spmesh_core::error::{Error, Result};
use spmesh_core::parallel;
use spmesh_crs::{System, differences};
use spmesh_geometry::predicates::{FiniteFloatPredicates, is_counterclockwise};
use spmesh_model::bounds::Point;
use spmesh_stream::{Coordinates, Crs, Event, LiveVertices, StreamReader, check_surface};

/// Fewest blocks for which a thread is worth starting.
const BLOCKS_MIN: usize = 16;

/// Most threads that find heights: each has a height for every point of a batch.
pub(super) const SEARCHES_MAX: usize = 8;

/// The unit of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Integers that count this many steps of the ground's z, from 1 to 2^21, rounded half away from zero: once,
    /// and exactly. Domain: the ground has integer coordinates, and so have the points.
    Steps(f64),
    /// The unit of the ground's stored z, not rounded to integers.
    Stored,
}

/// The heights of points that are outside of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// None.
    NoData,
    /// Those above the nearest place of the mesh.
    Nearest,
}

/// The triangles of a mesh, in a temporary file.
///
/// Memory: 48 bytes for each thousand triangles, and 40 MB while it is read. Disk: 36 bytes for each
/// triangle, twice as much if its coordinates are floating-point numbers.
#[derive(Debug)]
pub struct Ground {
    blocks: Blocks,
    coordinates: Coordinates,
    crs: Crs,
    name: String,
}

impl Ground {
    /// Reads a triangle mesh with elevations; calls `progress` with the number of vertices read. The temporary
    /// file is in `temp_dir`, or in the system's folder for temporary files.
    ///
    /// # Errors
    /// If the input is no triangle mesh with elevations, is malformed or truncated; if the temporary file fails.
    pub fn read<R: Read>(
        reader: &mut StreamReader<R>,
        temp_dir: Option<&Path>,
        mut progress: impl FnMut(u64),
    ) -> Result<Ground> {
        let header = reader.header().clone();
        check_surface(&header, true).map_err(|e| e.of_input(reader.name()))?;
        let is_integer = matches!(header.coordinates, Coordinates::I32 { .. });
        let mut blocks = BlockWriter::new(is_integer, temp_dir)?;
        let mut live = LiveVertices::new();
        let mut predicates = FiniteFloatPredicates::default();
        while let Some(event) = reader.next_event()? {
            let Event::Patch(patch) = event else { continue };
            let mut take = || -> Result<()> {
                let vertices = live.enter(&patch, |_, stored| stored)?;
                for triangle in patch.triangles() {
                    let corners = triangle.map(|local| vertices[local as usize].1);
                    if is_counterclockwise(corners.map(|[x, y, _]| [x, y]), &mut predicates)? {
                        blocks.push(corners)?;
                    }
                }
                Ok(())
            };
            take().map_err(|error| reader.locate(error))?;
            progress(reader.totals().vertices);
        }
        let blocks = blocks.finish()?;
        let name = reader.name().to_string();
        Ok(Ground { blocks, coordinates: header.coordinates, crs: header.crs, name })
    }

    /// How its stored coordinates are encoded.
    #[must_use]
    pub fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }

    /// Its coordinate reference system.
    #[must_use]
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// Its name in messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Refuses points in another coordinate reference system. Points without one take that of the ground.
    ///
    /// # Errors
    /// Usage, if the systems differ.
    pub fn check_system(&self, crs: &Crs) -> Result<()> {
        let found = differences(&System::of(&self.crs), &System::of(crs)).join("; ");
        if found.is_empty() {
            return Ok(());
        }
        let what = format!("the coordinate reference system of {} is another one ({found})", self.name);
        Err(Error::usage(format!("{what}: reproject one of them")))
    }

    /// Number of its triangles.
    #[must_use]
    pub fn triangles(&self) -> u64 {
        self.blocks.triangles()
    }
}

/// Finds heights above a ground, batch by batch, on several threads.
///
/// Cost of a batch: a few nanoseconds for each pair of a point and a triangle in neighbouring cells of a grid over
/// the batch; blocks of triangles without a point nearby are not read.
///
/// Memory: 40 bytes for each point of a batch and 8 more for each thread; one block of triangles for each
/// thread.
#[derive(Debug)]
pub struct Heights<'g> {
    ground: &'g Ground,
    unit: Unit,
    outside: Outside,
    grid: PointGrid,
    searches: Vec<Search>,
    nearest: Nearest<'g>,
}

/// What a thread finds in its share of the blocks.
#[derive(Debug, Default)]
struct Search {
    /// The heights of the points in the order of the grid; NaN if there is none yet.
    found: Vec<f64>,
    bytes: Vec<u8>,
    triangles: Vec<Triangle>,
}

impl Ground {
    /// Prepares to find heights on `threads` threads, or on eight if these are more.
    #[must_use]
    pub fn heights(&self, unit: Unit, outside: Outside, threads: NonZeroUsize) -> Heights<'_> {
        let searches = (0..threads.get().min(SEARCHES_MAX)).map(|_| Search::default()).collect();
        let (grid, nearest) = (PointGrid::default(), Nearest::new(&self.blocks));
        Heights { ground: self, unit, outside, grid, searches, nearest }
    }
}

impl Heights<'_> {
    /// Replaces `heights` with those of points in stored coordinates of the ground, which may be between its
    /// steps; NaN for a point without one. Returns the number of points outside of the mesh.
    ///
    /// A point on an edge or a vertex has the same height in all triangles there, but for rounding: the first
    /// triangle counts, whatever the number of threads. Which triangles these are is decided exactly.
    ///
    /// # Errors
    /// If the temporary file fails; usage, if coordinates are too great or too small to interpolate between.
    pub fn of(&mut self, points: &[Point], heights: &mut Vec<f64>) -> Result<u64> {
        self.grid.fill(points);
        let found = search(&self.ground.blocks, &self.grid, self.unit, &mut self.searches)?;
        let grid = &self.grid;
        let outside = found.iter().filter(|height| height.is_nan()).count() as u64;
        if outside > 0 && self.outside == Outside::Nearest {
            for (height, point) in found.iter_mut().zip(grid.points()).filter(|(height, _)| height.is_nan()) {
                let above = point[2] - self.nearest.elevation(point)?.unwrap_or(f64::NAN);
                *height = match self.unit {
                    Unit::Steps(steps) => (above / steps).round(),
                    Unit::Stored => above,
                };
            }
        }
        heights.clear();
        heights.resize(points.len(), f64::NAN);
        for (&height, &number) in found.iter().zip(grid.numbers()) {
            heights[number as usize] = height;
        }
        Ok(outside)
    }
}

/// The heights of the points in blocks, in the order of the grid.
fn search<'s>(
    blocks: &Blocks,
    grid: &PointGrid,
    unit: Unit,
    searches: &'s mut [Search],
) -> Result<&'s mut [f64]> {
    let near: Vec<usize> = match grid.bounds() {
        Some(_) => blocks.that(|bounds| grid.has_points_in(bounds)).collect(),
        None => Vec::new(),
    };
    let share = near.len().div_ceil(searches.len()).max(BLOCKS_MIN);
    let used = near.len().div_ceil(share).max(1);
    let searches = &mut searches[..used];
    for search in searches.iter_mut() {
        search.found.clear();
        search.found.resize(grid.points().len(), f64::NAN);
    }
    let threads = NonZeroUsize::new(used).unwrap_or(NonZeroUsize::MIN);
    parallel::map(threads, searches.iter_mut().zip(near.chunks(share)), |(search, near)| {
        let Search { found, bytes, triangles } = search;
        for &block in near {
            blocks.read(block, bytes, triangles)?;
            triangles.iter().try_for_each(|triangle| meet(triangle, grid, unit, found))?;
        }
        Ok(())
    })?;
    let (first, others) = searches.split_first_mut().expect("there is at least one thread");
    for other in others {
        for (height, other) in first.found.iter_mut().zip(&other.found).filter(|(height, _)| height.is_nan())
        {
            *height = *other;
        }
    }
    Ok(&mut first.found)
}

/// Sets the heights of the points in a triangle that have none yet.
fn meet(triangle: &Triangle, grid: &PointGrid, unit: Unit, found: &mut [f64]) -> Result<()> {
    let bounds = super::blocks::Box2::of(triangle);
    let points = grid.points();
    for range in grid.ranges(&bounds) {
        for at in range {
            let point = &points[at];
            if !found[at].is_nan() {
                continue;
            }
            let Some(shares) = shares(triangle, point) else { continue };
            let above = height(triangle, shares, point)?;
            found[at] = match unit {
                Unit::Steps(steps) => rounded(triangle, point, above, steps),
                Unit::Stored => above,
            };
        }
    }
    Ok(())
}
