//! A vertex near any place, where walks to inserted points start.

use crate::predicates::{Extent, Point2};

/// Points per cell when the grid is made.
const PER_CELL: usize = 2;
/// A grid is made after one far walk for so many points: it takes about as long as these walks did, and so
/// pays for itself.
const POINTS_PER_WALK: usize = 4000;

/// A grid over the points, with one vertex for each cell. Vertices are never removed, so each stays right; a
/// place outside has that of the cell at the border.
#[derive(Debug, Clone, Default)]
pub(super) struct Nearby {
    lower: Point2,
    /// Cells per unit.
    scale: Point2,
    side: usize,
    /// By rows.
    cells: Vec<Option<u32>>,
    /// How many points it was made for.
    count: usize,
    /// Walks from afar since then.
    far: usize,
}

impl Nearby {
    /// The vertex noted last in the cell of a place.
    pub(super) fn vertex(&self, at: Point2) -> Option<u32> {
        self.cells.get(self.cell(at)).copied().flatten()
    }

    /// Notes a vertex.
    pub(super) fn note(&mut self, at: Point2, vertex: u32) {
        let cell = self.cell(at);
        if let Some(noted) = self.cells.get_mut(cell) {
            *noted = Some(vertex);
        }
    }

    /// Counts a walk from afar to a place among `points`. If these became many, makes a grid, with those
    /// points that are vertices.
    pub(super) fn count_walk(&mut self, points: &[Point2], is_vertex: impl Fn(usize) -> bool) {
        self.far += 1;
        if self.far * POINTS_PER_WALK < points.len() || points.len() < 2 * self.count {
            return;
        }
        let extent = Extent::of(points);
        self.side = (points.len() / PER_CELL).isqrt().max(1);
        self.lower = extent.lower;
        // If a difference is infinite or tiny, all points may be in one cell: that is slow, not wrong.
        self.scale = [0, 1].map(|axis| self.side as f64 / (extent.upper[axis] - extent.lower[axis]));
        self.cells = vec![None; self.side * self.side];
        (self.count, self.far) = (points.len(), 0);
        for (vertex, &at) in points.iter().enumerate().filter(|&(vertex, _)| is_vertex(vertex)) {
            self.note(at, vertex as u32);
        }
    }

    fn cell(&self, at: Point2) -> usize {
        // The conversion to integers clamps, and makes a NaN zero.
        let along = |axis: usize| {
            let cell = ((at[axis] - self.lower[axis]) * self.scale[axis]) as usize;
            cell.min(self.side.saturating_sub(1))
        };
        along(1) * self.side + along(0)
    }
}
