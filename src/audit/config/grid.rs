//! Points in the cells of a grid, to find those near a circle.

use crate::audit::exact::plane::Xy;

/// Points by cell, row by row.
pub(super) struct Grid {
    lower: Xy,
    cell: Xy,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    ids: Vec<u32>,
}

impl Grid {
    /// About two points per cell.
    pub(super) fn of(points: &[Xy]) -> Grid {
        let bound = |axis: usize| {
            let values = points.iter().map(|p| p[axis]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let bounds = [bound(0), bound(1)];
        let side = ((points.len() as f64 / 2.0).sqrt() as usize).clamp(1, 1 << 12);
        let cell = bounds.map(|(low, high)| ((high - low) / side as f64).max(f64::MIN_POSITIVE));
        let lower = [bounds[0].0, bounds[1].0];
        let mut grid = Grid {
            lower,
            cell,
            columns: side,
            rows: side,
            starts: vec![0; side * side + 1],
            ids: vec![0; points.len()],
        };
        let cells: Vec<usize> =
            points.iter().map(|&p| grid.place(p[1], 1) * side + grid.place(p[0], 0)).collect();
        cells.iter().for_each(|&cell| grid.starts[cell] += 1);
        let mut sum = 0;
        for start in &mut grid.starts {
            sum += *start;
            *start = sum;
        }
        for (id, &cell) in (0..).zip(&cells) {
            grid.starts[cell] -= 1;
            grid.ids[grid.starts[cell] as usize] = id;
        }
        grid
    }

    /// Row or column of a coordinate: monotone, whatever is rounded, and total.
    fn place(&self, coordinate: f64, axis: usize) -> usize {
        let last = if axis == 0 { self.columns } else { self.rows } - 1;
        (((coordinate - self.lower[axis]) / self.cell[axis]) as usize).min(last)
    }

    /// All points of a box, and others.
    pub(super) fn near(&self, [low, high]: [Xy; 2]) -> impl Iterator<Item = u32> + '_ {
        let (left, right) = (self.place(low[0], 0), self.place(high[0], 0));
        let rows = self.place(low[1], 1)..=self.place(high[1], 1);
        rows.flat_map(move |row| {
            let (first, last) = (row * self.columns + left, row * self.columns + right);
            self.ids[self.starts[first] as usize..self.starts[last + 1] as usize].iter().copied()
        })
    }
}
