//! The finalization tree: a quadtree or octree over a cube whose cell borders are exact in f64.
//!
//! Cells are half-open, so that every point of the cube lies in exactly one cell of each level. A cell is
//! named by its *location code*: a leading 1 bit, then the interleaved bits of its integer coordinates, so
//! that the root is 1, and the children of `c` are `c * 2^dims + 0 ..`.

use crate::model::bits::{gather2, gather3, spread2, spread3};
use crate::model::bounds::{Bounds, Point};
use spmesh_base::limits::{OCTREE_DEPTH_MAX, QUADTREE_DEPTH_MAX};

/// Location code of a cell; the number of dimensions comes from its [`CellTree`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellCode(pub u64);

impl CellCode {
    /// The cell that is the whole cube.
    pub const ROOT: CellCode = CellCode(1);
}

/// A quadtree (`dims` 2) or octree (`dims` 3) over the cube `[origin, origin + side)`.
///
/// Invariant: every border `origin + i * side / 2^depth` is exact in f64, which [`CellTree::new`] checks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellTree {
    dims: u8,
    depth: u8,
    origin: Point,
    side: f64,
}

impl CellTree {
    /// A tree from its parts; `None` if a part is out of range or a border could be rounded.
    ///
    /// Domain: `side` is a normal power of two; `origin` is a multiple of `side / 2^31`, and
    /// `|origin| + side < side * 2^22`. Then every border down to level 31 is a multiple of `side / 2^31`
    /// with a factor below 2^53, which f64 represents exactly.
    pub fn new(dims: u8, depth: u8, origin: Point, side: f64) -> Option<Self> {
        let unit = side / FINEST_CELLS;
        let is_power_of_two = side > 0.0 && side.is_normal() && mantissa(side) == 0;
        if depth > depth_max(dims)? || !is_power_of_two || unit == 0.0 {
            return None;
        }
        let exact = (0..usize::from(dims)).all(|axis| {
            let steps = origin[axis] / unit;
            steps.fract() == 0.0
                && steps.abs() + FINEST_CELLS < 2f64.powi(53)
                && steps * unit == origin[axis]
                && (origin[axis] + side).is_finite()
        });
        exact.then_some(CellTree { dims, depth, origin, side })
    }

