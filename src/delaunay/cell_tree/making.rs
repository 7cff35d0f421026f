//! Makes grids, and those in crowded cells.

use super::{CellBox, CellTree, Cut, Fineness, Grid, Inner, Item};
use crate::cell_lists::CellLists;

/// Grids in grids that do not part the items, one after the other, at most: many segments that meet in one
/// place are in one cell of any grid.
const TRIES: u32 = 4;

/// A grid parts the items if a cell has at most this part of them.
const SHARE: f64 = 0.9;

/// One of so many items may be beyond each side of the box of most of them...
const BEYOND: usize = 16;

/// ...which is cut out if the whole is so many times longer.
const LONG: f64 = 4.0;

/// Entries of each item of a crowded cell in the grid of its own, at most.
const ENTRIES_INNER: usize = 4;

/// Cells of inner grids, as a multiple of those that the items would have in a first one: they are uneven.
const CELLS_INNER: f64 = 2.0;

/// Entries of all inner grids for each item, at most.
pub(super) const ENTRIES_ALL: usize = 8;

/// What grids are made from, and how many entries and grids there may still be.
pub(super) struct Making<'m, I> {
    pub(super) item: I,
    pub(super) fineness: &'m Fineness,
    pub(super) left: usize,
    pub(super) grids: usize,
}

impl<I: Fn(u32) -> Item> Making<'_, I> {
    /// The grid with `count` items, whose numbers are those of `number`, in as fine cells as entries allow.
    pub(super) fn fill(
        &mut self,
        mut grid: Grid,
        count: u32,
        number: impl Fn(u32) -> u32,
        most: usize,
    ) -> CellTree {
        loop {
            let lists = CellLists::of(grid.count(), count, most, |at, visit| {
                grid.for_each_cell((self.item)(number(at)), self.fineness.reach, visit);
            });
            // One cell has each item once.
            if let Some(lists) = lists.or_else(|| (grid.count() == 1).then(|| CellLists::whole(count))) {
                let (number, count) = (self.grids, count as usize);
                self.grids += 1;
                let around = CellBox { min: [f64::NEG_INFINITY; 2], max: [f64::INFINITY; 2] };
                return CellTree { grid, number, around, count, lists, first: 0, inner: Vec::new() };
            }
            grid = Grid::with_side(grid.bounds, 2.0 * grid.side);
        }
    }

    /// Divides crowded cells. `tries` is the number of grids around that did not part the items.
    pub(super) fn divide(&mut self, tree: &mut CellTree, tries: u32) {
        for cell in 0..tree.grid.count() {
            let items = tree.list(cell);
            if items.len() <= self.fineness.crowd {
                continue;
            }
            let is_parted = items.len() as f64 <= SHARE * tree.count as f64;
            let tries = if is_parted { 0 } else { tries + 1 };
            if tries <= TRIES
                && let Some(mut inner) = self.inner(tree.grid.cell_around(cell, self.fineness), items, tries)
            {
                inner.shift(tree.positions(cell).start);
                tree.inner.push((cell as u32, inner));
            }
        }
    }

    /// Divides some items in a box; `None` if that does not pay.
    fn inner(&mut self, around: CellBox, items: &[u32], tries: u32) -> Option<Inner> {
        let cost = ENTRIES_INNER * items.len();
        if cost > self.left {
            return None;
        }
        let met: Vec<CellBox> = items.iter().filter_map(|&item| self.met(item, &around)).collect();
        let (mut rest, mut around, mut beyond) = (items.to_vec(), around, Vec::new());
        for cut in cuts(&met, self.fineness.is_whole) {
            let [inside, outside] = cut.parts(around);
            let is_in = |item: u32, part: &CellBox, is_beyond: bool| match (self.item)(item) {
                Item::Place(place) => cut.is_beyond(place) == is_beyond,
                Item::Segment(_) => self.met(item, part).is_some(),
            };
            let others: Vec<u32> = rest.iter().copied().filter(|&item| is_in(item, &outside, true)).collect();
            rest.retain(|&item| is_in(item, &inside, false));
            beyond.push((cut, outside, others));
            around = inside;
        }
        let bulk = self.tree(around, &rest, tries)?;
        if bulk.grid.count() == 1 && beyond.is_empty() {
            return None;
        }
        let beyond = beyond.into_iter().map(|(cut, outside, others)| {
            let tree = self.tree(outside, &others, tries)?;
            Some((cut, tree))
        });
        Some(Inner { bulk, beyond: beyond.collect::<Option<_>>()? })
    }

    /// The tree of some items over the box of their parts in a box.
    fn tree(&mut self, around: CellBox, items: &[u32], tries: u32) -> Option<CellTree> {
        let mut bounds = CellBox::around(items.iter().filter_map(|&item| self.met(item, &around)));
        if self.fineness.is_whole {
            bounds =
                CellBox { min: bounds.min.map(f64::floor), max: bounds.max.map(f64::ceil) }.within(&around);
        }
        let wanted = CELLS_INNER * items.len() as f64 / self.fineness.items_per_cell.max(1.0);
        let most = ENTRIES_INNER * items.len();
        let grid =
            Grid::new(bounds, wanted.clamp(1.0, self.fineness.cells[1].max(1.0)), self.fineness.is_whole);
        let mut tree = self.fill(grid, items.len() as u32, |at| items[at as usize], most);
        tree.lists.renumber(|at| items[at as usize]);
        tree.around = around;
        self.left = self.left.checked_sub(tree.lists.entries())?;
        if tree.grid.count() > 1 {
            self.divide(&mut tree, tries);
        }
        Some(tree)
    }

    fn met(&self, item: u32, around: &CellBox) -> Option<CellBox> {
        around.met_by((self.item)(item), self.fineness.reach)
    }
}

