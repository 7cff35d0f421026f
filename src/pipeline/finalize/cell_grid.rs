//! The cells of one level of a tree, for many points at once.
//!
//! [`CellTree::cell_of`] finds the cell of one point, at any level. [`CellGrid`] computes everything that
//! depends on the level once; the rest is a few operations without branches, so that a loop over a batch is
//! vectorized. Both find the same cell for every point (`tests/cell_grid.rs`).

use spmesh_base::wide::{Loop, run_wide};
use spmesh_stream::model::bits::{spread2, spread3};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::{CellCode, CellTree};

/// The cells of one level of a tree.
#[derive(Debug, Clone, Copy)]
pub struct CellGrid {
    dims: u8,
    level: u8,
    origin: Point,
    /// Side of a cell, and its reciprocal: powers of two, so that multiplying by them rounds nothing.
    step: f64,
    cells_per_unit: f64,
}

impl CellGrid {
    /// The cells of `level`; `None` if the reciprocal of their side is not finite and normal.
    /// [`CellTree::covering`] never makes such a tree.
    pub fn new(tree: &CellTree, level: u8) -> Option<CellGrid> {
        let step = tree.side() / (1u64 << level) as f64;
        let cells_per_unit = 1.0 / step;
        let grid = CellGrid { dims: tree.dims(), level, origin: tree.origin(), step, cells_per_unit };
        (level <= tree.depth() && cells_per_unit.is_finite() && cells_per_unit.is_normal()).then_some(grid)
    }

    /// Index on an axis of the half-open cell that holds `x`, which must lie in the cube.
    ///
    /// Borders are exact, and rounding is monotone: the rounded difference of a point below a border may
    /// reach the border, but not exceed it. So the index is right or one too large, and a comparison with the
    /// border decides.
    #[inline(always)]
    fn index(&self, axis: usize, x: f64) -> u32 {
        let index = ((x - self.origin[axis]) * self.cells_per_unit) as i32;
        let border = self.origin[axis] + f64::from(index) * self.step;
        index.wrapping_sub(i32::from(x < border)) as u32
    }

    /// The cell that holds `point`. For a point outside of the cube, any code.
    #[inline(always)]
    pub fn cell_of(&self, point: Point) -> CellCode {
        let morton = if self.dims == 2 {
            spread2(self.index(0, point[0])) | spread2(self.index(1, point[1])) << 1
        } else {
            spread3(self.index(0, point[0]))
                | spread3(self.index(1, point[1])) << 1
                | spread3(self.index(2, point[2])) << 2
        };
        CellCode(1 << (self.dims * self.level) | morton)
    }

    /// Sets `cells` to the cell of each point.
    pub(super) fn find_cells(&self, points: &[Point], cells: &mut Vec<CellCode>) {
        cells.resize(points.len(), CellCode(0));
        run_wide(Cells { grid: *self, points, cells });
    }

    /// Sets `numbers` to the row-major index of the cell of each point.
    pub(super) fn find_numbers(&self, points: &[Point], numbers: &mut Vec<u32>) {
        numbers.resize(points.len(), 0);
        run_wide(Numbers { grid: *self, points, numbers });
    }

    /// Row-major index of the cell that holds `point`, below `2^(dims * level)`, which must be less than
    /// 2^32. For a point outside of the cube, any index below that bound.
    #[inline(always)]
    pub fn number_of(&self, point: Point) -> u32 {
        let mut number = self.index(1, point[1]);
        if self.dims == 3 {
            number |= self.index(2, point[2]) << self.level;
        }
        let mask = ((1u64 << (self.dims * self.level)) - 1) as u32;
        (number << self.level | self.index(0, point[0])) & mask
    }
}

struct Cells<'a> {
    grid: CellGrid,
    points: &'a [Point],
    cells: &'a mut [CellCode],
}

impl Loop for Cells<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Cells { grid, points, cells } = self;
        // With the number of dimensions known, the loop has no branch.
        if grid.dims == 2 {
            let grid = CellGrid { dims: 2, ..grid };
            for (cell, &point) in cells.iter_mut().zip(points) {
                *cell = grid.cell_of(point);
            }
        } else {
            let grid = CellGrid { dims: 3, ..grid };
            for (cell, &point) in cells.iter_mut().zip(points) {
                *cell = grid.cell_of(point);
            }
        }
    }
}

struct Numbers<'a> {
    grid: CellGrid,
    points: &'a [Point],
    numbers: &'a mut [u32],
}

impl Loop for Numbers<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Numbers { grid, points, numbers } = self;
        if grid.dims == 2 {
            let grid = CellGrid { dims: 2, ..grid };
            for (number, &point) in numbers.iter_mut().zip(points) {
                *number = grid.number_of(point);
            }
        } else {
            let grid = CellGrid { dims: 3, ..grid };
            for (number, &point) in numbers.iter_mut().zip(points) {
                *number = grid.number_of(point);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    #[test]
    fn a_batch_has_the_cells_of_its_points_one_by_one() {
        let mut random = Random::new(5);
        for dims in [2, 3] {
            let tree = CellTree::new(dims, 10, [-512.0; 3], 1024.0).expect("the tree is exact");
            let grid = CellGrid::new(&tree, 10).expect("cells of side 1");
            let (mut cells, mut numbers) = (vec![CellCode(9); 50], vec![7; 50]);
            for count in [100, 0, 1, 7, 33] {
                let coordinate = |random: &mut Random| (random.below(4096) as f64 - 2048.0) / 4.0;
                let points: Vec<Point> =
                    (0..count).map(|_| std::array::from_fn(|_| coordinate(&mut random))).collect();
                grid.find_cells(&points, &mut cells);
                grid.find_numbers(&points, &mut numbers);
                assert!(cells.iter().copied().eq(points.iter().map(|&point| tree.cell_of(point, 10))));
                assert!(numbers.iter().copied().eq(points.iter().map(|&point| grid.number_of(point))));
            }
        }
    }
}
