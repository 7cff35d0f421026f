//! The elevations of points around the vertices of lines and water.

use spmesh_stream::model::bounds::{Bounds, Point};

/// Cells along the longer side of the grid.
const CELLS: f64 = 256.0;

/// As many points around a place tell what elevations are there.
const FEW: u32 = 8;

/// A grid over the vertices and around them, with the least and the greatest elevation in each cell.
///
/// Memory: 24 bytes a cell.
#[derive(Debug, Default)]
pub(super) struct Relief {
    origin: [f64; 2],
    /// Cells per unit.
    scale: f64,
    columns: usize,
    cells: Vec<Cell>,
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    least: f64,
    most: f64,
    points: u32,
}

const EMPTY: Cell = Cell { least: f64::INFINITY, most: f64::NEG_INFINITY, points: 0 };

impl Cell {
    fn with(self, other: Cell) -> Cell {
        Cell {
            least: self.least.min(other.least),
            most: self.most.max(other.most),
            points: self.points.saturating_add(other.points),
        }
    }
}

impl Relief {
    /// A grid without points yet. It has no cells if the vertices are at one place.
    pub(super) fn over(vertices: &[Point]) -> Relief {
        let Some(Bounds { min, max }) = Bounds::of_points(vertices) else { return Relief::default() };
        let side = (max[0] - min[0]).max(max[1] - min[1]);
        if !(side > 0.0 && side.is_finite()) {
            return Relief::default();
        }
        // As far around the vertices as they are apart.
        let scale = CELLS / (3.0 * side);
        let [columns, rows] = [0, 1].map(|axis| ((max[axis] - min[axis] + 2.0 * side) * scale) as usize + 1);
        let origin = [min[0] - side, min[1] - side];
        Relief { origin, scale, columns, cells: vec![EMPTY; columns * rows] }
    }

    fn rows(&self) -> usize {
        self.cells.len().checked_div(self.columns).unwrap_or(0)
    }

    /// The column and the row of a place; `None` outside.
    #[inline]
    fn find(&self, [x, y, _]: &Point) -> Option<[usize; 2]> {
        let [column, row] = [(x - self.origin[0]) * self.scale, (y - self.origin[1]) * self.scale];
        let is_in = column >= 0.0 && column < self.columns as f64 && row >= 0.0 && row < self.rows() as f64;
        is_in.then_some([column as usize, row as usize])
    }

    /// Enters a point.
    #[inline]
    pub(super) fn enter(&mut self, point: &Point) {
        if let Some([column, row]) = self.find(point) {
            let cell = &mut self.cells[row * self.columns + column];
            *cell = cell.with(Cell { least: point[2], most: point[2], points: 1 });
        }
    }

    /// The least and the greatest elevation around each vertex: in the least square of cells around it, of
    /// some sizes, that has a few points, or else on the whole grid. `None` if that has no points.
    pub(super) fn around(mut self, vertices: &[Point]) -> Vec<Option<[f64; 2]>> {
        let mut found = vec![None; vertices.len()];
        while !self.cells.is_empty() {
            let few = if self.cells.len() == 1 { 1 } else { FEW };
            for (vertex, found) in vertices.iter().zip(&mut found) {
                let all = || self.find(vertex).map(|at| self.square(at));
                *found = found.or_else(|| all().filter(|it| it.points >= few).map(|it| [it.least, it.most]));
            }
            if self.cells.len() == 1 {
                break;
            }
            self = self.coarser();
        }
        found
    }

    /// The three by three cells around one.
    fn square(&self, [column, row]: [usize; 2]) -> Cell {
        let rows = row.saturating_sub(1)..(row + 2).min(self.rows());
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        let of_row = |row: usize| &self.cells[row * self.columns..][columns.clone()];
        rows.flat_map(of_row).fold(EMPTY, |all, &cell| all.with(cell))
    }

    /// The grid of cells twice as large.
    fn coarser(&self) -> Relief {
        let [columns, rows] = [self.columns, self.rows()].map(|count| count.div_ceil(2));
        let mut cells = vec![EMPTY; columns * rows];
        for (index, &cell) in self.cells.iter().enumerate() {
            let own = &mut cells[index / self.columns / 2 * columns + index % self.columns / 2];
            *own = own.with(cell);
        }
        Relief { origin: self.origin, scale: self.scale / 2.0, columns, cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_points_around_are_found_at_any_distance() {
        let vertices = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]];
        let mut relief = Relief::over(&vertices);
        for number in 0..9 {
            relief.enter(&[f64::from(number % 3), f64::from(number / 3), 50.0 + f64::from(number)]);
            relief.enter(&[f64::NAN, 1e9 * f64::from(number), -1.0]);
        }
        assert_eq!(relief.around(&vertices), [Some([50.0, 58.0]); 2]);
        let mut few = Relief::over(&vertices);
        few.enter(&[0.0, 0.0, 1.0]);
        assert_eq!(few.around(&vertices), [Some([1.0; 2]); 2]);
        assert_eq!(Relief::over(&vertices).around(&vertices), [None; 2]);
        assert_eq!(Relief::over(&vertices[..1]).around(&vertices[..1]), [None]);
    }
}
