//! Places and segments by the cells of a grid, in which crowded cells have grids of their own.
//!
//! A grid over a box is as good as what is in it is even: one place far from all others puts these into one cell. So
//! the box of most of the items in a crowded cell has a grid of its own, the rest of the cell has trees for what little
//! is in it, and so on. Where items are even, there is one grid.

use std::ops::Range;

use crate::cell_lists::CellLists;
use crate::cell_walk::{TOLERANCE, for_each_cell_within};
use crate::points::Point2;

/// Grids in grids that do not part the items, one after the other, at most: many segments that meet in one place are
/// in one cell of any grid.
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
const ENTRIES_ALL: usize = 8;

/// More than the roundings of a few operations, as a part of the numbers in them.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// What is in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Item {
    /// It is in one cell.
    Place(Point2),
    /// It is in all cells that it meets, and perhaps in others beside it.
    Segment([Point2; 2]),
}

/// How fine grids are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Items per cell, on average over all cells.
    pub items_per_cell: f64,
    /// The least and the greatest number of cells of the first grid, about.
    pub cells: [f64; 2],
    /// Entries of the first grid for each item, and beside these, at most: with more, cells are larger.
    pub entries: [usize; 2],
    /// Cells with more items have a grid of their own, if that helps.
    pub crowd: usize,
    /// Segments are also in the cells of all places within this distance on both axes.
    pub reach: f64,
    /// Whether the sides of cells are whole numbers.
    pub is_whole: bool,
}

/// A closed box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellBox {
    /// Least coordinates.
    pub min: Point2,
    /// Greatest coordinates.
    pub max: Point2,
}

/// Square cells over a box.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// What the cells are over. The last ones may reach beyond it.
    pub bounds: CellBox,
    /// The side of a cell.
    pub side: f64,
    /// Cells per unit.
    pub scale: f64,
    /// Columns and rows.
    pub size: [usize; 2],
}

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
    pub fn trees(&self) -> impl Iterator<Item = &CellTree> {
        std::iter::once(&self.bulk).chain(self.beyond.iter().map(|(_, tree)| tree))
    }

    #[inline]
    fn tree(&self, place: Point2) -> &CellTree {
        self.beyond.iter().find(|(cut, _)| cut.is_beyond(place)).map_or(&self.bulk, |(_, tree)| tree)
    }
}

