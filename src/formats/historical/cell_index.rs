//! Cell indices of the historical point formats. Cells are numbered level by level from the root (0); the
//! children of cell i are 2^dims i + 1 onwards. In a child's number bit 0 is set for the lower half in x, bit
//! 1 for the upper half in y, bit 2 for the lower half in z.

use spmesh_stream::model::cells::{CellCode, CellTree};

/// Deepest level whose cells all have an index of 31 bits.
pub(crate) fn level_max(dims: u8) -> u8 {
    if dims == 2 { 15 } else { 10 }
}

/// Bits in which a child's number differs from its location code.
fn flip(dims: u8) -> u64 {
    if dims == 2 { 0b01 } else { 0b101 }
}

/// Index of a cell; `None` if it is deeper than [`level_max`].
pub(crate) fn index_of(tree: &CellTree, cell: CellCode) -> Option<i32> {
    let (dims, level) = (tree.dims(), tree.level(cell));
    let children = 1u64 << dims;
    let path = (0..level).rev().map(|step| cell.0 >> (step * dims) & (children - 1));
    let index = || path.fold(0, |parent, child| parent * children + 1 + (child ^ flip(dims)));
    (level <= level_max(dims)).then(|| index() as i32)
}

/// The cell of an index; `None` if the tree has none.
pub(crate) fn cell_of(tree: &CellTree, index: i32) -> Option<CellCode> {
    let dims = tree.dims();
    let children = 1u64 << dims;
    let mut rest = u64::try_from(index).ok()?;
    let (mut code, mut shift) = (0, 0);
    while rest > 0 {
        code |= (((rest - 1) % children) ^ flip(dims)) << shift;
        rest = (rest - 1) / children;
        shift += dims;
    }
    let cell = CellCode(code | 1 << shift);
    tree.is_valid(cell).then_some(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrants_are_numbered_lower_x_then_upper_y() {
        let tree = CellTree::new(2, 3, [0.0; 3], 8.0).unwrap();
        let at = |x: f64, y: f64, level| index_of(&tree, tree.cell_of([x, y, 0.0], level)).unwrap();
        assert_eq!(at(0.0, 0.0, 0), 0);
        assert_eq!([at(7.0, 0.0, 1), at(0.0, 0.0, 1), at(7.0, 7.0, 1), at(0.0, 7.0, 1)], [1, 2, 3, 4]);
        assert_eq!([at(7.0, 0.0, 2), at(0.0, 7.0, 2)], [5, 20]);
    }

    #[test]
    fn cells_and_indices_are_one_to_one() {
        for (dims, cells) in [(2, 1 + 4 + 16 + 64), (3, 1 + 8 + 64 + 512)] {
            let tree = CellTree::new(dims, 3, [0.0; 3], 8.0).unwrap();
            for index in 0..cells {
                assert_eq!(index_of(&tree, cell_of(&tree, index).unwrap()), Some(index));
            }
            assert_eq!([cell_of(&tree, cells), cell_of(&tree, -1), cell_of(&tree, i32::MAX)], [None; 3]);
        }
    }

    #[test]
    fn cells_deeper_than_31_bits_have_no_index() {
        for dims in [2, 3] {
            let deepest = level_max(dims);
            let tree = CellTree::new(dims, deepest + 1, [0.0; 3], 1.0).unwrap();
            let last = |level: u8| CellCode((2 << (level * dims)) - 1);
            let index = index_of(&tree, last(deepest)).unwrap();
            assert_eq!(cell_of(&tree, index), Some(last(deepest)));
            assert_eq!(index_of(&tree, last(deepest + 1)), None);
        }
    }
}
