//! Counters per cell, only where there are points.

use std::collections::HashMap;

use foldhash::fast::FixedState;

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::cells::{CellCode, CellTree};

/// Counters of a page: three levels of a quadtree, two of an octree.
const PAGE_CELLS: usize = 64;
const PAGE_BITS: u32 = PAGE_CELLS.trailing_zeros();

/// Bytes of a page with its entry in the index, which doubles when it grows.
const PAGE_COST: u64 = (PAGE_CELLS * 8 + 64) as u64;

/// Counts points per cell of one level of a tree.
///
/// Pages of counters exist only where points are, so that a cluster in a huge extent is counted finely. When
/// the pages fill their memory, the grid becomes coarser by a level, unless its level is fixed. The final
/// level is the finest whose pages fit, whatever the order of the points.
///
/// Memory: the bytes given to the constructor.
pub(super) struct Counters {
    tree: CellTree,
    level: u8,
    is_fixed: bool,
    pages_max: usize,
    pages: Vec<[u64; PAGE_CELLS]>,
    /// Page of each key. A key is a location code without its last [`PAGE_BITS`] bits.
    index: HashMap<u64, usize, FixedState>,
    /// Key and page of the last point: the next point is often near.
    last: Option<(u64, usize)>,
}

impl Counters {
    /// Counters that start at `level`, and become coarser to fit in `bytes`.
    pub(super) fn adaptive(tree: CellTree, level: u8, bytes: u64) -> Self {
        // Half of the memory, because the finer grid still exists while it is made coarser.
        Counters::new(tree, level, false, bytes / 2)
    }

    /// Counters of exactly this level.
    pub(super) fn fixed(tree: CellTree, level: u8, bytes: u64) -> Self {
        Counters::new(tree, level, true, bytes)
    }

    fn new(tree: CellTree, level: u8, is_fixed: bool, bytes: u64) -> Self {
        let pages_max = (bytes / PAGE_COST).max(1) as usize;
        Counters {
            tree,
            level,
            is_fixed,
            pages_max,
            pages: Vec::new(),
            index: HashMap::default(),
            last: None,
        }
    }

    /// Current level of the grid.
    pub(super) fn level(&self) -> u8 {
        self.level
    }

    /// Counts points, given by their cells of the deepest level of the tree. Codes of 0 are skipped.
    pub(super) fn add(&mut self, deepest: &[CellCode]) -> Result<()> {
        let mut rest = deepest;
        while let Some((&CellCode(first), later)) = rest.split_first() {
            if first == 0 {
                rest = later;
                continue;
            }
            let shift = u32::from(self.tree.dims() * (self.tree.depth() - self.level));
            let key = first >> shift >> PAGE_BITS;
            let page = match self.last {
                Some((last, page)) if last == key => page,
                _ => self.page(key),
            };
            // Points follow each other on a page.
            let page = &mut self.pages[page];
            let is_on_page = |cell: &&CellCode| cell.0 >> shift >> PAGE_BITS == key && cell.0 > 0;
            let mut counted = 0;
            for cell in rest.iter().take_while(is_on_page) {
                page[(cell.0 >> shift) as usize % PAGE_CELLS] += 1;
                counted += 1;
            }
            rest = &rest[counted..];
            if self.pages.len() > self.pages_max {
                self.coarsen_to_fit()?;
            }
        }
        Ok(())
    }

    fn page(&mut self, key: u64) -> usize {
        let page = *self.index.entry(key).or_insert(self.pages.len());
        if page == self.pages.len() {
            self.pages.push([0; PAGE_CELLS]);
        }
        self.last = Some((key, page));
        page
    }

    /// Makes the grid coarser until it fits.
    fn coarsen_to_fit(&mut self) -> Result<()> {
        if self.is_fixed {
            return Err(Error::new(
                ErrorKind::Memory,
                format!(
                    "the counters of level {} do not fit the memory budget: choose a smaller level or more memory",
                    self.level
                ),
            ));
        }
        while self.level > 0 && self.pages.len() > self.pages_max {
            self.coarsen();
        }
        Ok(())
    }

    /// Makes the grid coarser by a level: each page becomes a part of a page of the level above.
    fn coarsen(&mut self) {
        let mut coarse = Counters::new(self.tree, self.level - 1, false, 0);
        coarse.pages_max = self.pages_max;
        let siblings = 1 << self.tree.dims();
        let part_len = PAGE_CELLS / siblings;
        for (&key, &page) in &self.index {
            let coarse_page = coarse.page(key >> self.tree.dims());
            let part = (key as usize % siblings) * part_len;
            let sums = self.pages[page].chunks_exact(siblings).map(|cells| cells.iter().sum());
            coarse.pages[coarse_page][part..]
                .iter_mut()
                .zip(sums)
                .for_each(|(cell, sum): (_, u64)| *cell = sum);
        }
        *self = coarse;
    }

    /// The counts as prefix sums, for cells of any level down to this one.
    pub(super) fn into_sums(mut self) -> CellSums {
        let mut keys: Vec<(u64, usize)> = self.index.into_iter().collect();
        keys.sort_unstable();
        let mut total = 0;
        for &(_, page) in &keys {
            for counter in &mut self.pages[page] {
                (total, *counter) = (total + *counter, total);
            }
        }
        CellSums { dims: self.tree.dims(), level: self.level, total, keys, pages: self.pages }
    }
}

