//! Square cells over a box, and which of them a place or a segment is in.

use crate::cell_walk::{TOLERANCE, for_each_cell_within};
use crate::points::Point2;

/// More than the roundings of a few operations, as a part of the numbers in them.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// What is in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Item {
    /// It is in one cell.
    Place(Point2),
    /// It is in all cells that it meets, and perhaps in others beside it.
    Segment([Point2; 2]),
}

/// How fine grids are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Items per cell, on average over all cells.
    pub items_per_cell: f64,
    /// The least and the greatest number of cells of the first grid, about.
    pub cells: [f64; 2],
    /// Entries of the first grid for each item, and beside these, at most: with more, cells are larger.
    pub entries: [usize; 2],
    /// Cells with more items have a grid of their own, if that helps.
    pub crowd: usize,
    /// Segments are also in the cells of all places within this distance on both axes.
    pub reach: f64,
    /// Whether the sides of cells are whole numbers.
    pub is_whole: bool,
}

/// A closed box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellBox {
    /// Least coordinates.
    pub min: Point2,
    /// Greatest coordinates.
    pub max: Point2,
}

/// Square cells over a box.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// What the cells are over. The last ones may reach beyond it.
    pub bounds: CellBox,
    /// The side of a cell.
    pub side: f64,
    /// Cells per unit.
    pub scale: f64,
    /// Columns and rows.
    pub size: [usize; 2],
}

impl CellBox {
    /// The least box around some places; none has infinite bounds.
    #[inline]
    pub fn of(places: &[Point2]) -> CellBox {
        let mut bounds = CellBox { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        places.iter().for_each(|&place| bounds.extend(place));
        bounds
    }

    /// The least box around others.
    pub fn around(boxes: impl IntoIterator<Item = CellBox>) -> CellBox {
        boxes.into_iter().fold(CellBox::of(&[]), |mut all, one| {
            [one.min, one.max].into_iter().for_each(|corner| all.extend(corner));
            all
        })
    }

    /// Makes the box contain a place.
    #[inline]
    pub fn extend(&mut self, place: Point2) {
        let [[left, bottom], [right, top]] = [self.min, self.max];
        self.min = [left.min(place[0]), bottom.min(place[1])];
        self.max = [right.max(place[0]), top.max(place[1])];
    }

    /// Whether a place is inside or on the border.
    #[inline]
    pub fn contains(&self, place: Point2) -> bool {
        (0..2).all(|axis| self.min[axis] <= place[axis] && place[axis] <= self.max[axis])
    }

    pub(super) fn with_margin(&self, margin: f64) -> CellBox {
        CellBox { min: self.min.map(|x| x - margin), max: self.max.map(|x| x + margin) }
    }

    /// What both have in common, perhaps nothing: then a bound is beyond the other.
    #[inline]
    pub fn within(&self, other: &CellBox) -> CellBox {
        CellBox {
            min: [0, 1].map(|axis| self.min[axis].max(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].min(other.max[axis])),
        }
    }

    fn longer_side(&self) -> f64 {
        (self.max[0] - self.min[0]).max(self.max[1] - self.min[1])
    }

    /// The part of a segment in the box, and how far rounding moves it on both axes; `None` if there is none.
    fn part(&self, [a, b]: [Point2; 2]) -> Option<([Point2; 2], f64)> {
        if (0..2).any(|axis| a[axis].max(b[axis]) < self.min[axis] || a[axis].min(b[axis]) > self.max[axis]) {
            return None;
        }
        if self.contains(a) && self.contains(b) {
            return Some(([a, b], 0.0));
        }
        // From the nearer end, which makes for the least roundings.
        let beyond = |end: Point2| {
            let [x, y] = [0, 1].map(|axis| (self.min[axis] - end[axis]).max(end[axis] - self.max[axis]));
            x.max(y)
        };
        let [a, b] = if beyond(a) <= beyond(b) { [a, b] } else { [b, a] };
        let along = [0, 1].map(|axis| b[axis] - a[axis]);
        let most = a.iter().chain(&self.min).chain(&self.max).fold(0.0f64, |most, x| most.max(x.abs()));
        let slack = ROUNDINGS * most;
        let mut range = [0.0f64, 1.0];
        for axis in 0..2 {
            if along[axis] != 0.0 {
                let ends = [self.min[axis] - slack - a[axis], self.max[axis] + slack - a[axis]];
                let [p, q] = ends.map(|end| end / along[axis]);
                range = [range[0].max(p.min(q)), range[1].min(p.max(q))];
            }
        }
        let at = |part: f64| [0, 1].map(|axis| a[axis] + part * along[axis]);
        let (part, is_met) = (range.map(at), range[0] <= range[1] * (1.0 + ROUNDINGS) + f64::MIN_POSITIVE);
        match part.iter().flatten().all(|x| x.is_finite()) {
            true => is_met.then_some((part, slack)),
            // Beyond the numbers of f64: it may be anywhere.
            false => Some(([self.min, self.max], f64::INFINITY)),
        }
    }

    /// The box of the part of an item that is in this one, or within `reach` of it.
    pub fn met_by(&self, item: Item, reach: f64) -> Option<CellBox> {
        match item {
            Item::Place(place) => self.contains(place).then_some(CellBox { min: place, max: place }),
            Item::Segment(ends) => {
                let around = self.with_margin(reach);
                let (part, slack) = around.part(ends)?;
                let met = CellBox::of(&part).with_margin(reach + slack).within(self);
                (met.min[0] <= met.max[0] && met.min[1] <= met.max[1]).then_some(met)
            }
        }
    }
}

impl Grid {
    /// About so many cells over a box.
    pub fn new(bounds: CellBox, wanted: f64, is_whole: bool) -> Grid {
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        // A long thin box has few cells across, and at most as many along as it may have in all.
        let side = (width.sqrt() * height.sqrt() / wanted.sqrt()).max(width.max(height) / wanted);
        let side = if is_whole { side.ceil() } else { side };
        Grid::with_side(bounds, if side > 0.0 { side } else { 1.0 })
    }

