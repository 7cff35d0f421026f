//! All points in square cells of a temporary file, each with few enough to work on in memory.
//!
//! Cells are those of a quadtree over the box of the points: a cell is divided as long as it has more than
//! [`CELL_POINTS`]. They, and the order of the points of each, depend on the set of points alone.

use std::num::NonZeroUsize;
use std::path::Path;

use super::hull;
use crate::height::Box2;
use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;
use spmesh_delaunay::order::{Curve, SpatialOrder};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::{Extent, Point2};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Most points of a cell. Borders between cells cost a few vertices more than needed; larger cells take more
/// memory.
pub const CELL_POINTS: u64 = 1 << 18;

/// The sample has at most this part of the points of a cell.
const SAMPLE_PART: u64 = 2;

/// A cell is divided at once into at most this squared.
const SIDE: usize = 1 << LEVELS;
const LEVELS: usize = 5;

/// Bytes of a pile that wait to be written together.
const CHUNK_LEN: usize = 1 << 14;

/// How points are stored: integers take half of the space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Codec {
    pub(super) is_integer: bool,
}

impl Codec {
    pub(super) fn of(coordinates: &Coordinates) -> Codec {
        Codec { is_integer: matches!(coordinates, Coordinates::I32 { .. }) }
    }

    pub(super) fn point_len(self) -> usize {
        if self.is_integer { size_of::<[i32; 3]>() } else { size_of::<Point>() }
    }

    pub(super) fn encode(self, point: &Point, bytes: &mut Vec<u8>) {
        if self.is_integer {
            bytes.extend_from_slice(bytemuck::bytes_of(&point.map(|value| value as i32)));
        } else {
            bytes.extend_from_slice(bytemuck::bytes_of(point));
        }
    }

    /// Replaces `points` with those of a file.
    pub(super) fn read(
        self,
        file: &TemporaryFile,
        at: u64,
        count: usize,
        points: &mut Vec<Point>,
    ) -> Result<()> {
        let mut bytes = vec![0; count * self.point_len()];
        file.read_at("reading points", &mut bytes, at)?;
        points.clear();
        if self.is_integer {
            let stored = bytes.chunks_exact(self.point_len()).map(bytemuck::pod_read_unaligned::<[i32; 3]>);
            points.extend(stored.map(|point| point.map(f64::from)));
        } else {
            points.extend(bytes.chunks_exact(self.point_len()).map(bytemuck::pod_read_unaligned::<Point>));
        }
        Ok(())
    }
}

/// Points that lie anywhere in the file.
#[derive(Debug)]
struct Pile {
    /// First byte and length of each run in the file.
    runs: Vec<(u64, u32)>,
    waiting: Vec<u8>,
    points: u64,
    bounds: Box2,
}

impl Pile {
    fn new() -> Pile {
        Pile { runs: Vec::new(), waiting: Vec::new(), points: 0, bounds: Box2::NONE }
    }
}

/// Points in piles, as they come.
///
/// Memory: 16 KB for each pile that grows, of which there are at most 1,024.
pub(super) struct Piles {
    file: TemporaryFile,
    codec: Codec,
    len: u64,
    whole: Pile,
    /// Most points of a cell.
    cell_points: u64,
}

impl Piles {
    pub(super) fn new(codec: Codec, cell_points: u64, folder: Option<&Path>) -> Result<Piles> {
        let file = TemporaryFile::create(folder)?;
        Ok(Piles { file, codec, len: 0, whole: Pile::new(), cell_points })
    }

    /// Adds points to the only pile that there is.
    pub(super) fn add(&mut self, points: &[Point]) -> Result<()> {
        let mut whole = std::mem::replace(&mut self.whole, Pile::new());
        points.iter().try_for_each(|point| self.push(&mut whole, point))?;
        self.whole = whole;
        Ok(())
    }

    fn push(&mut self, pile: &mut Pile, point: &Point) -> Result<()> {
        pile.points += 1;
        pile.bounds = pile.bounds.with(&Box2::of([point]));
        self.codec.encode(point, &mut pile.waiting);
        if pile.waiting.len() >= CHUNK_LEN { self.flush(pile) } else { Ok(()) }
    }

    fn flush(&mut self, pile: &mut Pile) -> Result<()> {
        self.file.write_at("writing points", &pile.waiting, self.len)?;
        pile.runs.push((self.len, pile.waiting.len() as u32));
        self.len += pile.waiting.len() as u64;
        pile.waiting.clear();
        Ok(())
    }

    /// Replaces `points` with those of a run.
    fn read(&self, (at, len): (u64, u32), points: &mut Vec<Point>) -> Result<()> {
        self.codec.read(&self.file, at, len as usize / self.codec.point_len(), points)
    }