/// The box of most of some boxes: without what leads far beyond it.
pub fn box_of_most(boxes: &[CellBox]) -> CellBox {
    let all = CellBox::around(boxes.iter().copied());
    if boxes.is_empty() {
        return all;
    }
    cuts(boxes, false).into_iter().fold(all, |most, cut| cut.parts(most)[0])
}

/// The sides of the box of most of some boxes, where others lead far beyond.
fn cuts(boxes: &[CellBox], is_whole: bool) -> Vec<Cut> {
    let count = boxes.len();
    let mut range = [[0.0; 2]; 2];
    for (axis, [low, high]) in range.iter_mut().enumerate() {
        let mut middles: Vec<f64> = boxes.iter().map(|b| b.min[axis].midpoint(b.max[axis])).collect();
        *low = *middles.select_nth_unstable_by(count / BEYOND, f64::total_cmp).1;
        *high = *middles.select_nth_unstable_by(count - 1 - count / BEYOND, f64::total_cmp).1;
    }
    let length = (range[0][1] - range[0][0]).max(range[1][1] - range[1][0]);
    let mut cuts = Vec::new();
    for (axis, [low, high]) in range.into_iter().enumerate() {
        let least = boxes.iter().fold(f64::INFINITY, |least, b| least.min(b.min[axis]));
        let most = boxes.iter().fold(f64::NEG_INFINITY, |most, b| most.max(b.max[axis]));
        for (at, is_far, is_upper) in [
            (low - length, low - least > LONG * length, false),
            (high + length, most - high > LONG * length, true),
        ] {
            let at = match (is_whole, is_upper) {
                (true, true) => at.ceil(),
                (true, false) => at.floor(),
                _ => at,
            };
            // A length of zero is no length; infinite ones cannot be told.
            if is_far && length > 0.0 && at.is_finite() && least < at && at < most {
                cuts.push(Cut { axis, at, is_upper });
            }
        }
    }
    cuts
}

impl Inner {
    fn trees_mut(&mut self) -> impl Iterator<Item = &mut CellTree> {
        std::iter::once(&mut self.bulk).chain(self.beyond.iter_mut().map(|(_, tree)| tree))
    }

    /// Counts the places of all lists from `first` on.
    fn shift(&mut self, first: usize) {
        let mut first = first;
        for tree in self.trees_mut() {
            tree.shift(first);
            first += tree.count;
        }
    }
}

impl CellTree {
    fn shift(&mut self, by: usize) {
        self.first += by;
        self.inner.iter_mut().flat_map(|(_, inner)| inner.trees_mut()).for_each(|tree| tree.shift(by));
    }
}