    /// The smallest tree of `depth` levels whose cube contains `bounds` and whose borders are exact.
    ///
    /// `None` if no such cube is finite (extents near the end of the range of f64).
    pub fn covering(bounds: &Bounds, dims: u8, depth: u8) -> Option<Self> {
        let axes = 0..usize::from(dims);
        let extent = axes.clone().map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f64::max);
        let magnitude =
            axes.clone().map(|axis| bounds.min[axis].abs().max(bounds.max[axis].abs())).fold(0.0, f64::max);
        if !extent.is_finite() {
            return None;
        }
        let first = exponent(extent).max(exponent(magnitude) - 20).max(LOG_SIDE_MIN);
        (first..=1022).find_map(|log_side| {
            let side = 2f64.powi(log_side);
            let unit = side / FINEST_CELLS;
            let mut origin = [0.0; 3];
            for axis in axes.clone() {
                let steps = (bounds.min[axis] / unit).floor();
                // The quotient of a tiny negative number may underflow to -0.
                let is_rounded_up = steps * unit > bounds.min[axis];
                origin[axis] = if is_rounded_up { (steps - 1.0) * unit } else { steps * unit };
            }
            let holds = axes.clone().all(|axis| bounds.max[axis] < origin[axis] + side);
            if holds { CellTree::new(dims, depth, origin, side) } else { None }
        })
    }

    /// Number of dimensions, 2 or 3.
    pub fn dims(&self) -> u8 {
        self.dims
    }

    /// Deepest level that a cell can have; the root has level 0.
    pub fn depth(&self) -> u8 {
        self.depth
    }

    /// Lower corner of the cube.
    pub fn origin(&self) -> Point {
        self.origin
    }

    /// Side of the cube, a power of two.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Whether `point` lies in the half-open cube.
    pub fn contains(&self, point: Point) -> bool {
        self.axes()
            .all(|axis| self.origin[axis] <= point[axis] && point[axis] < self.origin[axis] + self.side)
    }

    /// The cell of `level` that contains `point`, which must lie in the cube.
    pub fn cell_of(&self, point: Point, level: u8) -> CellCode {
        debug_assert!(level <= self.depth && self.contains(point));
        let mut index = [0u32; 3];
        for axis in self.axes() {
            index[axis] = self.index_on_axis(axis, point[axis], level);
        }
        self.encode(level, index)
    }

    /// The cell of `level` at integer coordinates `index`, each below `2^level`.
    pub fn encode(&self, level: u8, index: [u32; 3]) -> CellCode {
        let morton = if self.dims == 2 {
            spread2(index[0]) | spread2(index[1]) << 1
        } else {
            spread3(index[0]) | spread3(index[1]) << 1 | spread3(index[2]) << 2
        };
        CellCode(1 << (self.dims * level) | morton)
    }

    /// Level and integer coordinates of `cell`.
    pub fn decode(&self, cell: CellCode) -> (u8, [u32; 3]) {
        let level = self.level(cell);
        let morton = cell.0 ^ 1 << (self.dims * level);
        let index = if self.dims == 2 {
            [gather2(morton), gather2(morton >> 1), 0]
        } else {
            [gather3(morton), gather3(morton >> 1), gather3(morton >> 2)]
        };
        (level, index)
    }

    /// Whether `cell` is a cell of this tree.
    pub fn is_valid(&self, cell: CellCode) -> bool {
        let bits = 63 - cell.0.max(1).leading_zeros();
        cell.0 > 0 && bits.is_multiple_of(u32::from(self.dims)) && bits <= u32::from(self.dims * self.depth)
    }

    /// Level of `cell`; the root has level 0.
    pub fn level(&self, cell: CellCode) -> u8 {
        (63 - cell.0.leading_zeros()) as u8 / self.dims
    }

    /// The cell that contains `cell` one level up; `None` for the root.
    pub fn parent(&self, cell: CellCode) -> Option<CellCode> {
        (cell != CellCode::ROOT).then_some(CellCode(cell.0 >> self.dims))
    }

    /// The `2^dims` cells that divide `cell`, in Morton order. `cell` must be above the deepest level.
    pub fn children(&self, cell: CellCode) -> impl Iterator<Item = CellCode> + use<> {
        let first = cell.0 << self.dims;
        (first..first + (1 << self.dims)).map(CellCode)
    }

    /// The range of location codes of the deepest level inside `cell`; they are consecutive.
    pub fn deepest_range(&self, cell: CellCode) -> std::ops::Range<u64> {
        let shift = self.dims * (self.depth - self.level(cell));
        cell.0 << shift..(cell.0 + 1) << shift
    }

    /// Lower (included) and upper (excluded) corner of `cell`, exact.
    pub fn corners(&self, cell: CellCode) -> (Point, Point) {
        let (level, index) = self.decode(cell);
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in self.axes() {
            min[axis] = self.border(axis, level, index[axis]);
            max[axis] = self.border(axis, level, index[axis] + 1);
        }
        (min, max)
    }

    fn axes(&self) -> std::ops::Range<usize> {
        0..usize::from(self.dims)
    }

    /// Lower border of the `i`-th cell of `level` on an axis, exact by the invariant.
    fn border(&self, axis: usize, level: u8, i: u32) -> f64 {
        self.origin[axis] + f64::from(i) * (self.side / cells_per_axis(level))
    }

    /// Index of the half-open cell of `level` that holds `x`. The quotient is rounded, so the index can be
    /// off by one; the exact borders correct it.
    fn index_on_axis(&self, axis: usize, x: f64, level: u8) -> u32 {
        let cells = cells_per_axis(level);
        let quotient = (x - self.origin[axis]) / (self.side / cells);
        let mut i = quotient.clamp(0.0, cells - 1.0) as u32;
        if x < self.border(axis, level, i) {
            i -= 1;
        } else if f64::from(i) + 1.0 < cells && x >= self.border(axis, level, i + 1) {
            i += 1;
        }
        i
    }
}

/// Cells per axis at `level`, which is at most 31. (`powi` with a variable exponent is a function call.)
fn cells_per_axis(level: u8) -> f64 {
    (1u64 << level) as f64
}

/// Cells per axis at the finest level whose borders must be exact.
const FINEST_CELLS: f64 = (1u64 << 31) as f64;

