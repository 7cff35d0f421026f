//! The leaves of a batch of points: from a table of cells, and by binary search where leaves are smaller than
//! its cells.

use super::cell_grid::CellGrid;
use super::passes::input_changed;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::{CellCode, CellTree};

/// In the table: a cell that is in no leaf, and one that several leaves share.
const EMPTY: u32 = u32::MAX;
const DIVIDED: u32 = u32::MAX - 1;

/// Most cells of the table, as a power of two: its 256 KiB stay in the cache of a core.
const LOG_TABLE_MAX: u32 = 16;

/// Finds the leaves of points.
pub(super) struct Locator {
    tree: CellTree,
    /// In the order of the tree: increasing when extended to the same depth.
    leaves: Vec<CellCode>,
    /// `None` if cells are too small for [`CellGrid`], which cannot happen in a finite cube around points.
    grids: Option<Grids>,
    /// Leaf of each cell of the table, row by row.
    table: Vec<u32>,
}

/// The cells of the table, and the deepest ones.
#[derive(Clone, Copy)]
struct Grids {
    table: CellGrid,
    deepest: CellGrid,
}

impl Locator {
    /// A locator of `leaves`, whose table takes up `bytes` at most.
    pub(super) fn new(tree: CellTree, leaves: Vec<CellCode>, bytes: u64) -> Locator {
        let dims = u32::from(tree.dims());
        let log_cells = (bytes / 4).max(1).ilog2().min(LOG_TABLE_MAX);
        let level = ((log_cells / dims) as u8).min(tree.depth());
        let grid = |level| CellGrid::new(&tree, level);
        let grids = grid(level).zip(grid(tree.depth())).map(|(table, deepest)| Grids { table, deepest });
        let mut table = vec![EMPTY; 1 << (dims * u32::from(level))];
        for (number, &leaf) in leaves.iter().enumerate() {
            enter(&mut table, &tree, level, leaf, number as u32);
        }
        Locator { tree, leaves, grids, table }
    }

    /// The cells that are leaves.
    pub(super) fn leaves(&self) -> &[CellCode] {
        &self.leaves
    }

    /// Replaces the content of `found` by the number of the leaf of each point. All points must lie in the
    /// cube.
    pub(super) fn locate(&self, points: &[Point], found: &mut Vec<u32>) -> Result<()> {
        let Some(Grids { table, deepest }) = self.grids else {
            return self.search_all(points, found);
        };
        table.find_numbers(points, found);
        found.iter_mut().for_each(|found| *found = self.table[*found as usize]);
        let mut last = 0;
        for (leaf, &point) in found.iter_mut().zip(points) {
            if *leaf >= DIVIDED {
                if *leaf == EMPTY {
                    return Err(input_changed());
                }
                last = self.search(deepest.cell_of(point).0, last)?;
                *leaf = last;
            }
        }
        Ok(())
    }

    /// [`Locator::locate`] without the table.
    fn search_all(&self, points: &[Point], found: &mut Vec<u32>) -> Result<()> {
        found.clear();
        let mut last = 0;
        for &point in points {
            last = self.search(self.tree.cell_of(point, self.tree.depth()).0, last)?;
            found.push(last);
        }
        Ok(())
    }

    /// Number of the leaf that holds the deepest cell `code`; `last` is a guess.
    fn search(&self, code: u64, last: u32) -> Result<u32> {
        if self.holds(last as usize, code) {
            return Ok(last);
        }
        let after = self.leaves.partition_point(|leaf| extend(leaf.0, code) <= code);
        let leaf = after.saturating_sub(1);
        if self.holds(leaf, code) { Ok(leaf as u32) } else { Err(input_changed()) }
    }

    fn holds(&self, leaf: usize, code: u64) -> bool {
        let leaf = self.leaves[leaf].0;
        code >> (leaf.leading_zeros() - code.leading_zeros()) == leaf
    }
}

/// The first descendant of `cell` that is as deep as `code`.
fn extend(cell: u64, code: u64) -> u64 {
    cell << (cell.leading_zeros() - code.leading_zeros())
}

/// Enters the leaf with this `number` in the cells of `level` that it covers or divides.
fn enter(table: &mut [u32], tree: &CellTree, level: u8, leaf: CellCode, number: u32) {
    let (leaf_level, index) = tree.decode(leaf);
    let (value, span) = if leaf_level > level { (DIVIDED, 1) } else { (number, 1 << (level - leaf_level)) };
    let first = index.map(|i| if leaf_level > level { i >> (leaf_level - level) } else { i * span });
    let layers = if tree.dims() == 3 { first[2]..first[2] + span } else { 0..1 };
    for z in layers {
        for y in first[1]..first[1] + span {
            let start = (((z as usize) << level | y as usize) << level) + first[0] as usize;
            table[start..start + span as usize].fill(value);
        }
    }
}
