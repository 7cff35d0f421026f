//! The lattice whose cells are the boxes of a plan. It does not depend on how far the files reach, so that
//! boxes stay where they are when files are added or removed.

use super::align::{Borders, border_near, borders_between, roundest_in};
use spmesh_stream::model::bounds::{Bounds, Region};

/// Halvings of a cell of the pitch, down to the finest cells.
const FINE: u32 = 20;

/// Cells of the pitch below the origin. A third of them is the lower part of each larger cell that holds the
/// origin: so small coordinates of either sign do not straddle the borders of large cells.
const BEFORE: i64 = 0x55_5555_5555;

/// The level of a cell that holds all others.
const TOP: u32 = FINE + 40;

/// Coordinates may be as many pitches away from the origin.
const REACH: f64 = (1u64 << 37) as f64;

/// Equally spaced borders along each axis, all of which are those of the finest cells. A cell of level k has
/// 2^k of these along each axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice {
    origin: [f64; 3],
    pitch: [f64; 3],
    /// Axes that cells divide: 2 or 3.
    dims: usize,
    /// Whether coordinates are integers; borders then are, too.
    are_whole: bool,
}

/// A cell: its first finest cell along each axis, and its level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell {
    first: [i64; 3],
    level: u32,
}

impl Lattice {
    /// A lattice with borders between most of the files whose boxes are given, if these make a grid.
    pub(super) fn of(boxes: &[Bounds], dims: usize, are_whole: bool) -> Lattice {
        let along = |axis: usize| -> Vec<(f64, f64)> {
            boxes.iter().map(|it| (it.min[axis], it.max[axis])).collect()
        };
        let grids: Vec<Option<Borders>> = (0..dims).map(|axis| borders_between(&along(axis))).collect();
        let greatest =
            boxes.iter().flat_map(|it| it.min.into_iter().chain(it.max)).map(f64::abs).fold(0.0, f64::max);
        let shared =
            grids.iter().flatten().map(|borders| borders.pitch).find(|pitch| greatest < pitch * REACH);
        let pitch = shared.unwrap_or_else(|| power_of_two(greatest, are_whole));
        let mut lattice = Lattice { origin: [0.0; 3], pitch: [pitch; 3], dims, are_whole };
        for (axis, grid) in grids.iter().enumerate() {
            let place = match grid.filter(|borders| greatest < borders.pitch * REACH) {
                Some(Borders { origin, pitch }) => {
                    lattice.pitch[axis] = pitch;
                    origin
                }
                None if shared.is_some() => border_of(&along(axis), pitch),
                None => 0.0,
            };
            lattice.origin[axis] = reduced(place, lattice.pitch[axis]);
        }
        lattice
    }

    /// Border number `at` along an axis.
    fn border(&self, axis: usize, at: i64) -> f64 {
        let finest = self.pitch[axis] / f64::from(1 << FINE);
        let border = self.origin[axis] + (at - (BEFORE << FINE)) as f64 * finest;
        // No point lies between integers.
        if self.are_whole { border.ceil() } else { border }
    }

    /// The box of a cell.
    pub(super) fn region(&self, cell: &Cell) -> Region<3> {
        let mut region = Region::EVERYTHING;
        for axis in 0..self.dims {
            region.min[axis] = self.border(axis, cell.first[axis]);
            region.max[axis] = self.border(axis, cell.first[axis] + (1 << cell.level));
        }
        region
    }

    /// The smallest cell that holds a closed box.
    pub(super) fn cell_around(&self, bounds: &Bounds) -> Cell {
        let number = |axis: usize| {
            let finest = self.pitch[axis] / f64::from(1 << FINE);
            let from_origin = ((bounds.min[axis] - self.origin[axis]) / finest).floor() as i64;
            from_origin.saturating_add(BEFORE << FINE).clamp(0, (1 << TOP) - 1)
        };
        let first: [i64; 3] = std::array::from_fn(|axis| if axis < self.dims { number(axis) } else { 0 });
        let cell = |level: u32| Cell { first: first.map(|first| first >> level << level), level };
        let holds = |cell: &Cell| {
            let region = self.region(cell);
            (0..self.dims)
                .all(|axis| region.min[axis] <= bounds.min[axis] && bounds.max[axis] < region.max[axis])
        };
        (0..TOP).map(cell).find(holds).unwrap_or_else(|| cell(TOP))
    }

    /// The halves of a cell along all axes along which they have room for points; none if there are none.
    pub(super) fn children(&self, cell: &Cell) -> Vec<Cell> {
        let Some(level) = cell.level.checked_sub(1) else { return Vec::new() };
        let half = 1 << level;
        let region = self.region(cell);
        let is_cut = |axis: usize| {
            let middle = self.border(axis, cell.first[axis] + half);
            axis < self.dims && region.min[axis] < middle && middle < region.max[axis]
        };
        let cut: Vec<usize> = (0..self.dims).filter(|&axis| is_cut(axis)).collect();
        if cut.is_empty() {
            return Vec::new();
        }
        // Along other axes, all points are in the half that is not empty.
        let is_upper = |axis: usize| self.border(axis, cell.first[axis] + half) <= region.min[axis];
        let mut base = Cell { level, ..*cell };
        (0..self.dims)
            .filter(|axis| !cut.contains(axis) && is_upper(*axis))
            .for_each(|axis| base.first[axis] += half);
        let child = |corner: usize| {
            let mut child = base;
            (0..).zip(&cut).for_each(|(bit, &axis)| child.first[axis] += half * (corner >> bit & 1) as i64);
            child
        };
        (0..1 << cut.len()).map(child).collect()
    }
}

/// The first border that is not negative: which tile is the first must not matter, nor how its place is
/// rounded.
fn reduced(place: f64, pitch: f64) -> f64 {
    let rest = place - (place / pitch).floor() * pitch;
    let is_multiple = rest.min(pitch - rest) <= 1e-9 * pitch;
    if is_multiple { 0.0 } else { rest }
}

/// A border of files along an axis on which they make no grid.
fn border_of(tiles: &[(f64, f64)], pitch: f64) -> f64 {
    let all = tiles.iter().copied().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    match all {
        // All of them go into one column.
        Some((min, max)) if max - min < pitch => roundest_in(max - pitch, min),
        _ => border_near(tiles).unwrap_or(0.0),
    }
}

/// A pitch with which coordinates up to `greatest` are in reach. It changes with their size in large steps
/// alone.
fn power_of_two(greatest: f64, are_whole: bool) -> f64 {
    if are_whole || greatest == 0.0 {
        return 1.0;
    }
    let exponent = (greatest.log2() / 16.0).ceil() * 16.0 - 32.0;
    exponent.clamp(-1000.0, 992.0).exp2()
}
