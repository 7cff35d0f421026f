//! A batch of points gets the same cells as its points one by one, on borders of cells, too.

use spmesh_pipeline::finalize::cell_grid::CellGrid;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::CellTree;

/// SplitMix64 by Steele, Lea and Flood.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Boxes of all sizes and places for which a tree exists.
const EXTENTS: [[f64; 2]; 13] = [
    [0.0, 1.0],
    [-1.0, 1.0],
    [0.1, 0.3],
    [-1e9, 1e9],
    [499_000.25, 512_345.75],
    [-2_147_483_648.0, 2_147_483_647.0],
    [1e15, 1e15 + 2.0],
    [-1e-300, 3e-300],
    [-3.5e-310, 2e-309],
    [0.0, 5e-324],
    [-1e300, 8e305],
    [-1e307, 2e307],
    [7.0, 7.0],
];

/// Points in the cube on, just below and just above borders of cells, and anywhere.
fn coordinates(tree: &CellTree, axis: usize, level: u8, random: &mut Random) -> Vec<f64> {
    let (low, side) = (tree.origin()[axis], tree.side());
    let cells = (1u64 << level) as f64;
    let high = low + side;
    let mut values = vec![low, low.next_up(), high.next_down(), low + side / 2.0];
    for _ in 0..40 {
        let border = low + (random.unit() * cells).floor() * (side / cells);
        values.extend([border, border.next_down(), border.next_up(), low + random.unit() * side]);
        // The differences of these values to the origin are rounded up to a border.
        values.push(border - f64::from_bits(1));
        values.push(border - border.abs() * f64::EPSILON / 4.0);
    }
    values.retain(|&value| low <= value && value < high);
    values
}

#[test]
fn batches_and_single_points_have_the_same_cells() {
    let mut random = Random(7);
    let mut compared = 0;
    for dims in [2u8, 3] {
        let deepest = if dims == 2 { 31 } else { 20 };
        for [min, max] in EXTENTS {
            let bounds = Bounds { min: [min; 3], max: [max; 3] };
            let tree = CellTree::covering(&bounds, dims, deepest).expect("a tree around the box");
            for level in [0, 1, 2, 5, 9, 10, 15, 19, 20, 30, 31].into_iter().filter(|&level| level <= deepest)
            {
                let grid = CellGrid::new(&tree, level).expect("cells of a finite cube");
                let [xs, ys, zs] =
                    [0, 1, 2].map(|axis| coordinates(&tree, axis.min(dims as usize - 1), level, &mut random));
                for (at, &x) in xs.iter().enumerate() {
                    let point: Point = [x, ys[at * 7 % ys.len()], zs[at * 13 % zs.len()]];
                    let cell = tree.cell_of(point, level);
                    assert_eq!(grid.cell_of(point), cell, "{point:?} at level {level} of {tree:?}");
                    let (min, max) = tree.corners(cell);
                    let axes = 0..dims as usize;
                    assert!(axes.clone().all(|axis| min[axis] <= point[axis] && point[axis] < max[axis]));
                    if u32::from(dims) * u32::from(level) < 32 {
                        let (_, [x, y, z]) = tree.decode(cell);
                        let number = (u64::from(z) << level | u64::from(y)) << level | u64::from(x);
                        assert_eq!(u64::from(grid.number_of(point)), number, "{point:?} at level {level}");
                    }
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 30_000, "{compared}");
}

#[test]
fn numbers_stay_in_the_table_wherever_the_point_is() {
    let bounds = Bounds { min: [-5.0; 3], max: [100.0; 3] };
    for dims in [2, 3] {
        let tree = CellTree::covering(&bounds, dims, 5).expect("a tree around the box");
        let grid = CellGrid::new(&tree, 5).expect("cells");
        for value in [-1e300, -129.0, -6.0, 128.0, 1e9, 1e300, f64::INFINITY, f64::NAN] {
            for point in [[value, 0.0, 0.0], [0.0, value, 0.0], [0.0, 0.0, value], [value; 3]] {
                assert!(grid.number_of(point) < 1 << (dims * 5));
            }
        }
    }
}

#[test]
fn levels_beyond_the_depth_have_no_grid() {
    let tree = CellTree::new(2, 4, [0.0; 3], 16.0).expect("a tree");
    assert!(CellGrid::new(&tree, 4).is_some() && CellGrid::new(&tree, 5).is_none());
    // No tree around points is as small as this one, whose cell side has an infinite reciprocal.
    let tiny = CellTree::new(2, 31, [0.0; 3], 2f64.powi(-1000)).expect("a tree");
    assert!(CellGrid::new(&tiny, 31).is_none());
}
