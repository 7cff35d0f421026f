//! Places and segments by the cells of a grid, in which crowded cells have grids of their own.
//!
//! A grid over a box is as good as what is in it is even: one place far from all others puts these into one
//! cell. So the box of most of the items in a crowded cell has a grid of its own, the rest of the cell has
//! trees for what little is in it, and so on. Where items are even, there is one grid.

mod grid;
mod making;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub use grid::{CellBox, Fineness, Grid, Item, range};
pub use making::box_of_most;
use making::{ENTRIES_ALL, Making};

use crate::cell_lists::CellLists;
use crate::points::Point2;

/// A grid with what is in its cells, and the grids in crowded ones.
///
/// Memory: 4 bytes for each cell, each item in a cell, and again for those of crowded cells.
#[derive(Debug)]
pub struct CellTree {
    /// The grid.
    pub grid: Grid,
    /// Its number among all grids; an outer one is before those in it.
    pub number: usize,
    /// It has all items that meet this box.
    around: CellBox,
    /// Number of items.
    count: usize,
    lists: CellLists,
    /// Where the lists begin among all lists, if all items are places.
    first: usize,
    /// In the order of their cells.
    inner: Vec<(u32, Inner)>,
}

/// What a crowded cell is divided into.
#[derive(Debug)]
pub struct Inner {
    /// What is inside of all cuts.
    bulk: CellTree,
    /// What is beyond a cut and not beyond those before.
    beyond: Vec<(Cut, CellTree)>,
}

/// A side of a box.
#[derive(Debug, Clone, Copy)]
struct Cut {
    axis: usize,
    at: f64,
    is_upper: bool,
}

impl Cut {
    #[inline]
    fn is_beyond(&self, place: Point2) -> bool {
        if self.is_upper { place[self.axis] >= self.at } else { place[self.axis] < self.at }
    }

    /// Both parts of a box: inside and beyond.
    fn parts(&self, bounds: CellBox) -> [CellBox; 2] {
        let (mut inside, mut beyond) = (bounds, bounds);
        if self.is_upper {
            (inside.max[self.axis], beyond.min[self.axis]) = (self.at, self.at);
        } else {
            (inside.min[self.axis], beyond.max[self.axis]) = (self.at, self.at);
        }
        [inside, beyond]
    }
}

impl Inner {
    /// The trees that together have what is in the cell; a place is in one of them.
    #[inline]
    pub fn trees(&self) -> impl Iterator<Item = &CellTree> {
        std::iter::once(&self.bulk).chain(self.beyond.iter().map(|(_, tree)| tree))
    }

    #[inline]
    fn tree(&self, place: Point2) -> &CellTree {
        self.beyond.iter().find(|(cut, _)| cut.is_beyond(place)).map_or(&self.bulk, |(_, tree)| tree)
    }
}

impl CellTree {
    /// The items with numbers below `count`. Lists of cells are in increasing order.
    pub fn new(count: u32, item: impl Fn(u32) -> Item, fineness: &Fineness) -> CellTree {
        let mut bounds = CellBox::of(&[]);
        for number in 0..count {
            match item(number) {
                Item::Place(place) => bounds.extend(place),
                Item::Segment(ends) => ends.iter().for_each(|&end| bounds.extend(end)),
            }
        }
        bounds = bounds.with_margin(fineness.reach);
        if fineness.is_whole {
            bounds = CellBox { min: bounds.min.map(f64::floor), max: bounds.max.map(f64::ceil) };
        }
        let [least, most] = fineness.cells;
        let wanted = (f64::from(count) / fineness.items_per_cell).clamp(least, most);
        let grid = Grid::new(bounds, wanted, fineness.is_whole);
        let most = fineness.entries[0].saturating_mul(count as usize).saturating_add(fineness.entries[1]);
        let mut making = Making { item, fineness, left: 0, grids: 0 };
        let mut tree = making.fill(grid, count, |number| number, most);
        making.left = ENTRIES_ALL * count as usize;
        making.divide(&mut tree, 0);
        tree
    }

    /// The items in a cell.
    #[inline]
    pub fn list(&self, cell: usize) -> &[u32] {
        self.lists.get(cell)
    }

