//! The points of a batch, in the cells of a grid.

use super::blocks::Box2;
use spmesh_model::bounds::Point;

/// Points per cell, on average over the box of the points.
const POINTS_PER_CELL: usize = 2;

/// Points sorted by the cells of a grid over their box, row by row.
///
/// Memory: 40 bytes for each point.
#[derive(Debug, Default)]
pub(super) struct PointGrid {
    bounds: Option<Box2>,
    columns: usize,
    rows: usize,
    cells_per_step: [f64; 2],
    /// For each cell, its first point; then the number of all points.
    starts: Vec<u32>,
    /// The points in the order of their cells, and their numbers in the batch.
    points: Vec<Point>,
    numbers: Vec<u32>,
}

impl PointGrid {
    /// Replaces the points.
    pub(super) fn fill(&mut self, points: &[Point]) {
        self.bounds = (!points.is_empty()).then(|| Box2::of(points));
        let Some(bounds) = self.bounds else { return };
        let size = [0, 1].map(|axis| (bounds.max[axis] - bounds.min[axis]).max(f64::MIN_POSITIVE));
        let cells = (points.len() / POINTS_PER_CELL).max(1);
        let columns = (cells as f64 * (size[0] / size[1])).sqrt().clamp(1.0, cells as f64);
        self.columns = columns as usize;
        self.rows = (cells / self.columns).max(1);
        self.cells_per_step = [self.columns as f64 / size[0], self.rows as f64 / size[1]];
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        let cell_of = |point: &Point| self.row(point[1]) * self.columns + self.column(point[0]);
        let cells: Vec<u32> = points.iter().map(|point| cell_of(point) as u32).collect();
        for &cell in &cells {
            self.starts[cell as usize + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        self.points.resize(points.len(), [0.0; 3]);
        self.numbers.resize(points.len(), 0);
        for (number, (&point, &cell)) in points.iter().zip(&cells).enumerate() {
            let at = &mut next[cell as usize];
            self.points[*at as usize] = point;
            self.numbers[*at as usize] = number as u32;
            *at += 1;
        }
    }

    /// The box of all points; `None` if there are none.
    pub(super) fn bounds(&self) -> Option<&Box2> {
        self.bounds.as_ref()
    }

    /// The points, in the order of their cells.
    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }

    /// For each of them, its number in the batch.
    pub(super) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Whether a cell that meets the box has a point.
    pub(super) fn has_points_in(&self, bounds: &Box2) -> bool {
        self.ranges(bounds).any(|range| !range.is_empty())
    }

    /// The points in the cells that meet a box, as ranges of [`PointGrid::points`].
    #[inline]
    pub(super) fn ranges(&self, bounds: &Box2) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let meets = self.bounds.is_some_and(|own| own.meets(bounds));
        let [rows, columns] = match meets {
            true => [
                self.row(bounds.min[1])..self.row(bounds.max[1]) + 1,
                self.column(bounds.min[0])..self.column(bounds.max[0]) + 1,
            ],
            false => [0..0, 0..0],
        };
        rows.map(move |row| {
            let first = row * self.columns;
            self.starts[first + columns.start] as usize..self.starts[first + columns.end] as usize
        })
    }

    fn column(&self, x: f64) -> usize {
        let least = self.bounds.map_or(0.0, |bounds| bounds.min[0]);
        // Conversion saturates, so places beside the box get the outermost cells.
        (((x - least) * self.cells_per_step[0]) as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        let least = self.bounds.map_or(0.0, |bounds| bounds.min[1]);
        (((y - least) * self.cells_per_step[1]) as usize).min(self.rows - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_core::random::Random;

    #[test]
    fn cells_of_a_box_hold_its_points() {
        let mut random = Random::new(7);
        for len in [1, 2, 3, 100, 1000] {
            for flat in [[1.0, 1.0], [1.0, 0.0], [0.0, 0.0], [1e-300, 1e300]] {
                let points: Vec<Point> =
                    (0..len).map(|_| [random.unit() * flat[0], random.unit() * flat[1], 0.0]).collect();
                let mut grid = PointGrid::default();
                grid.fill(&points);
                let mut numbers = grid.numbers().to_vec();
                numbers.sort_unstable();
                assert_eq!(numbers, (0..len as u32).collect::<Vec<_>>());
                for _ in 0..50 {
                    let corners = [0, 1].map(|_| [random.unit() * flat[0], random.unit() * flat[1], 0.0]);
                    let bounds = Box2::of(&corners);
                    let found: Vec<usize> = grid.ranges(&bounds).flatten().collect();
                    for (at, point) in grid.points().iter().enumerate() {
                        let is_inside = bounds.meets(&Box2::of([point]));
                        assert!(!is_inside || found.contains(&at), "{point:?} {bounds:?}");
                    }
                }
            }
        }
    }
}
