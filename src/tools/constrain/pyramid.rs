//! A pyramid of cells: each level says which squares of the level below hold something.

use super::cells::CellBox;

/// Levels of bits, the finest first. A square of a level is two by two of the one below.
#[derive(Debug, Default)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    size: [usize; 2],
    bits: Vec<u64>,
}

impl Level {
    fn new(size: [usize; 2], is_occupied: impl Fn(usize) -> bool) -> Level {
        let count = size[0] * size[1];
        let mut bits = vec![0u64; count.div_ceil(64)];
        (0..count).filter(|&cell| is_occupied(cell)).for_each(|cell| bits[cell / 64] |= 1 << (cell % 64));
        Level { size, bits }
    }

    fn is_occupied(&self, [column, row]: [usize; 2]) -> bool {
        let cell = row * self.size[0] + column;
        self.bits[cell / 64] >> (cell % 64) & 1 == 1
    }
}

impl Pyramid {
    /// The pyramid over a grid of columns and rows.
    pub(super) fn new(size: [usize; 2], is_occupied: impl Fn(usize) -> bool) -> Pyramid {
        let mut levels = vec![Level::new(size, is_occupied)];
        while let Some(last) = levels.last()
            && last.size != [1, 1]
        {
            let size = last.size.map(|count| count.div_ceil(2));
            let level = Level::new(size, |cell| {
                let [column, row] = [cell % size[0], cell / size[0]];
                let below = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| [2 * column + x, 2 * row + y]);
                below.iter().any(|at| (0..2).all(|axis| at[axis] < last.size[axis]) && last.is_occupied(*at))
            });
            levels.push(level);
        }
        Pyramid { levels }
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
        let Level { size, .. } = self.levels[level];
        let is_in = |axis: usize| {
            let [first, last] = range[axis];
            at[axis] < size[axis] && at[axis] << level <= last && (at[axis] + 1) << level > first
        };
        if !is_in(0) || !is_in(1) || !self.levels[level].is_occupied(at) {
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
