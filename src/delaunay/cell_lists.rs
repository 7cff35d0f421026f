//! Numbered things by the cells that they are in.

use std::ops::Range;

/// A list of numbers for each of some cells. Memory: 4 bytes for each cell and for each entry.
#[derive(Debug, Default)]
pub struct CellLists {
    /// Where the list of each cell starts; one more at the end.
    starts: Vec<u32>,
    numbers: Vec<u32>,
}

impl CellLists {
    /// Puts numbers below `count` into cells. `cells_of` calls with each cell of a number, and is asked
    /// twice. `None` if there are more than `most` entries, which are fewer than 2^32.
    ///
    /// Each list is in increasing order.
    pub fn of(
        cells: usize,
        count: u32,
        most: usize,
        mut cells_of: impl FnMut(u32, &mut dyn FnMut(usize)),
    ) -> Option<CellLists> {
        let most = most.min(u32::MAX as usize);
        let mut starts = vec![0u32; cells + 1];
        let mut entries = 0;
        for number in 0..count {
            cells_of(number, &mut |cell| {
                entries += 1;
                // Too many are not counted.
                starts[cell] += u32::from(entries <= most);
            });
            if entries > most {
                return None;
            }
        }
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let mut numbers = vec![0; entries];
        // From the last to the first: each list fills up from its end.
        for number in (0..count).rev() {
            cells_of(number, &mut |cell| {
                starts[cell] -= 1;
                numbers[starts[cell] as usize] = number;
            });
        }
        Some(CellLists { starts, numbers })
    }

    /// All numbers below `count` in one cell.
    pub fn whole(count: u32) -> CellLists {
        CellLists { starts: vec![0, count], numbers: (0..count).collect() }
    }

    /// Replaces each number.
    pub fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        self.numbers.iter_mut().for_each(|at| *at = number(*at));
    }

    /// The numbers of all cells, cell by cell.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Number of entries in all cells.
    pub fn entries(&self) -> usize {
        self.numbers.len()
    }

    /// Where the numbers of a cell are among those of all.
    #[inline]
    pub fn range(&self, cell: usize) -> Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// The numbers in a cell.
    #[inline]
    pub fn get(&self, cell: usize) -> &[u32] {
        &self.numbers[self.range(cell)]
    }

    /// The numbers in a cell, whose order may be changed.
    pub fn get_mut(&mut self, cell: usize) -> &mut [u32] {
        let range = self.range(cell);
        &mut self.numbers[range]
    }
}