impl CellBox {
    /// The least box around some places; none has infinite bounds.
    pub fn of(places: &[Point2]) -> CellBox {
        let mut bounds = CellBox { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        places.iter().for_each(|&place| bounds.extend(place));
        bounds
    }

    /// Makes the box contain a place.
    #[inline]
    pub fn extend(&mut self, place: Point2) {
        let [[left, bottom], [right, top]] = [self.min, self.max];
        self.min = [left.min(place[0]), bottom.min(place[1])];
        self.max = [right.max(place[0]), top.max(place[1])];
    }

    /// Whether a place is inside or on the border.
    #[inline]
    pub fn contains(&self, place: Point2) -> bool {
        (0..2).all(|axis| self.min[axis] <= place[axis] && place[axis] <= self.max[axis])
    }

    fn with_margin(&self, margin: f64) -> CellBox {
        CellBox { min: self.min.map(|x| x - margin), max: self.max.map(|x| x + margin) }
    }

    /// What both have in common, perhaps nothing: then a bound is beyond the other.
    pub fn within(&self, other: &CellBox) -> CellBox {
        CellBox {
            min: [0, 1].map(|axis| self.min[axis].max(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].min(other.max[axis])),
        }
    }

    fn longer_side(&self) -> f64 {
        (self.max[0] - self.min[0]).max(self.max[1] - self.min[1])
    }

    /// The part of a segment in the box, and how far rounding moves it on both axes; `None` if there is none.
    fn part(&self, [a, b]: [Point2; 2]) -> Option<([Point2; 2], f64)> {
        if (0..2).any(|axis| a[axis].max(b[axis]) < self.min[axis] || a[axis].min(b[axis]) > self.max[axis]) {
            return None;
        }
        if self.contains(a) && self.contains(b) {
            return Some(([a, b], 0.0));
        }
        // From the nearer end, which makes for the least roundings.
        let beyond = |end: Point2| {
            let [x, y] = [0, 1].map(|axis| (self.min[axis] - end[axis]).max(end[axis] - self.max[axis]));
            x.max(y)
        };
        let [a, b] = if beyond(a) <= beyond(b) { [a, b] } else { [b, a] };
        let along = [0, 1].map(|axis| b[axis] - a[axis]);
        let most = a.iter().chain(&self.min).chain(&self.max).fold(0.0f64, |most, x| most.max(x.abs()));
        let slack = ROUNDINGS * most;
        let mut range = [0.0f64, 1.0];
        for axis in 0..2 {
            if along[axis] != 0.0 {
                let ends = [self.min[axis] - slack - a[axis], self.max[axis] + slack - a[axis]];
                let [p, q] = ends.map(|end| end / along[axis]);
                range = [range[0].max(p.min(q)), range[1].min(p.max(q))];
            }
        }
        let at = |part: f64| [0, 1].map(|axis| a[axis] + part * along[axis]);
        let (part, is_met) = (range.map(at), range[0] <= range[1] * (1.0 + ROUNDINGS) + f64::MIN_POSITIVE);
        match part.iter().flatten().all(|x| x.is_finite()) {
            true => is_met.then_some((part, slack)),
            // Beyond the numbers of f64: it may be anywhere.
            false => Some(([self.min, self.max], f64::INFINITY)),
        }
    }

    /// The box of the part of an item that is in this one, or within `reach` of it.
    pub fn met_by(&self, item: Item, reach: f64) -> Option<CellBox> {
        match item {
            Item::Place(place) => self.contains(place).then_some(CellBox { min: place, max: place }),
            Item::Segment(ends) => {
                let around = self.with_margin(reach);
                let (part, slack) = around.part(ends)?;
                let met = CellBox::of(&part).with_margin(reach + slack).within(self);
                (met.min[0] <= met.max[0] && met.min[1] <= met.max[1]).then_some(met)
            }
        }
    }
}

impl Grid {
    /// About so many cells over a box.
    pub fn new(bounds: CellBox, wanted: f64, is_whole: bool) -> Grid {
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        // A long thin box has few cells across, and at most as many along as it may have in all.
        let side = (width.sqrt() * height.sqrt() / wanted.sqrt()).max(width.max(height) / wanted);
        let side = if is_whole { side.ceil() } else { side };
        Grid::with_side(bounds, if side > 0.0 { side } else { 1.0 })
    }

    /// Cells of this side over a box.
    pub fn with_side(bounds: CellBox, side: f64) -> Grid {
        // Conversions saturate, and what is not a number becomes zero.
        let size = [0, 1].map(|axis| ((bounds.max[axis] - bounds.min[axis]) / side) as usize + 1);
        let scale = 1.0 / side;
        let (scale, size) = if scale.is_finite() { (scale, size) } else { (0.0, [1; 2]) };
        Grid { bounds, side, scale, size }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Whether there are no cells: never.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// A place in units of cells.
    #[inline]
    pub fn local(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (place[axis] - self.bounds.min[axis]) * self.scale)
    }

    /// The cell of a place; for places outside, one at the border.
    #[inline]
    pub fn cell(&self, place: Point2) -> usize {
        let [column, row] = self.local(place).map(|x| x as usize);
        row.min(self.size[1] - 1) * self.size[0] + column.min(self.size[0] - 1)
    }

    /// A cell as a box of coordinates, up to roundings. It may reach beyond the bounds.
    pub fn cell_box(&self, cell: usize) -> CellBox {
        let at = [cell % self.size[0], cell / self.size[0]];
        let corner =
            |step: usize| [0, 1].map(|axis| self.bounds.min[axis] + (at[axis] + step) as f64 * self.side);
        CellBox { min: corner(0), max: corner(1) }
    }

