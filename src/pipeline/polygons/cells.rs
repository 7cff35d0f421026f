//! Square cells over polygons: which have an edge, and what is known of the others.

use super::Side;
use super::rows::Edge;
use spmesh_delaunay::cell_walk::for_each_cell;
use spmesh_stream::model::points::Point2;

/// Cells per edge, about, and their least and greatest number.
const CELLS_PER_EDGE: f64 = 64.0;
const CELLS: [f64; 2] = [65_536.0, 16_777_216.0];

/// Least side of a cell, as part of the greatest coordinate.
const CELL_MIN: f64 = 1.0 / (1u64 << 46) as f64;

/// A cell that an edge meets. Other values are those of [`Side`], and 0 where nothing is known yet.
const EDGE: u8 = 255;
const UNKNOWN: u8 = 0;
const INSIDE: u8 = Side::Inside as u8;

/// Square cells over the box of all edges.
#[derive(Debug)]
pub(super) struct Cells {
    min: Point2,
    max: Point2,
    /// Cells per two units.
    scale: f64,
    size: [usize; 2],
    states: Vec<u8>,
}

impl Cells {
    /// The cells over `edges`. `side` says where a place lies.
    pub(super) fn new(edges: &[Edge], side: impl Fn(Point2) -> Side) -> Cells {
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in edges.iter().flat_map(|edge| edge.ends) {
            for axis in 0..2 {
                min[axis] = min[axis].min(place[axis]);
                max[axis] = max[axis].max(place[axis]);
            }
        }
        let wanted = (CELLS_PER_EDGE * edges.len() as f64).clamp(CELLS[0], CELLS[1]);
        // Halves, because a difference may exceed the range of f64.
        let [width, height] = [0, 1].map(|axis| 0.5 * max[axis] - 0.5 * min[axis]);
        // A long thin box has few cells across, and at most as many along as it may have in all.
        let length = (width.sqrt() * height.sqrt() / wanted.sqrt()).max(width.max(height) / wanted);
        // A cell holds many numbers of f64, so that its centre is in it.
        let most = min.iter().chain(&max).fold(0.0f64, |most, value| most.max(value.abs()));
        let length = length.max(most * CELL_MIN);
        let scale = 1.0 / length;
        // Without an extent in f64, there is one cell, which has edges.
        let is_wide = length > 0.0 && scale.is_finite() && (1.0 / scale).is_finite();
        let scale = if is_wide { scale } else { 0.0 };
        let size = [width, height].map(|length| if is_wide { (length * scale) as usize + 1 } else { 1 });
        let states = vec![UNKNOWN; size[0] * size[1]];
        let mut cells = Cells { min, max, scale, size, states };
        for edge in edges {
            let ends = edge.ends.map(|end| cells.local(end));
            let columns = cells.size[0];
            for_each_cell(ends, cells.size, |[column, row]| cells.states[row * columns + column] = EDGE);
        }
        cells.fill(side);
        cells
    }

    /// Decides the cells without an edge. Those of a row beside each other lie on one side, and so does one
    /// of them and the cell below it. So few need a test.
    fn fill(&mut self, side: impl Fn(Point2) -> Side) {
        let columns = self.size[0];
        for row in 0..self.size[1] {
            let first = row * columns;
            let mut from = first;
            while from < first + columns {
                if self.states[from] == EDGE {
                    from += 1;
                    continue;
                }
                let rest = &self.states[from..first + columns];
                let len = rest.iter().position(|&state| state == EDGE).unwrap_or(rest.len());
                let below =
                    from.checked_sub(columns).map_or(&[][..], |below| &self.states[below..below + len]);
                let known = below.iter().copied().find(|&state| state != EDGE);
                let state = known.unwrap_or_else(|| side(self.centre([from - first, row])) as u8);
                self.states[from..from + len].fill(state);
                from += len;
            }
        }
    }

    /// Number of cells, of a byte each.
    pub(super) fn len(&self) -> usize {
        self.states.len()
    }

    /// A place in a cell, far from its border.
    fn centre(&self, cell: [usize; 2]) -> Point2 {
        [0, 1].map(|axis| 2.0 * (0.5 * self.min[axis] + (cell[axis] as f64 + 0.5) / self.scale))
    }

    /// A place in units of cells.
    fn local(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (0.5 * place[axis] - 0.5 * self.min[axis]) * self.scale)
    }

    /// The number of the cell of a place; `None` outside of the box of all edges.
    #[inline]
    pub(super) fn find(&self, place: Point2) -> Option<usize> {
        let is_in = (0..2).all(|axis| self.min[axis] <= place[axis] && place[axis] <= self.max[axis]);
        if !is_in {
            return None;
        }
        let [x, y] = self.local(place);
        let [column, row] = [(x as usize).min(self.size[0] - 1), (y as usize).min(self.size[1] - 1)];
        Some(row * self.size[0] + column)
    }

    /// Where all places of a cell lie; `None` if an edge meets it.
    #[inline]
    pub(super) fn side(&self, cell: usize) -> Option<Side> {
        match self.states[cell] {
            EDGE => None,
            INSIDE => Some(Side::Inside),
            _ => Some(Side::Outside),
        }
    }
}