    /// Cells of this side over a box.
    pub fn with_side(bounds: CellBox, side: f64) -> Grid {
        // Conversions saturate, and what is not a number becomes zero.
        let size = [0, 1].map(|axis| ((bounds.max[axis] - bounds.min[axis]) / side) as usize + 1);
        let scale = 1.0 / side;
        let (scale, size) = if scale.is_finite() { (scale, size) } else { (0.0, [1; 2]) };
        Grid { bounds, side, scale, size }
    }

    /// Number of cells.
    #[inline]
    pub fn count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// A place in units of cells.
    #[inline]
    pub fn local(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (place[axis] - self.bounds.min[axis]) * self.scale)
    }

    /// The cell of a place; for places outside, one at the border.
    #[inline]
    pub fn cell(&self, place: Point2) -> usize {
        let [column, row] = self.local(place).map(|x| x as usize);
        row.min(self.size[1] - 1) * self.size[0] + column.min(self.size[0] - 1)
    }

    /// A cell as a box of coordinates, up to roundings. It may reach beyond the bounds.
    #[inline]
    pub fn cell_box(&self, cell: usize) -> CellBox {
        let at = [cell % self.size[0], cell / self.size[0]];
        let corner =
            |step: usize| [0, 1].map(|axis| self.bounds.min[axis] + (at[axis] + step) as f64 * self.side);
        CellBox { min: corner(0), max: corner(1) }
    }

    /// What the bounds leave of a cell, with what rounding moves beyond it.
    pub(super) fn cell_around(&self, cell: usize, fineness: &Fineness) -> CellBox {
        let margin = TOLERANCE * self.side + ROUNDINGS * self.bounds.longer_side();
        self.cell_box(cell).within(&self.bounds).with_margin(if fineness.is_whole { 0.0 } else { margin })
    }

    /// The columns and rows that a box meets, in units of cells; `None` if it is outside.
    #[inline]
    pub fn range(&self, local: &CellBox) -> Option<[[usize; 2]; 2]> {
        range(local, self.size)
    }

    /// Cells of a fraction of the side.
    #[inline]
    pub fn finer(&self, by: usize) -> Grid {
        let part = by as f64;
        Grid {
            side: self.side / part,
            scale: self.scale * part,
            size: self.size.map(|count| count * by),
            ..*self
        }
    }

    /// Calls `found` with the cells that an item is in: for a segment, also those of all places within
    /// `reach` of it.
    pub fn for_each_cell(&self, item: Item, reach: f64, found: &mut dyn FnMut(usize)) {
        match item {
            Item::Place(place) => found(self.cell(place)),
            Item::Segment(ends) => {
                let Some((part, slack)) = self.bounds.with_margin(reach).part(ends) else { return };
                let reach = (reach + slack) * self.scale + TOLERANCE;
                let part = part.map(|end| self.local(end));
                for_each_cell_within(part, self.size, reach, |[column, row]| {
                    found(row * self.size[0] + column)
                });
            }
        }
    }
}

/// The columns and rows of a grid of this size that a box meets; `None` if it is outside.
#[inline]
pub fn range(local: &CellBox, size: [usize; 2]) -> Option<[[usize; 2]; 2]> {
    let mut ranges = [[0; 2]; 2];
    for axis in 0..2 {
        let [low, high] = [local.min[axis] - TOLERANCE, local.max[axis] + TOLERANCE];
        if high < 0.0 || low > size[axis] as f64 {
            return None;
        }
        // Conversions saturate: what is below zero or not a number becomes zero.
        ranges[axis] = [low as usize, high as usize].map(|cell| cell.min(size[axis] - 1));
    }
    Some(ranges)
}