    /// What the bounds leave of a cell, with what rounding moves beyond it.
    fn cell_around(&self, cell: usize, fineness: &Fineness) -> CellBox {
        let margin = TOLERANCE * self.side + ROUNDINGS * self.bounds.longer_side();
        self.cell_box(cell).within(&self.bounds).with_margin(if fineness.is_whole { 0.0 } else { margin })
    }

    /// The columns and rows that a box meets, in units of cells; `None` if it is outside.
    #[inline]
    pub fn range(&self, local: &CellBox) -> Option<[[usize; 2]; 2]> {
        range(local, self.size)
    }

    /// Cells of a fraction of the side.
    pub fn finer(&self, by: usize) -> Grid {
        let part = by as f64;
        Grid {
            side: self.side / part,
            scale: self.scale * part,
            size: self.size.map(|count| count * by),
            ..*self
        }
    }

    /// Calls `found` with the cells that an item is in: for a segment, also those of all places within `reach` of it.
    pub fn for_each_cell(&self, item: Item, reach: f64, found: &mut dyn FnMut(usize)) {
        match item {
            Item::Place(place) => found(self.cell(place)),
            Item::Segment(ends) => {
                let Some((part, slack)) = self.bounds.with_margin(reach).part(ends) else { return };
                let reach = (reach + slack) * self.scale + TOLERANCE;
                let part = part.map(|end| self.local(end));
                for_each_cell_within(part, self.size, reach, |[column, row]| {
                    found(row * self.size[0] + column)
                });
            }
        }
    }
}

/// The columns and rows of a grid of this size that a box meets; `None` if it is outside.
#[inline]
pub fn range(local: &CellBox, size: [usize; 2]) -> Option<[[usize; 2]; 2]> {
    let mut ranges = [[0; 2]; 2];
    for axis in 0..2 {
        let [low, high] = [local.min[axis] - TOLERANCE, local.max[axis] + TOLERANCE];
        if high < 0.0 || low > size[axis] as f64 {
            return None;
        }
        // Conversions saturate: what is below zero or not a number becomes zero.
        ranges[axis] = [low as usize, high as usize].map(|cell| cell.min(size[axis] - 1));
    }
    Some(ranges)
}

/// What grids are made from, and how many entries and grids there may still be.
struct Making<'m, I> {
    item: I,
    fineness: &'m Fineness,
    left: usize,
    grids: usize,
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
        let mut items: Vec<u32> = (0..self.grid.len()).flat_map(|cell| self.list(cell)).copied().collect();
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
        (0..self.grid.len()).try_for_each(|cell| match self.inner(cell) {
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
        for cell in 0..self.grid.len() {
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

impl<I: Fn(u32) -> Item> Making<'_, I> {
    /// The grid with `count` items, whose numbers are those of `number`, in as fine cells as entries allow.
    fn fill(&mut self, mut grid: Grid, count: u32, number: impl Fn(u32) -> u32, most: usize) -> CellTree {
        loop {
            let lists = CellLists::of(grid.len(), count, most, |at, visit| {
                grid.for_each_cell((self.item)(number(at)), self.fineness.reach, visit);
            });
            // One cell has each item once.
            if let Some(lists) = lists.or_else(|| (grid.len() == 1).then(|| CellLists::whole(count))) {
                let (number, count) = (self.grids, count as usize);
                self.grids += 1;
                let around = CellBox { min: [f64::NEG_INFINITY; 2], max: [f64::INFINITY; 2] };
                return CellTree { grid, number, around, count, lists, first: 0, inner: Vec::new() };
            }
            grid = Grid::with_side(grid.bounds, 2.0 * grid.side);
        }
    }

    /// Divides crowded cells. `tries` is the number of grids around that did not part the items.
    fn divide(&mut self, tree: &mut CellTree, tries: u32) {
        for cell in 0..tree.grid.len() {
            let items = tree.list(cell);
            if items.len() <= self.fineness.crowd {
                continue;
            }
            let is_parted = items.len() as f64 <= SHARE * tree.count as f64;
            let tries = if is_parted { 0 } else { tries + 1 };
            if tries <= TRIES
                && let Some(inner) = self.inner(tree.grid.cell_around(cell, self.fineness), items, tries)
            {
                let mut inner = inner;
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
        if bulk.grid.len() == 1 && beyond.is_empty() {
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
        let met = items.iter().filter_map(|&item| self.met(item, &around));
        let mut bounds = met.fold(CellBox::of(&[]), |mut all, met| {
            all.extend(met.min);
            all.extend(met.max);
            all
        });
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
        if tree.grid.len() > 1 {
            self.divide(&mut tree, tries);
        }
        Some(tree)
    }

    fn met(&self, item: u32, around: &CellBox) -> Option<CellBox> {
        around.met_by((self.item)(item), self.fineness.reach)
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const FINENESS: Fineness = Fineness {
        items_per_cell: 1.0,
        cells: [16.0, 1e7],
        entries: [32, 1 << 10],
        crowd: 8,
        reach: 0.0,
        is_whole: false,
    };

    fn unit(random: &mut Random) -> f64 {
        random.below(1 << 20) as f64 / f64::from(1 << 20)
    }

    /// Short segments, and their first ends.
    fn scattered(count: usize) -> Vec<Item> {
        let mut random = Random::new(7);
        let mut items = Vec::new();
        for _ in 0..count / 2 {
            let [x, y] = [unit(&mut random), unit(&mut random)];
            let length = 1.0 / (count as f64).sqrt();
            let end = [x + length * (unit(&mut random) - 0.5), y + length * (unit(&mut random) - 0.5)];
            items.extend([Item::Place([x, y]), Item::Segment([[x, y], end])]);
        }
        items
    }

    fn tree_of(items: &[Item], fineness: &Fineness) -> CellTree {
        CellTree::new(items.len() as u32, |number| items[number as usize], fineness)
    }

    fn middle(item: &Item) -> Point2 {
        match *item {
            Item::Place(place) => place,
            Item::Segment([a, b]) => [0, 1].map(|axis| a[axis].midpoint(b[axis])),
        }
    }

    /// Entries of all grids, and the items that searches at some items look at.
    fn work(items: &[Item], searched: &[Item]) -> usize {
        let tree = tree_of(items, &FINENESS);
        let (mut cells, mut work) = (0, 0);
        tree.for_each_grid(&mut |tree| {
            (cells, work) = (cells + tree.grid.len(), work + tree.lists.entries())
        });
        assert!(cells < 8 * items.len() + 100, "{cells} cells for {} items", items.len());
        let list = |item| tree.leaf(middle(item)).map_or(0, |(tree, cell)| tree.list(cell).len());
        work + searched.iter().map(list).sum::<usize>()
    }

    fn corners(distance: f64) -> [Point2; 4] {
        [[distance, 0.5], [-distance, distance], [distance, distance], [0.3, -distance]]
    }

    #[test]
    fn an_outlier_at_most_doubles_the_work() {
        let items = scattered(5_000);
        let ordinary = work(&items, &items);
        for distance in [2.0, 1e3, 1e5, 1e9, 1e12, 1e300] {
            for corner in corners(distance) {
                let with =
                    |more: &[Item]| work(&[&items[..], more].concat(), &items) as f64 / ordinary as f64;
                let from = [0.5, 0.5];
                let ratios = [
                    with(&[Item::Place(corner)]),
                    with(&[Item::Segment([from, corner])]),
                    with(&corners(distance).map(Item::Place)),
                    with(&corners(distance).map(|end| Item::Segment([corner, end]))),
                ];
                assert!(ratios.iter().all(|&ratio| ratio < 2.0), "{corner:?}: {ratios:?}");
            }
        }
    }

    #[test]
    fn the_work_grows_as_the_items() {
        let scaled = |by: f64, count: usize| {
            let scale = |end: Point2| [by * end[0], by * end[1]];
            let one = |item: &Item| match *item {
                Item::Place(place) => Item::Place(scale(place)),
                Item::Segment(ends) => Item::Segment(ends.map(scale)),
            };
            scattered(count).iter().map(one).collect::<Vec<_>>()
        };
        let line = |count: usize| -> Vec<Item> {
            (0..count).map(|i| i as f64 / count as f64).map(|x| Item::Place([x, 0.7 * x])).collect()
        };
        let star = |count: usize| -> Vec<Item> {
            (0..count).map(|i| i as f64).map(|a| Item::Segment([[0.0; 2], [a.cos(), a.sin()]])).collect()
        };
        let clusters = |count: usize| -> Vec<Item> {
            (0..7).flat_map(|power| scaled(10f64.powi(-2 * power), count / 7)).collect()
        };
        for (name, of) in [
            ("scattered", &scattered as &dyn Fn(usize) -> Vec<Item>),
            ("line", &line),
            ("clusters", &clusters),
            ("one place", &|count| vec![Item::Place([1.0, 2.0]); count]),
        ] {
            let work =
                |count| work(&of(count), &of(count)[..if name == "one place" { 1 } else { count / 8 * 7 }]);
            let ratio = work(16_000) as f64 / work(8_000) as f64;
            assert!(ratio < 2.3, "{name}: {ratio}");
        }
        // Nothing parts segments that meet in one place, but their lists are limited.
        let ratio = work(&star(64_000), &[]) as f64 / work(&star(32_000), &[]) as f64;
        assert!(ratio < 2.5, "star: {ratio}");
    }

    /// What meets a box is in the lists of the cells that meet it; a place is in the list of its cell.
    #[test]
    fn no_item_is_lost() {
        let mut random = Random::new(11);
        for case in 0..60 {
            let mut items = scattered(200);
            let distance = 10f64.powi(random.below(18) as i32);
            let far: Vec<Point2> =
                (0..random.below(5)).map(|at| corners(distance)[at as usize % 4]).collect();
            for &corner in &far {
                items.push(Item::Place(corner));
                items.push(Item::Segment([[unit(&mut random), unit(&mut random)], corner]));
                items.push(Item::Segment([far[0], corner]));
            }
            let fineness = Fineness { crowd: 1 + case % 5, reach: [0.0, 0.01][case % 2], ..FINENESS };
            let tree = tree_of(&items, &fineness);
            for (number, item) in (0..).zip(&items) {
                let lists = match *item {
                    Item::Place(place) => vec![place],
                    Item::Segment([a, b]) => (0..20)
                        .map(|part| f64::from(part) / 20.0)
                        .map(|part| [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis])))
                        .collect(),
                };
                for place in lists {
                    let found =
                        tree.leaf(place).is_some_and(|(tree, cell)| tree.list(cell).contains(&number));
                    // Rounding moves places on long segments.
                    assert!(found || place[0].abs().max(place[1].abs()) > 10.0, "{item:?} at {place:?}");
                }
            }
            let places: Vec<Item> = items.iter().copied().filter(|i| matches!(i, Item::Place(_))).collect();
            let tree = tree_of(&places, &fineness);
            let mut positions = Vec::new();
            let Ok::<(), ()>(()) = tree.for_each_leaf(&mut |_, _, list| {
                positions.extend_from_slice(list);
                Ok(())
            }) else {
                unreachable!()
            };
            for (number, place) in (0..).zip(&places) {
                let (tree, cell) = tree.leaf(middle(place)).expect("a place is in the box");
                assert!(positions[tree.positions(cell)].contains(&number), "{place:?}");
            }
        }
    }
}