    /// Divides a pile into the cells of a quadtree of some levels, none with more points than allowed unless
    /// it is of the last level.
    fn divide(&mut self, pile: &Pile) -> Result<Vec<Pile>> {
        let Box2 { min, max } = pile.bounds;
        let side = (max[0] - min[0]).max(max[1] - min[1]) / SIDE as f64;
        let cell_of = |&[x, y, _]: &Point| {
            let [column, row] = [(x - min[0]) / side, (y - min[1]) / side];
            // Conversions saturate.
            (row as usize).min(SIDE - 1) * SIDE + (column as usize).min(SIDE - 1)
        };
        let (mut counts, mut points) = (vec![0; SIDE * SIDE], Vec::new());
        for &run in &pile.runs {
            self.read(run, &mut points)?;
            points.iter().for_each(|point| counts[cell_of(point)] += 1);
        }
        let mut leaf_of = vec![0; SIDE * SIDE];
        let leaves = number_leaves(&counts, self.cell_points, [0, 0], SIDE, 0, &mut leaf_of);
        let mut piles: Vec<Pile> = (0..leaves).map(|_| Pile::new()).collect();
        for &run in &pile.runs {
            self.read(run, &mut points)?;
            points.iter().try_for_each(|point| self.push(&mut piles[leaf_of[cell_of(point)]], point))?;
        }
        piles.iter_mut().try_for_each(|pile| self.flush(pile))?;
        piles.retain(|pile| pile.points > 0);
        if piles.len() == 1 {
            return Err(Error::malformed("the vertices of the mesh are not distinct"));
        }
        Ok(piles)
    }

    /// The points in cells.
    pub(super) fn into_cells(mut self, folder: Option<&Path>, threads: NonZeroUsize) -> Result<Cells> {
        let mut whole = std::mem::replace(&mut self.whole, Pile::new());
        self.flush(&mut whole)?;
        let points = whole.points;
        if points > 0 && !whole.bounds.has_sides() {
            return Err(Error::usage("coordinates are too far apart: shift and scale them"));
        }
        let (mut waiting, mut piles) = (vec![whole], Vec::new());
        while let Some(pile) = waiting.pop() {
            if pile.points <= self.cell_points {
                piles.push(pile);
            } else {
                waiting.extend(self.divide(&pile)?.into_iter().rev());
            }
        }
        let (file, codec) = (TemporaryFile::create(folder)?, self.codec);
        let place = |len: &mut u64, pile: &Pile| {
            let at = *len;
            *len += pile.points * codec.point_len() as u64;
            Some(Cell { at, points: pile.points as usize, bounds: pile.bounds })
        };
        let cells: Vec<Cell> = piles.iter().scan(0, place).collect();
        let step = points.div_ceil((self.cell_points / SAMPLE_PART).max(1)).max(1) as usize;
        let (mut corners, mut sample) = (Vec::new(), Vec::new());
        let share = 4 * threads.get();
        for (cells, piles) in cells.chunks(share).zip(piles.chunks(share)) {
            let sorted = parallel::map(threads, cells.iter().zip(piles), |(cell, pile)| {
                let points = self.sorted(pile)?;
                let mut bytes = Vec::with_capacity(points.len() * codec.point_len());
                points.iter().for_each(|point| codec.encode(point, &mut bytes));
                file.write_at("writing points", &bytes, cell.at)?;
                let sample: Vec<Point> = points.iter().step_by(step).copied().collect();
                Ok::<_, Error>((hull::corners(points), sample))
            })?;
            for (of_cell, mut sample_of_cell) in sorted {
                corners.extend(of_cell);
                sample.append(&mut sample_of_cell);
            }
            corners = hull::corners(corners);
        }
        Ok(Cells { file, codec, cells, points, corners, sample })
    }

    /// The points of a pile along a curve.
    fn sorted(&self, pile: &Pile) -> Result<Vec<Point>> {
        let (mut all, mut points) = (Vec::with_capacity(pile.points as usize), Vec::new());
        for &run in &pile.runs {
            self.read(run, &mut points)?;
            all.append(&mut points);
        }
        let places: Vec<Point2> = all.iter().map(|&[x, y, _]| [x, y]).collect();
        let mut order = SpatialOrder::default();
        let sorted = order.sort(&places, &Extent::of(&places), Curve::Hilbert);
        Ok(sorted.map(|at| all[at as usize]).collect())
    }
}

/// Numbers the leaves of a square of cells, from `first` on, and returns the number after the last one.
fn number_leaves(
    counts: &[u64],
    cell_points: u64,
    [column, row]: [usize; 2],
    side: usize,
    first: usize,
    leaf_of: &mut [usize],
) -> usize {
    let cells =
        (row..row + side).flat_map(|row| (column..column + side).map(move |column| row * SIDE + column));
    if side == 1 || cells.clone().map(|cell| counts[cell]).sum::<u64>() <= cell_points {
        cells.for_each(|cell| leaf_of[cell] = first);
        return first + 1;
    }
    let half = side / 2;
    let quarters = [[0, 0], [half, 0], [0, half], [half, half]];
    quarters.into_iter().fold(first, |next, [right, up]| {
        number_leaves(counts, cell_points, [column + right, row + up], half, next, leaf_of)
    })
}

/// A cell of points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    at: u64,
    points: usize,
    pub(super) bounds: Box2,
}

impl Cell {
    /// Number of its points.
    pub(super) fn len(&self) -> u64 {
        self.points as u64
    }
}

/// All points in cells.
pub(super) struct Cells {
    file: TemporaryFile,
    pub(super) codec: Codec,
    pub(super) cells: Vec<Cell>,
    /// Number of points.
    pub(super) points: u64,
    /// Those at the corners of the hull.
    pub(super) corners: Vec<Point>,
    /// Some of the points, evenly.
    pub(super) sample: Vec<Point>,
}

impl Cells {
    /// The points of a cell, along a curve.
    pub(super) fn read(&self, cell: &Cell) -> Result<Vec<Point>> {
        let mut points = Vec::new();
        self.codec.read(&self.file, cell.at, cell.points, &mut points)?;
        Ok(points)
    }
}
