//! Square cells over polygons: which have an edge, and what is known of the others.

use super::Side;
use super::rows::Edge;
use spmesh_delaunay::cell_tree::{CellBox, Grid, Item, box_of_most};
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

/// Square cells over the box of most edges. If polygons are small and far apart, most are in cells with
/// edges.
#[derive(Debug)]
pub(super) struct Cells {
    /// The box of all edges.
    bounds: CellBox,
    grid: Grid,
    states: Vec<u8>,
}

impl Cells {
    /// The cells over `edges`. `side` says where a place lies.
    pub(super) fn new(edges: &[Edge], side: impl Fn(Point2) -> Side) -> Cells {
        let wanted = (CELLS_PER_EDGE * edges.len() as f64).clamp(CELLS[0], CELLS[1]);
        let boxes: Vec<CellBox> = edges.iter().map(|edge| CellBox::of(&edge.ends)).collect();
        let bounds = CellBox::around(boxes.iter().copied());
        let grid = grid(box_of_most(&boxes), wanted);
        drop(boxes);
        let mut cells = Cells { bounds, grid, states: vec![UNKNOWN; grid.count()] };
        for edge in edges {
            grid.for_each_cell(Item::Segment(edge.ends), 0.0, &mut |cell| cells.states[cell] = EDGE);
        }
        cells.fill(side);
        cells
    }

    /// Where a place lies: outside of the box of all edges; with all of its cell; or [`None`] if an edge
    /// meets that, or there is no cell.
    #[inline]
    pub(super) fn side(&self, place: Point2) -> Option<Side> {
        if !self.grid.bounds.contains(place) {
            return if self.bounds.contains(place) { None } else { Some(Side::Outside) };
        }
        match self.states[self.grid.cell(place)] {
            EDGE => None,
            INSIDE => Some(Side::Inside),
            _ => Some(Side::Outside),
        }
    }

    /// Decides the cells without an edge. Those of a row beside each other lie on one side, and so does one
    /// of them and the cell below it. So few need a test.
    fn fill(&mut self, side: impl Fn(Point2) -> Side) {
        let columns = self.grid.size[0];
        for row in 0..self.grid.size[1] {
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
                let state = known.unwrap_or_else(|| side(self.centre(from)) as u8);
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
    fn centre(&self, cell: usize) -> Point2 {
        let CellBox { min, max } = self.grid.cell_box(cell);
        [0, 1].map(|axis| min[axis].midpoint(max[axis]))
    }
}

/// Cells that hold many numbers of f64, so that their centres are in them.
fn grid(bounds: CellBox, wanted: f64) -> Grid {
    let grid = Grid::new(bounds, wanted, false);
    let most = bounds.min.iter().chain(&bounds.max).fold(0.0f64, |most, value| most.max(value.abs()));
    let grid = if grid.side < most * CELL_MIN { Grid::with_side(bounds, most * CELL_MIN) } else { grid };
    // Edges beyond the box may meet the last cells, too.
    let whole = |axis: usize| bounds.max[axis].max(bounds.min[axis] + grid.size[axis] as f64 * grid.side);
    Grid { bounds: CellBox { max: [whole(0), whole(1)], ..bounds }, ..grid }
}
