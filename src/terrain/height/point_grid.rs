//! The points of a batch, in the cells of a grid.

use std::ops::Range;

use super::boxes::Box2;
use spmesh_stream::model::bounds::Point;

/// Points per cell, on average over the box of the points.
const POINTS_PER_CELL: usize = 2;

/// A cell by column and row; those beside the grid may have any number below 0, or from the number of columns
/// or rows on.
pub(super) type Cell = [i32; 2];

/// Points sorted by the cells of a grid over their box, row by row, that wait for their heights.
///
/// Memory: 36 bytes for each point.
#[derive(Debug, Default)]
pub(super) struct PointGrid {
    cells: Cells,
    /// The points in the order of their cells, and their numbers in the batch.
    points: Vec<Point>,
    numbers: Vec<u32>,
}

/// Which points are in which cells.
#[derive(Debug, Default)]
struct Cells {
    bounds: Option<Box2>,
    columns: usize,
    rows: usize,
    cells_per_step: [f64; 2],
    /// For each cell, its first point; then the number of all points.
    starts: Vec<u32>,
}

/// Some rows of a grid.
#[derive(Debug)]
pub(super) struct Rows<'g> {
    cells: &'g Cells,
    rows: Range<usize>,
    /// Number of points in the rows before.
    before: usize,
}

/// Gives a point its height in place of its elevation. It waits no longer: no box contains it.
pub(super) fn set_height(point: &mut Point, height: f64) {
    *point = [f64::NAN, f64::NAN, height];
}

/// The height of a point; `None` if it waits for one.
pub(super) fn height_of(&[x, _, height]: &Point) -> Option<f64> {
    x.is_nan().then_some(height)
}

impl PointGrid {
    /// Replaces the points. Domain: coordinates are finite, and so are the sides of their box.
    pub(super) fn fill(&mut self, points: &[Point]) {
        self.points.resize(points.len(), [0.0; 3]);
        self.numbers.resize(points.len(), 0);
        let mut next = self.cells.fill(points);
        for (number, &point) in points.iter().enumerate() {
            let at = &mut next[self.cells.index_of(&point)];
            self.points[*at as usize] = point;
            self.numbers[*at as usize] = number as u32;
            *at += 1;
        }
    }

    /// The points with their numbers in the batch.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (u32, &Point)> {
        self.numbers.iter().copied().zip(&self.points)
    }

    /// The rows in at most `parts` parts with about as many points each, and their points.
    pub(super) fn split(&mut self, parts: usize) -> Vec<(Rows<'_>, &mut [Point])> {
        let cells = &self.cells;
        let (mut shares, mut left, mut row, mut before) = (Vec::new(), &mut self.points[..], 0, 0);
        for part in 1..=parts {
            let until = (left.len() + before) * part / parts;
            let end = if part == parts { cells.rows } else { cells.row_after(until, row) };
            let here = cells.first_of_row(end) - before;
            let (points, others) = left.split_at_mut(here);
            if here > 0 {
                shares.push((Rows { cells, rows: row..end, before }, points));
            }
            (left, row, before) = (others, end, before + here);
        }
        shares
    }
}