/// Number of points in every cell down to some level.
pub(super) struct CellSums {
    dims: u8,
    level: u8,
    total: u64,
    /// Key and page, by key.
    keys: Vec<(u64, usize)>,
    /// For every cell, the number of points in the cells before it in the order of location codes.
    pages: Vec<[u64; PAGE_CELLS]>,
}

impl CellSums {
    /// Finest level of the counts.
    pub(super) fn level(&self) -> u8 {
        self.level
    }

    /// Number of points in `cell`, whose level is at most [`CellSums::level`].
    pub(super) fn count(&self, cell: CellCode) -> u64 {
        let cell_level = (63 - cell.0.leading_zeros()) as u8 / self.dims;
        let shift = self.dims * (self.level - cell_level);
        self.before((cell.0 + 1) << shift) - self.before(cell.0 << shift)
    }

    /// Whether a cell of the finest level holds more than `count` points.
    pub(super) fn has_more_than(&self, count: u64) -> bool {
        let counted = self.keys.iter().flat_map(|&(_, page)| self.pages[page].iter().copied());
        let ends = counted.clone().skip(1).chain([self.total]);
        counted.zip(ends).any(|(start, end)| end - start > count)
    }

    /// Number of points in the cells of the finest level before `code`.
    fn before(&self, code: u64) -> u64 {
        let at = self.keys.partition_point(|&(key, _)| key < code >> PAGE_BITS);
        match self.keys.get(at) {
            None => self.total,
            Some(&(key, page)) if key == code >> PAGE_BITS => self.pages[page][code as usize % PAGE_CELLS],
            Some(&(_, page)) => self.pages[page][0],
        }
    }
}

/// Counts per cell of a tree, on finer grids where cells are crowded.
pub(super) struct CellCounts {
    /// Tree of the deepest level that leaves may have.
    pub(super) tree: CellTree,
    /// Grids of counts, each finer than the one before: the first of all points, the others of crowded cells.
    pub(super) sums: Vec<CellSums>,
    /// A cell with more points is crowded.
    pub(super) crowded: u64,
}

impl CellCounts {
    /// Number of points in `cell`, and whether the counts of its children are known. The count of `cell`
    /// itself must be known.
    pub(super) fn count(&self, cell: CellCode) -> (u64, bool) {
        let level = self.tree.level(cell);
        let at = self.sums.partition_point(|sums| sums.level() < level);
        let count = self.sums[at].count(cell);
        let is_finer_known =
            level < self.sums[at].level() || (count > self.crowded && at + 1 < self.sums.len());
        (count, is_finer_known)
    }

    /// The counts of the finest grid.
    pub(super) fn finest(&self) -> &CellSums {
        self.sums.last().expect("a grid has counts")
    }

    /// Sets the codes of cells outside of crowded cells to 0; `deepest` are cells of the deepest level.
    pub(super) fn keep_crowded(&self, deepest: &mut [CellCode]) {
        let shift = self.tree.dims() * (self.tree.depth() - self.finest().level());
        let mut last = (CellCode(0), false);
        for code in deepest {
            let cell = CellCode(code.0 >> shift);
            if cell != last.0 {
                last = (cell, self.finest().count(cell) > self.crowded);
            }
            if !last.1 {
                *code = CellCode(0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_stream::model::bounds::Point;

    fn tree(dims: u8) -> CellTree {
        CellTree::new(dims, 20, [0.0; 3], 1024.0).expect("the tree is exact")
    }

    fn points() -> Vec<Point> {
        (0u32..3000)
            .map(|i| [f64::from(i * 7919 % 1024), f64::from(i * i % 1024), f64::from(i % 1000)])
            .collect()
    }

    fn cells(tree: &CellTree, points: &[Point]) -> Vec<CellCode> {
        points.iter().map(|&point| tree.cell_of(point, tree.depth())).collect()
    }

    #[test]
    fn sums_agree_with_counting_one_by_one_at_every_level() {
        for dims in [2, 3] {
            let tree = tree(dims);
            let mut counters = Counters::fixed(tree, 5, 1 << 24);
            counters.add(&cells(&tree, &points())).expect("fits");
            let sums = counters.into_sums();
            for level in 0..=5 {
                let cells = 1u32 << level;
                let mut total = 0;
                for x in 0..cells {
                    for y in 0..cells {
                        let cell = tree.encode(level, [x, y, 0]);
                        let expected =
                            points().iter().filter(|&&point| tree.cell_of(point, level) == cell).count();
                        assert_eq!(sums.count(cell), expected as u64, "cell {x} {y} of level {level}");
                        total += expected;
                    }
                }
                assert!(dims == 3 || total == 3000);
            }
        }
    }

    #[test]
    fn little_memory_makes_the_grid_coarser_and_loses_nothing() {
        for dims in [2, 3] {
            let mut counters = Counters::adaptive(tree(dims), 20, 20 * PAGE_COST);
            counters.add(&cells(&tree(dims), &points())).expect("adapts");
            assert!(counters.level() < 20 && counters.pages.len() <= 10, "{}", counters.pages.len());
            let sums = counters.into_sums();
            assert_eq!(sums.count(CellCode::ROOT), 3000);
        }
    }

    #[test]
    fn a_fixed_level_that_does_not_fit_is_an_error() {
        let mut counters = Counters::fixed(tree(2), 10, 20 * PAGE_COST);
        let result = counters.add(&cells(&tree(2), &points()));
        assert_eq!(result.expect_err("too many pages").kind(), ErrorKind::Memory);
    }
}