/// Base-2 logarithm of the smallest side for which `side / 2^31` is not subnormal.
const LOG_SIDE_MIN: i32 = -1022 + 31;

fn depth_max(dims: u8) -> Option<u8> {
    match dims {
        2 => Some(QUADTREE_DEPTH_MAX),
        3 => Some(OCTREE_DEPTH_MAX),
        _ => None,
    }
}

/// `floor(log2(x))` of a positive normal x; -1023 for zero and subnormal numbers.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1023
}

fn mantissa(x: f64) -> u64 {
    x.to_bits() & ((1 << 52) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_trip() {
        for (dims, level) in [(2, 31), (2, 7), (3, 20), (3, 1)] {
            let tree = CellTree::new(dims, level, [0.0; 3], 2f64.powi(31)).unwrap();
            let top = (1u64 << level) as u32 - 1;
            let index = [top, top / 3, if dims == 3 { top / 2 } else { 0 }];
            let cell = tree.encode(level, index);
            assert!(tree.is_valid(cell));
            assert_eq!(tree.decode(cell), (level, index));
        }
    }

    #[test]
    fn every_point_lies_in_the_corners_of_its_cell() {
        let cases = [
            [-1e9, 1e9],
            [0.1, 0.3],
            [1e15, 1e15 + 2.0],
            [0.0, 0.0],
            [-1.0, 1.0],
            [-3.5e-310, 2e-309],
            [7.0, 8.0],
        ];
        for [low, high] in cases {
            let bounds = Bounds { min: [low, low, 0.0], max: [high, high, 0.0] };
            assert!(CellTree::covering(&bounds, 2, 0).unwrap().contains(bounds.max));
            let tree = CellTree::covering(&bounds, 2, 20).unwrap();
            for step in 0..=64 {
                let x = low + (high - low) * f64::from(step) / 64.0;
                for x in [x, x.next_up().min(high), x.next_down().max(low)] {
                    for level in [0, 1, 7, 20] {
                        let (min, max) = tree.corners(tree.cell_of([x, low, 0.0], level));
                        assert!(min[0] <= x && x < max[0], "{x} in [{}, {}) at {level}", min[0], max[0]);
                    }
                }
            }
        }
    }

    #[test]
    fn a_cube_holds_the_least_and_the_greatest_number_of_its_box() {
        let numbers = [5e-324, 3e-310, f64::MIN_POSITIVE, 1e-300, 1e-10, 0.1, 1.0, 8.0, 1e10, 1e300];
        let signed = || numbers.iter().flat_map(|&number| [number, -number]).chain([0.0, -0.0]);
        for (dims, low) in signed().map(|low| (2, low)).chain(signed().map(|low| (3, low))) {
            for high in signed().filter(|&high| low <= high) {
                let bounds = Bounds { min: [low; 3], max: [high, low, high] };
                let tree = CellTree::covering(&bounds, dims, 20).unwrap();
                assert!(tree.contains(bounds.min) && tree.contains(bounds.max), "{low} to {high}: {tree:?}");
            }
        }
    }

    #[test]
    fn trees_with_rounded_borders_are_refused() {
        assert!(CellTree::new(2, 4, [0.1, 0.0, 0.0], 1.0).is_none());
        assert!(CellTree::new(2, 4, [0.0; 3], 3.0).is_none());
        assert!(CellTree::new(2, 4, [f64::NAN, 0.0, 0.0], 1.0).is_none());
        assert!(CellTree::new(2, 32, [0.0; 3], 1.0).is_none());
        assert!(CellTree::new(4, 1, [0.0; 3], 1.0).is_none());
    }

    #[test]
    fn extents_beyond_the_range_have_no_tree() {
        let bounds = Bounds { min: [-1.7e308, 0.0, 0.0], max: [1.7e308, 0.0, 0.0] };
        assert!(CellTree::covering(&bounds, 2, 4).is_none());
    }

    #[test]
    fn trees_have_a_depth() {
        for (dims, most) in [(2, QUADTREE_DEPTH_MAX), (3, OCTREE_DEPTH_MAX)] {
            assert!(CellTree::new(dims, most, [0.0; 3], 1.0).is_some());
            assert!(CellTree::new(dims, most + 1, [0.0; 3], 1.0).is_none());
        }
    }
}
