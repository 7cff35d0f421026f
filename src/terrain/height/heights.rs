//! The heights of points above the ground.

use std::num::NonZeroUsize;

use super::blocks::{Blocks, LoadedBlock, Triangle};
use super::boxes::Box2;
use super::ground::Ground;
use super::nearest::Nearest;
use super::point_grid::{MANY, PointGrid, Share, height_of, set_height, slope_of};
use super::surface::{PLAIN_MAX, beyond_numbers, height, plain_shares, rounded, shares, slope, steepness};
use spmesh_base::error::Result;
use spmesh_delaunay::parallel;
use spmesh_stream::model::bounds::Point;

/// Fewest points for which a thread is worth starting.
const SHARE_MIN: usize = 1 << 12;

/// The unit of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Integers that count this many steps of the ground's z, from 1 to 2^21, rounded half away from zero:
    /// once, and exactly. Domain: the ground has integer coordinates, and so have the points.
    Steps(f64),
    /// The unit of the ground's stored z, not rounded to integers.
    Stored,
}

impl Unit {
    /// A height in the ground's stored unit, which is exact but for roundings, in this unit.
    fn rounded(self, height: f64) -> f64 {
        match self {
            Unit::Steps(steps) => (height / steps).round(),
            Unit::Stored => height,
        }
    }
}

/// Which slope a point has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slopes {
    /// That of the triangle with its height.
    OfTriangles,
    /// That of the triangle as if it were at least so long; on an edge that of the edge, and at a vertex 0,
    /// so it does not matter which triangle is met first.
    AtPlaces(f64),
}

/// What is found for each point.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    unit: Unit,
    slopes: Option<Slopes>,
}

/// The heights of points that are outside of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outside {
    /// None.
    NoData,
    /// Those above the nearest place of the mesh, if it is no further away than this. Units: stored ones of
    /// the ground.
    Within(f64),
}

impl Outside {
    /// Those above the nearest place of the mesh, however far away.
    pub const NEAREST: Outside = Outside::Within(f64::INFINITY);
}

/// Finds heights above a ground, batch by batch, on several threads.
///
/// Cost of a batch: a few nanoseconds for each pair of a point and a triangle in neighbouring cells of a grid
/// over the batch; blocks of triangles without a point nearby are not read.
///
/// Memory: 40 bytes for each point of a batch, at most twice as much if they are uneven; one block of
/// triangles for each thread.
#[derive(Debug)]
pub struct Heights<'g> {
    ground: &'g Ground,
    unit: Unit,
    outside: Outside,
    threads: NonZeroUsize,
    grid: PointGrid,
    nearest: Nearest<'g>,
}

