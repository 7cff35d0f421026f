//! The cells of the quadtree of an index of LAStools.

use spmesh_base::error::{Error, Result};

/// Most levels below the root: numbers of deeper cells do not fit the 31 bits that the format has for them.
const LEVELS_MAX: u32 = 15;

/// Greatest distance of a border of a cell from where the writer had it, as a fraction of the greatest
/// coordinate: the format stores the root as f32, and writers halve cells as f32 or f64.
const ROUNDING: f64 = 1.0 / (1 << 22) as f64;

/// A closed rectangle of the world; sides may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
}

/// A quadtree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tree {
    levels: u32,
    min: [f32; 2],
    max: [f32; 2],
    /// How much wider than they are the cells are taken.
    slack: f64,
}

impl Tree {
    /// The tree of a root in the world, with so many levels below it.
    pub(crate) fn new(levels: u32, min: [f32; 2], max: [f32; 2]) -> Result<Tree> {
        let is_root = |axis: usize| min[axis] < max[axis] && (max[axis] - min[axis]).is_finite();
        if levels > LEVELS_MAX || !(0..2).all(is_root) {
            return Err(Error::malformed(format!("a quadtree of {levels} levels from {min:?} to {max:?}")));
        }
        let greatest = min.iter().chain(&max).fold(0.0, |greatest: f32, side| greatest.max(side.abs()));
        Ok(Tree { levels, min, max, slack: f64::from(greatest) * ROUNDING })
    }

    /// The root.
    pub(crate) fn root(&self) -> Rectangle {
        self.widened(self.min, self.max)
    }

    /// The cell with a number, which counts the cells of higher levels before it; `None` if there is no such
    /// cell. Cells at the border of the root have no end there: writers put points outside of the root into them.
    pub(crate) fn cell(&self, number: i32) -> Option<Rectangle> {
        let mut place = u32::try_from(number).ok()?;
        let mut level = 0;
        while place >= 1 << (2 * level) {
            place -= 1 << (2 * level);
            level += 1;
            if level > self.levels {
                return None;
            }
        }
        Some(self.cell_at(level, place))
    }

    /// Two bits of `place` per level, from the root on, say which quarter holds the cell: right of the middle, and
    /// above it.
    fn cell_at(&self, level: u32, place: u32) -> Rectangle {
        let (mut min, mut max) = (self.min, self.max);
        for below in (0..level).rev() {
            let quarter = place >> (2 * below);
            for axis in 0..2 {
                let middle = f32::midpoint(min[axis], max[axis]);
                let side = if quarter >> axis & 1 == 1 { &mut min } else { &mut max };
                side[axis] = middle;
            }
        }
        let mut cell = self.widened(min, max);
        for axis in 0..2 {
            if min[axis] == self.min[axis] {
                cell.min[axis] = f64::NEG_INFINITY;
            }
            if max[axis] == self.max[axis] {
                cell.max[axis] = f64::INFINITY;
            }
        }
        cell
    }

    fn widened(&self, min: [f32; 2], max: [f32; 2]) -> Rectangle {
        Rectangle {
            min: min.map(|side| f64::from(side) - self.slack),
            max: max.map(|side| f64::from(side) + self.slack),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INFINITE: f64 = f64::INFINITY;

    #[test]
    fn numbers_lead_to_cells() {
        let tree = Tree::new(2, [0.0, 1024.0], [4.0, 1028.0]).unwrap();
        let slack = 1028.0 * ROUNDING;
        let cell = |number| {
            let Rectangle { min, max } = tree.cell(number)?;
            Some(([min[0] + slack, min[1] + slack], [max[0] - slack, max[1] - slack]))
        };
        let everything = ([-INFINITE; 2], [INFINITE; 2]);
        assert_eq!(cell(0), Some(everything));
        assert_eq!(cell(1), Some(([-INFINITE; 2], [2.0, 1026.0])));
        assert_eq!(cell(2), Some(([2.0, -INFINITE], [INFINITE, 1026.0])));
        assert_eq!(cell(3), Some(([-INFINITE, 1026.0], [2.0, INFINITE])));
        // The upper right quarter of the lower left one, and the lower left of the upper right one.
        assert_eq!(cell(5 + 3), Some(([1.0, 1025.0], [2.0, 1026.0])));
        assert_eq!(cell(5 + 12), Some(([2.0, 1026.0], [3.0, 1027.0])));
        assert_eq!(cell(5 + 15), Some(([3.0, 1027.0], [INFINITE; 2])));
        assert_eq!(cell(5 + 16), None);
        assert_eq!(cell(-1), None);
    }

    #[test]
    fn a_tree_needs_a_root_and_few_levels() {
        let deepest = Tree::new(15, [0.0; 2], [1.0; 2]).unwrap();
        assert!(deepest.cell(i32::MAX).is_none());
        assert_eq!(deepest.cell(1_431_655_764).map(|cell| cell.max), Some([INFINITE; 2]));
        assert!(Tree::new(16, [0.0; 2], [1.0; 2]).is_err());
        assert!(Tree::new(1, [0.0; 2], [1.0, 0.0]).is_err());
        assert!(Tree::new(1, [0.0, f32::NAN], [1.0; 2]).is_err());
        assert!(Tree::new(1, [f32::MIN; 2], [f32::MAX; 2]).is_err());
    }
}
