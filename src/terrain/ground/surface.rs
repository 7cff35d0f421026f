//! The surface through the lowest points of some cells, and heights of the others above it.

use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};

use super::cells::{Lowest, Lows, STEPS, Z_STEPS, first_cell};
use super::opening::GAP;
use super::parameters::Parameters;
use crate::accumulators::Accumulators;
use crate::files::TilePlace;
use crate::height::{Ground, Heights, Outside, Unit};
use crate::meshing::Meshing;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::TILE;
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::Passes;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// Where lowest points are as integers.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    /// The first cell of the first column and row of tiles.
    corner: [i64; 2],
    pub(super) description: Description,
    /// Radius of the largest circle of a triangle of a surface, and how far from its triangles a surface is
    /// known. Units: steps of x and y.
    pub(super) reach: f64,
}

impl Frame {
    /// The frame of some tiles.
    ///
    /// # Errors
    /// Usage, if these are too far from each other.
    pub(super) fn new(tiles: &[TilePlace], parameters: &Parameters, crs: &Crs) -> Result<Frame> {
        let cell = parameters.cell;
        let ends = [0, 1].map(|axis| {
            let numbers = || tiles.iter().map(move |tile| tile[axis]);
            [numbers().min().unwrap_or(0), numbers().max().unwrap_or(0)]
        });
        let corner = first_cell(ends.map(|[first, _]| first));
        let last = ends.iter().map(|[first, last]| (last - first + 1) * TILE).max().unwrap_or(0) as i64;
        if last * i64::from(STEPS) > i64::from(i32::MAX) {
            let most = i64::from(i32::MAX) / i64::from(STEPS);
            return Err(Error::usage(format!(
                "the points reach over {last} cells of {cell}, the most are {most}: leave out stray points, or take \
                 larger cells"
            )));
        }
        let scale = cell / f64::from(STEPS);
        let [x, y] = corner.map(|corner| (corner as f64 + 0.5 / f64::from(STEPS)) * cell);
        let coordinates = Coordinates::I32 { scale: [scale, scale, 1.0 / Z_STEPS], offset: [x, y, 0.0] };
        let description = Description {
            coordinates,
            dims: 2,
            has_elevation: true,
            crs: crs.clone(),
            stated_bounds: None,
            attributes: Attributes::default(),
            stated_points: None,
        };
        Ok(Frame { corner, description, reach: parameters.reach / cell * f64::from(STEPS) })
    }

    /// The lowest point of a cell of a tile.
    fn point(&self, tile: [i64; 2], at: usize, lowest: &Lowest) -> Point {
        let cell = [tile[0] + (at % TILE) as i64, tile[1] + (at / TILE) as i64];
        let place = |axis: usize| {
            (cell[axis] - self.corner[axis]) * i64::from(STEPS) + i64::from(lowest.within[axis])
        };
        [place(0) as f64, place(1) as f64, f64::from(lowest.z)]
    }

    /// What a slope in stored coordinates is to be multiplied by in the world.
    pub(super) fn step_of_slope(&self, cell: f64) -> f64 {
        f64::from(STEPS) / (cell * Z_STEPS)
    }
}

/// The lowest points of sound cells without a mark, as an input of the finalization.
pub(super) struct Vertices<'l> {
    lows: Mutex<&'l mut Lows>,
    tiles: Vec<TilePlace>,
    frame: &'l Frame,
    /// Cells with one of these marks are left out.
    mark: u16,
}

impl<'l> Vertices<'l> {
    pub(super) fn new(lows: &'l mut Lows, frame: &'l Frame, mark: u16) -> Vertices<'l> {
        let tiles = lows.tiles.tiles();
        Vertices { lows: Mutex::new(lows), tiles, frame, mark }
    }
}

impl Passes for Vertices<'_> {
    fn description(&self) -> &Description {
        &self.frame.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(VertexReader { vertices: self, next: 0 }))
    }
}

struct VertexReader<'v, 'l> {
    vertices: &'v Vertices<'l>,
    /// Number of the next tile.
    next: usize,
}

impl PointReader for VertexReader<'_, '_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        let Vertices { lows, tiles, frame, mark } = self.vertices;
        let mut lows = lows.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(&tile) = tiles.get(self.next).filter(|_| batch.is_empty()) {
            self.next += 1;
            let cells = lows.tiles.read(tile)?.unwrap_or_default();
            let chosen =
                cells.iter().enumerate().filter(|(_, cell)| cell.is_sound() && cell.marks & mark == 0);
            let first = first_cell(tile);
            batch.extend(chosen.map(|(at, cell)| frame.point(first, at, cell)));
        }
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}

/// The triangulation of the lowest points of sound cells without a mark; no triangles with a greater circle.
///
/// # Errors
/// Those of triangulating.
pub(super) fn triangulated(lows: &mut Lows, frame: &Frame, mark: u16, meshing: &Meshing) -> Result<Ground> {
    let mut mesh = meshing.mesh(&Vertices::new(lows, frame, mark), "ground")?;
    let most = frame.reach * frame.reach;
    let keeps = |corners: &[Point; 3]| circumradius2(corners) <= most;
    Ground::read_where(&mut mesh, meshing.temp_dir.as_deref(), meshing.memory, keeps, |_| {})
}

/// The squared radius of the circle through three corners, whatever their order.
fn circumradius2([a, b, c]: &[Point; 3]) -> f64 {
    let between = |p: &Point, q: &Point| [q[0] - p[0], q[1] - p[1]];
    let [u, v, w] = [between(a, b), between(a, c), between(b, c)];
    let mut squares = [u, v, w].map(|[x, y]| x * x + y * y);
    // Products of sorted factors are rounded alike for any order of the corners.
    squares.sort_unstable_by(f64::total_cmp);
    let twice = u[0] * v[1] - u[1] * v[0];
    squares[0] * squares[1] * squares[2] / (4.0 * twice * twice)
}

/// The heights of the lowest points of all sound cells above a surface, in steps of z. Cells that the surface
/// does not reach are marked as objects of the second round: nothing says that they are ground.
///
/// # Errors
/// If temporary files fail.
pub(super) fn heights(
    lows: &mut Lows,
    frame: &Frame,
    surface: &Ground,
    memory: u64,
    meshing: &Meshing,
) -> Result<Accumulators<f32>> {
    let mut all = Accumulators::anywhere(GAP, memory, meshing.temp_dir.as_deref())?;
    let threads = NonZeroUsize::new(meshing.threads).unwrap_or(NonZeroUsize::MIN);
    let mut above = Heights::new(surface, Unit::Stored, Outside::Within(frame.reach), threads);
    let (mut places, mut points, mut heights) = (Vec::new(), Vec::new(), Vec::new());
    for tile in lows.tiles.tiles() {
        let first = first_cell(tile);
        let cells = lows.tiles.read(tile)?.unwrap_or_default();
        places.clear();
        points.clear();
        for (at, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.is_sound()) {
            places.push(at);
            points.push(frame.point(first, at, cell));
        }
        above.of(&points, &mut heights)?;
        for (&at, &height) in places.iter().zip(&heights) {
            if height.is_nan() {
                lows.tiles.cell(tile, at)?.marks |= Lowest::OBJECT[1];
            } else {
                *all.cell(tile, at)? = height as f32;
            }
        }
    }
    Ok(all)
}
