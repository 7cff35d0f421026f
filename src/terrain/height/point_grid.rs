//! The points of a batch, in the cells of grids.

use std::ops::Range;

use super::blocks::Triangle;
use super::boxes::Box2;
use spmesh_delaunay::cell_tree::{CellBox, CellTree, Fineness, Item};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;

/// Two points per cell of the first grid, on average over the box of the points.
const FINENESS: Fineness = Fineness {
    items_per_cell: 2.0,
    cells: [1.0, f64::INFINITY],
    entries: [1, 0],
    crowd: 32,
    reach: 0.0,
    is_whole: false,
};

/// If a triangle may have more points in a row of cells, a closer look pays.
pub(super) const MANY: usize = 64;

/// More than all roundings of places in units of cells, at least, and as a part of them.
const MARGINS: [f64; 2] = [1e-6, 16.0 * f64::EPSILON];

/// A cell by column and row; those beside the grid may have any number below 0, or from the number of columns
/// or rows on.
pub(super) type Cell = [i32; 2];

/// Points sorted by the cells of a grid over their box, row by row, that wait for their heights. Points of
/// crowded cells are sorted by cells of their own.
///
/// Memory: 40 bytes for each point, at most twice as much if they are uneven.
#[derive(Debug)]
pub(super) struct PointGrid {
    tree: CellTree,
    /// The points in the order of their cells, and their numbers in the batch.
    points: Vec<Point>,
    numbers: Vec<u32>,
}

/// Some of the points, in the order of their cells.
#[derive(Debug)]
pub(super) struct Share<'g> {
    tree: &'g CellTree,
    /// Where they are among all.
    range: Range<usize>,
}

/// Gives a point its height in place of its elevation, and the slope there. It waits no longer: no box
/// contains it.
pub(super) fn set_height(point: &mut Point, height: f64, slope: f64) {
    *point = [f64::NAN, slope, height];
}

/// The slope at a point that has a height.
pub(super) fn slope_of(&[_, slope, _]: &Point) -> f64 {
    slope
}

/// The height of a point; `None` if it waits for one.
pub(super) fn height_of(&[x, _, height]: &Point) -> Option<f64> {
    x.is_nan().then_some(height)
}

impl Default for PointGrid {
    fn default() -> Self {
        let tree = CellTree::new(0, |_| Item::Place([0.0; 2]), &FINENESS);
        PointGrid { tree, points: Vec::new(), numbers: Vec::new() }
    }
}

impl PointGrid {
    /// Replaces the points. Domain: coordinates are finite, and so are the sides of their box.
    pub(super) fn fill(&mut self, points: &[Point]) {
        let item = |number: u32| {
            let [x, y, _] = points[number as usize];
            Item::Place([x, y])
        };
        self.tree = CellTree::new(points.len() as u32, item, &FINENESS);
        self.numbers.clear();
        self.tree.append_order(&mut self.numbers);
        self.points.clear();
        self.points.extend(self.numbers.iter().map(|&number| points[number as usize]));
    }

    /// The points with their numbers in the batch.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (u32, &Point)> {
        self.numbers.iter().copied().zip(&self.points)
    }

    /// The points in at most `parts` parts with about as many points each.
    pub(super) fn split(&mut self, parts: usize) -> Vec<(Share<'_>, &mut [Point])> {
        let (tree, size) = (&self.tree, self.points.len().div_ceil(parts).max(1));
        let chunks = self.points.chunks_mut(size).enumerate();
        let share = |number: usize, len: usize| Share { tree, range: number * size..number * size + len };
        chunks.map(|(number, points)| (share(number, points.len()), points)).collect()
    }
}

impl Share<'_> {
    /// Whether a cell that meets the box has a point.
    pub(super) fn has_points_in(&self, bounds: &Box2) -> bool {
        self.has_in(self.tree, &CellBox { min: bounds.min, max: bounds.max })
    }

    fn has_in(&self, tree: &CellTree, bounds: &CellBox) -> bool {
        let [min, max] = [bounds.min, bounds.max].map(|corner| tree.grid.local(corner));
        let Some([columns, rows]) = tree.grid.range(&CellBox { min, max }) else { return false };
        (rows[0]..=rows[1]).any(|row| {
            let cells = columns.map(|column| row * tree.grid.size[0] + column);
            if self.here(tree, cells).is_empty() {
                return false;
            }
            let is_in = |cell: usize| match tree.inner(cell) {
                Some(inner) => inner.trees().any(|tree| self.has_in(tree, bounds)),
                None => !self.here(tree, [cell; 2]).is_empty(),
            };
            tree.divided().is_empty() || (cells[0]..=cells[1]).any(is_in)
        })
    }

    /// The points of this share in the cells from one to another.
    #[inline]
    fn here(&self, tree: &CellTree, [first, last]: [usize; 2]) -> Range<usize> {
        let (start, end) = (tree.positions(first).start, tree.positions(last).end);
        let at = |position: usize| position.clamp(self.range.start, self.range.end) - self.range.start;
        at(start)..at(end)
    }

    /// The cell of a place.
    #[inline]
    pub(super) fn cell_of(&self, &[x, y, _]: &Point) -> Cell {
        // Conversion saturates.
        self.tree.grid.local([x, y]).map(|local| local as i32)
    }

    /// The points in the cells from `min` to `max`, as ranges of the points of this share.
    #[inline]
    pub(super) fn ranges(&self, min: Cell, max: Cell) -> impl Iterator<Item = Range<usize>> + '_ {
        let [columns, all] = self.tree.grid.size;
        // Places on the upper sides may have the numbers after the last ones.
        let is_beside = max[0] < 0 || max[1] < 0 || min[0] > columns as i32 || min[1] > all as i32;
        let [left, right] = [min[0], max[0]].map(|column| (column.max(0) as usize).min(columns - 1));
        let [low, high] = [min[1], max[1]].map(|row| (row.max(0) as usize).min(all - 1));
        let rows = if is_beside { 0..0 } else { low..high + 1 };
        rows.map(move |row| self.here(self.tree, [row * columns + left, row * columns + right]))
    }

    /// Calls `found` with ranges of points of this share: all that a triangle contains, and few others.
    ///
    /// # Errors
    /// Those of `found`.
    pub(super) fn for_each_near<E>(
        &self,
        triangle: &Triangle,
        found: &mut impl FnMut(Range<usize>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.for_each_near_in(self.tree, &triangle.map(|[x, y, _]| [x, y]), found)
    }

    fn for_each_near_in<E>(
        &self,
        tree: &CellTree,
        corners: &[Point2; 3],
        found: &mut impl FnMut(Range<usize>) -> Result<(), E>,
    ) -> Result<(), E> {
        let local = corners.map(|corner| tree.grid.local(corner));
        let Some([_, rows]) = tree.grid.range(&CellBox::of(&local)) else { return Ok(()) };
        for row in rows[0]..=rows[1] {
            let Some(columns) = columns(&local, row, tree.grid.size[0]) else { continue };
            let cells = columns.map(|column| row * tree.grid.size[0] + column);
            let here = self.here(tree, cells);
            if here.is_empty() {
                continue;
            }
            if tree.divided().is_empty() {
                found(here)?;
                continue;
            }
            for cell in cells[0]..=cells[1] {
                match tree.inner(cell) {
                    Some(inner) => {
                        inner.trees().try_for_each(|tree| self.for_each_near_in(tree, corners, found))?;
                    }
                    None => found(self.here(tree, [cell; 2]))?,
                }
            }
        }
        Ok(())
    }
}