impl Cells {
    /// Replaces the cells with those for `points`. Returns the first point of each.
    fn fill(&mut self, points: &[Point]) -> Vec<u32> {
        self.bounds = (!points.is_empty()).then(|| Box2::of(points));
        let Some(bounds) = self.bounds else {
            *self = Cells { starts: vec![0], ..Cells::default() };
            return Vec::new();
        };
        let size = [0, 1].map(|axis| (bounds.max[axis] - bounds.min[axis]).max(f64::MIN_POSITIVE));
        let count = (points.len() / POINTS_PER_CELL).max(1);
        let columns = (count as f64 * (size[0] / size[1])).sqrt().clamp(1.0, count as f64);
        self.columns = columns as usize;
        self.rows = (count / self.columns).max(1);
        self.cells_per_step = [self.columns as f64 / size[0], self.rows as f64 / size[1]];
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        for point in points {
            let index = self.index_of(point);
            self.starts[index + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.starts.clone()
    }

    /// The cell of a place.
    #[inline]
    fn of(&self, place: &Point) -> Cell {
        let least = self.bounds.map_or([0.0; 2], |bounds| bounds.min);
        // Conversion saturates.
        [0, 1].map(|axis| ((place[axis] - least[axis]) * self.cells_per_step[axis]) as i32)
    }

    /// The index of the cell of a point inside of the bounds. Places on their upper sides are in the last
    /// cells.
    fn index_of(&self, point: &Point) -> usize {
        let [column, row] = self.of(point).map(|number| number as usize);
        row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)
    }

    /// The first row, from `row` on, that begins with point `until` or a later one.
    fn row_after(&self, until: usize, row: usize) -> usize {
        (row..self.rows).find(|&row| self.first_of_row(row) >= until).unwrap_or(self.rows)
    }

    /// The first point of a row, counted over the grid.
    fn first_of_row(&self, row: usize) -> usize {
        self.starts[row * self.columns] as usize
    }
}

impl Rows<'_> {
    /// Whether a cell that meets the box has a point.
    pub(super) fn has_points_in(&self, bounds: &Box2) -> bool {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y]| self.cell_of(&[x, y, 0.0]));
        self.ranges(min, max).any(|range| !range.is_empty())
    }

    /// The cell of a place.
    #[inline]
    pub(super) fn cell_of(&self, place: &Point) -> Cell {
        self.cells.of(place)
    }

    /// The points in the cells from `min` to `max`, as ranges of the points in these rows.
    #[inline]
    pub(super) fn ranges(&self, min: Cell, max: Cell) -> impl Iterator<Item = Range<usize>> + '_ {
        let Cells { columns, rows: all, ref starts, .. } = *self.cells;
        // Places on the upper sides have the numbers after the last ones.
        let is_beside = max[0] < 0 || max[1] < 0 || min[0] > columns as i32 || min[1] > all as i32;
        let [left, right] = [min[0], max[0]].map(|column| (column.max(0) as usize).min(columns - 1));
        let [low, high] = [min[1], max[1]].map(|row| (row.max(0) as usize).min(all - 1));
        let rows = low.max(self.rows.start)..(high + 1).min(self.rows.end);
        let rows = if is_beside { 0..0 } else { rows };
        rows.map(move |row| {
            let first = row * columns;
            let [start, end] =
                [first + left, first + right + 1].map(|cell| starts[cell] as usize - self.before);
            start..end
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    const SIZES: [[f64; 2]; 5] = [[1.0, 1.0], [1.0, 0.0], [0.0, 0.0], [1e-300, 1e300], [1e308, 1.0]];

    fn random_points(random: &mut Random, len: usize, size: [f64; 2]) -> Vec<Point> {
        (0..len).map(|_| [random.unit() * size[0], random.unit() * size[1], 0.0]).collect()
    }

    #[test]
    fn points_keep_their_numbers() {
        let mut random = Random::new(5);
        for (len, size) in [1, 2, 3, 100, 1000].iter().flat_map(|&len| SIZES.map(|size| (len, size))) {
            let points = random_points(&mut random, len, size);
            let mut grid = PointGrid::default();
            grid.fill(&points);
            let mut numbered: Vec<_> = grid.numbered().map(|(number, &point)| (number, point)).collect();
            numbered.sort_unstable_by_key(|&(number, _)| number);
            assert_eq!(numbered, (0..).zip(points).collect::<Vec<_>>());
        }
    }

    #[test]
    fn cells_of_a_box_hold_its_points() {
        let mut random = Random::new(7);
        for (len, size) in [1, 2, 3, 100, 1000].iter().flat_map(|&len| SIZES.map(|size| (len, size))) {
            let mut grid = PointGrid::default();
            grid.fill(&random_points(&mut random, len, size));
            for parts in [1, 2, 5] {
                let shares = grid.split(parts);
                assert_eq!(shares.iter().map(|(_, points)| points.len()).sum::<usize>(), len);
                for _ in 0..50 {
                    let bounds = Box2::of(&random_points(&mut random, 2, size));
                    shares.iter().for_each(|(rows, points)| check(rows, points, &bounds));
                }
            }
        }
    }

    /// Every point of the rows in a box is in one of its cells.
    fn check(rows: &Rows, points: &[Point], bounds: &Box2) {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y]| rows.cell_of(&[x, y, 0.0]));
        let found: Vec<usize> = rows.ranges(min, max).flatten().collect();
        for (at, point) in points.iter().enumerate() {
            assert!(!bounds.contains(point) || found.contains(&at), "{point:?} {bounds:?}");
        }
        assert!(found.is_empty() || rows.has_points_in(bounds));
    }
}
