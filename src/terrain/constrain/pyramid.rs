//! Bits for the squares of a grid, and a pyramid of them: each level says which squares of the level below
//! hold something.

use spmesh_delaunay::cell_tree::CellBox;

/// Squares in columns and rows; each row starts with a new word.
#[derive(Debug, Default)]
pub(super) struct Bits {
    words: Vec<u64>,
    /// Words in a row.
    stride: usize,
}

impl Bits {
    /// A grid without any bit.
    pub(super) fn new([columns, rows]: [usize; 2]) -> Bits {
        let stride = columns.div_ceil(64);
        Bits { words: vec![0; stride * rows], stride }
    }

    pub(super) fn set(&mut self, [column, row]: [usize; 2]) {
        self.words[row * self.stride + column / 64] |= 1 << (column % 64);
    }

    pub(super) fn clear(&mut self, [column, row]: [usize; 2]) {
        self.words[row * self.stride + column / 64] &= !(1 << (column % 64));
    }

    pub(super) fn get(&self, [column, row]: [usize; 2]) -> bool {
        self.words[row * self.stride + column / 64] >> (column % 64) & 1 == 1
    }

    /// Whether a bit is set in a range of columns and rows, ends included.
    #[inline]
    pub(super) fn any(&self, [[left, right], [bottom, top]]: [[usize; 2]; 2]) -> bool {
        let [first, last] = [left / 64, right / 64];
        let (from, to) = (u64::MAX << (left % 64), u64::MAX >> (63 - right % 64));
        (bottom..=top).any(|row| {
            let words = &self.words[row * self.stride + first..=row * self.stride + last];
            match words {
                [word] => word & from & to != 0,
                [start, between @ .., end] => {
                    start & from != 0 || end & to != 0 || between.iter().any(|&word| word != 0)
                }
                [] => false,
            }
        })
    }
}

/// Levels of bits, the finest first. A square of a level is two by two of the one below.
#[derive(Debug, Default)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    size: [usize; 2],
    bits: Bits,
}

impl Level {
    fn new(size: [usize; 2], is_occupied: impl Fn([usize; 2]) -> bool) -> Level {
        let mut bits = Bits::new(size);
        squares(size).filter(|&square| is_occupied(square)).for_each(|square| bits.set(square));
        Level { size, bits }
    }
}

/// The squares of a grid, row by row.
fn squares([columns, rows]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]))
}

impl Pyramid {
    /// The pyramid over a grid of columns and rows.
    pub(super) fn new(size: [usize; 2], is_occupied: impl Fn(usize) -> bool) -> Pyramid {
        let columns = size[0];
        let mut levels = vec![Level::new(size, |[column, row]| is_occupied(row * columns + column))];
        while let Some(last) = levels.last()
            && last.size != [1, 1]
        {
            let size = last.size.map(|count| count.div_ceil(2));
            let level = Level::new(size, |[column, row]| {
                let below = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| [2 * column + x, 2 * row + y]);
                below.iter().any(|at| (0..2).all(|axis| at[axis] < last.size[axis]) && last.bits.get(*at))
            });
            levels.push(level);
        }
        Pyramid { levels }
    }

    /// The occupied cells and those beside them.
    pub(super) fn finest_spread(&self) -> Bits {
        let Level { size, bits } = &self.levels[0];
        let around = |at: usize, axis: usize| at.saturating_sub(1)..=(at + 1).min(size[axis] - 1);
        let mut spread = Bits::new(*size);
        for [column, row] in squares(*size).filter(|&square| bits.get(square)) {
            around(row, 1).for_each(|row| around(column, 0).for_each(|column| spread.set([column, row])));
        }
        spread
    }

    /// Calls `found` with the numbers of occupied cells in a range of columns and rows that `meets` accepts.
    pub(super) fn for_each_in(
        &self,
        range: [[usize; 2]; 2],
        meets: impl Fn(&CellBox) -> bool,
        mut found: impl FnMut(usize),
    ) {
        // The coarsest level where the range has few squares.
        let widest = (range[0][1] - range[0][0]).max(range[1][1] - range[1][0]);
        let start = ((widest + 1).ilog2() as usize).min(self.levels.len() - 1);
        let [columns, rows] = range.map(|[first, last]| (first >> start)..=(last >> start));
        for row in rows {
            for column in columns.clone() {
                self.descend(start, [column, row], range, &meets, &mut found);
            }
        }
    }

    fn descend(
        &self,
        level: usize,
        at: [usize; 2],
        range: [[usize; 2]; 2],
        meets: &impl Fn(&CellBox) -> bool,
        found: &mut impl FnMut(usize),
    ) {
        let size = self.levels[level].size;
        let is_in = |axis: usize| {
            let [first, last] = range[axis];
            at[axis] < size[axis] && at[axis] << level <= last && (at[axis] + 1) << level > first
        };
        if !is_in(0) || !is_in(1) || !self.levels[level].bits.get(at) {
            return;
        }
        let side = (1usize << level) as f64;
        let min = at.map(|x| x as f64 * side);
        if !meets(&CellBox { min, max: min.map(|x| x + side) }) {
            return;
        }
        if level == 0 {
            found(at[1] * size[0] + at[0]);
            return;
        }
        for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            self.descend(level - 1, [2 * at[0] + x, 2 * at[1] + y], range, meets, found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_the_bits_that_are_set() {
        let mut bits = Bits::new([200, 3]);
        for column in [0, 63, 64, 130, 199] {
            bits.set([column, 1]);
        }
        for left in 0..200 {
            for right in left..200 {
                let expected = [0, 63, 64, 130, 199].iter().any(|column| (left..=right).contains(column));
                assert_eq!(bits.any([[left, right], [0, 2]]), expected, "{left} to {right}");
                assert!(!bits.any([[left, right], [2, 2]]));
            }
        }
        bits.clear([64, 1]);
        assert!(!bits.get([64, 1]) && bits.get([63, 1]));
    }
}