    /// What a cell is divided into.
    #[inline]
    pub fn inner(&self, cell: usize) -> Option<&Inner> {
        if self.inner.is_empty() {
            return None;
        }
        let at = self.inner.binary_search_by_key(&(cell as u32), |&(cell, _)| cell);
        at.ok().map(|at| &self.inner[at].1)
    }

    /// All items, in increasing order.
    pub fn items(&self) -> Vec<u32> {
        if self.number == 0 {
            return (0..self.count as u32).collect();
        }
        let mut items: Vec<u32> = (0..self.grid.count()).flat_map(|cell| self.list(cell)).copied().collect();
        items.sort_unstable();
        items.dedup();
        items
    }

    /// The cells that are divided, in increasing order.
    #[inline]
    pub fn divided(&self) -> &[(u32, Inner)] {
        &self.inner
    }

    /// The tree in the cell of a place that has all that is near it, if this is divided.
    #[inline]
    pub fn inner_at(&self, place: Point2) -> Option<&CellTree> {
        if self.inner.is_empty() || !self.grid.bounds.contains(place) {
            return None;
        }
        self.inner(self.grid.cell(place)).map(|inner| inner.tree(place))
    }

    /// Whether the tree has all items within a distance on both axes of a place.
    #[inline]
    pub fn has_all(&self, place: Point2, distance: f64) -> bool {
        (0..2).all(|axis| {
            place[axis] - distance > self.around.min[axis] && place[axis] + distance < self.around.max[axis]
        })
    }

    /// Calls `visit` with each grid, an outer one before those in it.
    pub fn for_each_grid<'t>(&'t self, visit: &mut impl FnMut(&'t CellTree)) {
        visit(self);
        self.inner.iter().flat_map(|(_, inner)| inner.trees()).for_each(|tree| tree.for_each_grid(visit));
    }

    /// Calls `visit` with each cell without a grid in it, row by row, and its items.
    ///
    /// # Errors
    /// Those of `visit`.
    pub fn for_each_leaf<E>(
        &self,
        visit: &mut impl FnMut(&Grid, usize, &[u32]) -> Result<(), E>,
    ) -> Result<(), E> {
        (0..self.grid.count()).try_for_each(|cell| match self.inner(cell) {
            Some(inner) => inner.trees().try_for_each(|tree| tree.for_each_leaf(visit)),
            None => visit(&self.grid, cell, self.list(cell)),
        })
    }

    /// Where the items of a cell are among those of all cells, row by row, of which each place has one.
    #[inline]
    pub fn positions(&self, cell: usize) -> Range<usize> {
        let Range { start, end } = self.lists.range(cell);
        self.first + start..self.first + end
    }

    /// Appends the items in the order of [`CellTree::positions`], if all are places.
    pub fn append_order(&self, order: &mut Vec<u32>) {
        if self.inner.is_empty() {
            return order.extend_from_slice(self.lists.numbers());
        }
        for cell in 0..self.grid.count() {
            match self.inner(cell) {
                Some(inner) => inner.trees().for_each(|tree| tree.append_order(order)),
                None => order.extend_from_slice(self.list(cell)),
            }
        }
    }

    /// The cell that has a place, and the grid that it is a cell of; `None` if nothing is near.
    #[inline]
    pub fn leaf(&self, place: Point2) -> Option<(&CellTree, usize)> {
        let mut tree = self;
        loop {
            if !tree.grid.bounds.contains(place) {
                return None;
            }
            let cell = tree.grid.cell(place);
            match tree.inner(cell) {
                Some(inner) => tree = inner.tree(place),
                None => return Some((tree, cell)),
            }
        }
    }

    /// Calls `found` with the lists of all cells that have a place within `reach` of a segment.
    pub fn for_each_beside(&self, segment: [Point2; 2], reach: f64, found: &mut dyn FnMut(&[u32])) {
        self.grid.for_each_cell(Item::Segment(segment), reach, &mut |cell| match self.inner(cell) {
            Some(inner) => inner.trees().for_each(|tree| tree.for_each_beside(segment, reach, found)),
            None => found(self.list(cell)),
        });
    }
}