/// The first and the last column of the cells of a row that a triangle meets, in units of cells.
fn columns(corners: &[Point2; 3], row: usize, count: usize) -> Option<[usize; 2]> {
    let most = corners.iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
    let margin = MARGINS[0] + MARGINS[1] * most;
    if margin.is_nan() || margin >= count as f64 {
        return Some([0, count - 1]);
    }
    let (low, high) = (row as f64 - margin, (row + 1) as f64 + margin);
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for from in 0..3 {
        let [p, q] = [corners[from], corners[(from + 1) % 3]];
        let [p, q] = if p[1] <= q[1] { [p, q] } else { [q, p] };
        if q[1] < low || p[1] > high {
            continue;
        }
        let at =
            |y: f64| if q[1] > p[1] { p[0] + (q[0] - p[0]) * ((y - p[1]) / (q[1] - p[1])) } else { p[0] };
        let ends = if q[1] > p[1] { [at(low.max(p[1])), at(high.min(q[1]))] } else { [p[0], q[0]] };
        (left, right) = (left.min(ends[0]).min(ends[1]), right.max(ends[0]).max(ends[1]));
    }
    let (left, right) = (left - margin, right + margin);
    // Conversions saturate.
    let is_met = left <= right && right >= 0.0 && left <= count as f64;
    is_met.then(|| [left, right].map(|x| (x as usize).min(count - 1)))
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
    fn check(rows: &Share, points: &[Point], bounds: &Box2) {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y]| rows.cell_of(&[x, y, 0.0]));
        let found: Vec<usize> = rows.ranges(min, max).flatten().collect();
        for (at, point) in points.iter().enumerate() {
            assert!(!bounds.contains(point) || found.contains(&at), "{point:?} {bounds:?}");
        }
        assert!(rows.has_points_in(bounds) || !points.iter().any(|point| bounds.contains(point)));
    }

    /// The points that a mesh of small triangles over the unit square is compared with.
    fn work(points: &[Point]) -> usize {
        let mut grid = PointGrid::default();
        grid.fill(points);
        let shares = grid.split(1);
        let mut work = 0;
        for (share, _) in &shares {
            for at in 0..1024 {
                let [x, y] = [f64::from(at % 32) / 32.0, f64::from(at / 32) / 32.0];
                let triangle = [[x, y, 0.0], [x + 0.03, y, 0.0], [x, y + 0.03, 0.0]];
                let mut count = |range: Range<usize>| -> Result<(), ()> {
                    work += range.len();
                    Ok(())
                };
                share.for_each_near(&triangle, &mut count).unwrap();
            }
        }
        work
    }

    #[test]
    fn far_points_at_most_triple_the_work() {
        let points = |len| random_points(&mut Random::new(3), len, [1.0, 1.0]);
        let ordinary = work(&points(8_000));
        assert!(work(&points(16_000)) as f64 <= 2.3 * ordinary as f64);
        for far in [-1e12, -1e3, 2.0, 30.0, 1e3, 1e6, 1e9, 1e300] {
            for others in [vec![[far, 0.5, 0.0]], vec![[far, far, 0.0], [0.2, -far, 0.0]]] {
                let with = work(&[points(8_000), others].concat());
                assert!(with <= 3 * ordinary, "{far}: {with} instead of {ordinary}");
            }
        }
    }

    #[test]
    fn long_triangles_are_compared_with_few_points() {
        let mut grid = PointGrid::default();
        grid.fill(&random_points(&mut Random::new(3), 10_000, [1.0, 1.0]));
        for (share, _) in &grid.split(1) {
            let mut work = 0;
            let triangle = [[0.0, 0.0, 0.0], [1e6, 0.9999e6, 0.0], [1e6, 1e6, 0.0]];
            let Ok::<(), ()>(()) = share.for_each_near(&triangle, &mut |range: Range<usize>| {
                work += range.len();
                Ok(())
            }) else {
                unreachable!()
            };
            assert!(work < 500, "{work}");
        }
    }
}