impl<'g> Heights<'g> {
    /// Prepares to find heights above `ground` on `threads` threads.
    pub fn new(ground: &'g Ground, unit: Unit, outside: Outside, threads: NonZeroUsize) -> Heights<'g> {
        let (grid, nearest) = (PointGrid::default(), Nearest::new(ground.blocks()));
        Heights { ground, unit, outside, threads, grid, nearest }
    }

    /// Replaces `heights` with those of points in stored coordinates of the ground, which may be between its
    /// steps; NaN for a point without one. Returns the number of points outside of the mesh.
    ///
    /// A point on an edge or a vertex has the same height in all triangles there, but for rounding: the first
    /// triangle counts, whatever the number of threads. Which triangles these are is decided exactly.
    ///
    /// # Errors
    /// If the temporary file fails; usage, if coordinates are too great or too small to interpolate between;
    /// malformed, if points are where not all of the ground was read.
    pub fn of(&mut self, points: &[Point], heights: &mut Vec<f64>) -> Result<u64> {
        self.find(points, None)?;
        self.answer(points.len(), heights, |_, _| {})
    }

    /// [`Heights::of`], and the slopes there: how much stored z changes over a stored unit of x and y; 0
    /// outside of the mesh.
    ///
    /// # Errors
    /// As [`Heights::of`].
    pub fn with_slopes(
        &mut self,
        points: &[Point],
        which: Slopes,
        heights: &mut Vec<f64>,
        slopes: &mut Vec<f64>,
    ) -> Result<u64> {
        self.find(points, Some(which))?;
        slopes.clear();
        slopes.resize(points.len(), 0.0);
        self.answer(points.len(), heights, |number, slope| slopes[number as usize] = slope)
    }

    /// Looks for the points in the triangles.
    fn find(&mut self, points: &[Point], slopes: Option<Slopes>) -> Result<()> {
        if !points.is_empty() {
            let bounds = Box2::of(points);
            if !bounds.has_sides() {
                return Err(beyond_numbers());
            }
            self.ground.check_window(&bounds)?;
        }
        self.grid.fill(points);
        let parts = self.threads.get().min(points.len() / SHARE_MIN).max(1);
        let (blocks, wanted) = (self.ground.blocks(), Wanted { unit: self.unit, slopes });
        let work = |(share, points)| search(blocks, &share, points, wanted);
        parallel::map(self.threads, self.grid.split(parts), work)?;
        Ok(())
    }

    /// Replaces `heights` with what was found of `len` points, whose slopes go to `slope`. Returns the number
    /// of points outside of the mesh.
    fn answer(&mut self, len: usize, heights: &mut Vec<f64>, mut slope: impl FnMut(u32, f64)) -> Result<u64> {
        heights.clear();
        heights.resize(len, f64::NAN);
        let mut outside = 0;
        for (number, point) in self.grid.numbered() {
            let height = &mut heights[number as usize];
            if let Some(found) = height_of(point) {
                *height = found;
                slope(number, slope_of(point));
                continue;
            }
            outside += 1;
            if let Outside::Within(distance) = self.outside {
                let above = point[2] - self.nearest.elevation(point, distance)?.unwrap_or(f64::NAN);
                *height = self.unit.rounded(above);
            }
        }
        Ok(outside)
    }
}

/// Finds the heights of a share of the points.
fn search(blocks: &Blocks, share: &Share, points: &mut [Point], wanted: Wanted) -> Result<()> {
    let (mut block, mut cells) = (LoadedBlock::default(), Vec::new());
    for number in blocks.that(|bounds| share.has_points_in(bounds)) {
        blocks.read(number, &mut block)?;
        cells.clear();
        cells.extend(block.vertices().iter().map(|vertex| share.cell_of(vertex)));
        for &corners in block.corners() {
            let [a, b, c] = corners.map(|corner| cells[usize::from(corner)]);
            let min = [0, 1].map(|axis| a[axis].min(b[axis]).min(c[axis]));
            let max = [0, 1].map(|axis| a[axis].max(b[axis]).max(c[axis]));
            let triangle = block.triangle(corners);
            for range in share.ranges(min, max) {
                if range.len() > MANY {
                    let mut look = |range| meet(&triangle, &mut points[range], wanted);
                    share.for_each_near(&triangle, &mut look)?;
                    break;
                }
                meet(&triangle, &mut points[range], wanted)?;
            }
        }
    }
    Ok(())
}

/// Sets the heights of waiting points in a triangle.
#[inline]
fn meet(triangle: &Triangle, points: &mut [Point], wanted: Wanted) -> Result<()> {
    let bounds = Box2::of(triangle);
    for point in points {
        if bounds.contains(point) {
            meet_point(triangle, &bounds, point, wanted)?;
        }
    }
    Ok(())
}

/// Sets the height of a point, if the triangle contains it. What it needs of the triangle is computed for
/// each point: most triangles need it for a point or two.
#[inline(never)]
fn meet_point(triangle: &Triangle, bounds: &Box2, point: &mut Point, wanted: Wanted) -> Result<()> {
    let is_plain = matches!(wanted.unit, Unit::Steps(_)) && bounds.longer_side() <= PLAIN_MAX;
    let shares = if is_plain { plain_shares(triangle, point) } else { shares(triangle, point) };
    let Some(shares) = shares else { return Ok(()) };
    let above = height(triangle, shares, point)?;
    let height = match wanted.unit {
        Unit::Steps(steps) => rounded(triangle, point, above, steps),
        Unit::Stored => above,
    };
    let slope = match wanted.slopes {
        None => 0.0,
        Some(Slopes::OfTriangles) => steepness(triangle),
        Some(Slopes::AtPlaces(run)) => slope(triangle, shares, run),
    };
    set_height(point, height, slope);
    Ok(())
}
