//! Square cells over a network of lines, and what lies in them.

use super::pyramid::{Bits, Pyramid};
use spmesh_delaunay::cell_tree::{self, CellBox, CellTree, Fineness, Grid};
use spmesh_delaunay::network::Network;
use spmesh_delaunay::predicates::lexicographic;
use spmesh_stream::model::points::Point2;

/// The greatest number of cells of the first grid.
pub(super) const CELLS_MAX: f64 = 4_194_304.0;

/// One cell for each segment and vertex, about.
const FINENESS: Fineness = Fineness {
    items_per_cell: 1.0,
    cells: [4096.0, CELLS_MAX],
    entries: [32, 1 << 20],
    crowd: 16,
    reach: 0.0,
    is_whole: false,
};

/// Fine cells along the side of a cell: they say quickly that nothing is near.
const FINE: usize = 4;

/// Columns and rows of fine cells, ends included.
type FineRange = [[usize; 2]; 2];

/// What lies in a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Item {
    Segment(u32),
    Vertex(u32),
}

/// Cells over the box of a network, with the segments and vertices in each.
///
/// Memory: about 4 bytes a cell, and 4 for each segment and vertex in a cell. There are about as many cells
/// as segments and vertices.
#[derive(Debug)]
pub(super) struct Cells {
    /// Numbers of segments; those of vertices come after all segments.
    tree: CellTree,
    segments: u32,
    /// What is known of each grid of the tree.
    known: Vec<Known>,
}

/// What is known of the cells of a grid that are not divided.
#[derive(Debug)]
struct Known {
    /// Fine cells that a segment meets.
    segments: Bits,
    /// Fine cells with vertices that were not found yet.
    vertices: Bits,
    /// Cells that are divided.
    divided: Bits,
    /// All cells with an item.
    pyramid: Pyramid,
    /// Cells with an item in them or beside them, divided or not.
    near: Bits,
}

impl Cells {
    pub(super) fn new(network: &Network) -> Cells {
        let segments = network.segments.len() as u32;
        let item = |item: u32| match network.segments.get(item as usize) {
            Some(segment) => cell_tree::Item::Segment(network.places(segment)),
            None => cell_tree::Item::Place(network.vertices[(item - segments) as usize].place),
        };
        let tree = CellTree::new(segments + network.vertices.len() as u32, item, &FINENESS);
        let mut known = Vec::new();
        tree.for_each_grid(&mut |tree| known.push((tree.number, Known::new(tree))));
        known.sort_unstable_by_key(|&(number, _)| number);
        let mut known: Vec<Known> = known.into_iter().map(|(_, known)| known).collect();
        tree.for_each_grid(&mut |tree| known[tree.number].fill(tree, &item, segments));
        Cells { tree, segments, known }
    }

    /// The vertex of the network at a place.
    pub(super) fn vertex_at(&self, place: Point2, network: &Network) -> Option<u32> {
        let (tree, cell) = self.tree.leaf(place)?;
        let vertices = self.vertices(tree, cell);
        let place_of = |item: u32| network.vertices[(item - self.segments) as usize].place;
        let at = vertices.partition_point(|&item| lexicographic(place_of(item), place).is_lt());
        vertices.get(at).filter(|&&item| place_of(item) == place).map(|item| item - self.segments)
    }

    /// The items of a cell that are vertices. They grow, and so do their places in lexicographic order.
    fn vertices<'t>(&self, tree: &'t CellTree, cell: usize) -> &'t [u32] {
        let items = tree.list(cell);
        &items[items.partition_point(|&item| item < self.segments)..]
    }

    /// Notes that a vertex is found. `found` has those that are, this one included; the others
    /// are NaN.
    pub(super) fn find(&mut self, vertex: u32, network: &Network, found: &[f64]) {
        let place = network.vertices[vertex as usize].place;
        let Some((tree, cell)) = self.tree.leaf(place) else { return };
        let (vertices, grid) = (self.vertices(tree, cell), tree.grid.finer(FINE));
        let fine = grid.cell(place);
        let is_left = |&item: &u32| {
            let other = (item - self.segments) as usize;
            found[other].is_nan() && grid.cell(network.vertices[other].place) == fine
        };
        // From the vertex to both sides, as vertices are found about in the order of their places: in a
        // crowded cell, the next one is left.
        let at = vertices.partition_point(|&item| item < self.segments + vertex);
        let beside = |step: usize| [at.checked_sub(step), Some(at + step)];
        let mut others = (1..vertices.len()).flat_map(beside).flatten();
        if !others.any(|other| vertices.get(other).is_some_and(is_left)) {
            self.known[tree.number].vertices.clear([fine % grid.size[0], fine / grid.size[0]]);
        }
    }

    /// A distance within which nothing is, on both axes; zero if none is known. Small ones, of twice the
    /// spacing of points or less, are not looked for: few triangles are as small.
    #[inline]
    pub(super) fn free_around(&self, place: Point2, spacing: f64) -> f64 {
        let mut tree = &self.tree;
        loop {
            let grid = &tree.grid;
            if tree.has_all(place, grid.side) && self.known[tree.number].is_far(grid.local(place), grid.size)
            {
                return 0.99 * grid.side;
            }
            let has_inner = !tree.divided().is_empty() && is_crowded(tree, grid.cell(place));
            match has_inner.then(|| tree.inner_at(place)).flatten() {
                Some(inner) => tree = inner,
                None => break,
            }
        }
        let fine = 0.99 * self.tree.grid.side / FINE as f64;
        let around = |grid: &Grid| {
            let (at, reach) = (grid.local(place), fine * grid.scale);
            CellBox { min: at.map(|x| x - reach), max: at.map(|x| x + reach) }
        };
        let is_any = |known: &Known, fine| known.vertices.any(fine) || known.segments.any(fine);
        if fine > 2.0 * spacing && !self.has_any(&self.tree, &around, &is_any) { fine } else { 0.0 }
    }

    /// Whether no segment is in a box, which is given in units of the cells of a grid.
    #[inline]
    pub(super) fn is_free(&self, bounds: impl Fn(&Grid) -> CellBox) -> bool {
        !self.has_any(&self.tree, &bounds, &|known, fine| known.segments.any(fine))
    }

    /// Whether all vertices in a box were found, and no segment is in it if `segments` count, too.
    #[inline]
    pub(super) fn is_found(&self, bounds: impl Fn(&Grid) -> CellBox, segments: bool) -> bool {
        let is_any = |known: &Known, fine| known.vertices.any(fine) || segments && known.segments.any(fine);
        !self.has_any(&self.tree, &bounds, &is_any)
    }

    /// Whether a segment is in the cell of a place of the box of the network, and one in the fine cell.
    pub(super) fn has(&self, place: Point2, segment: u32) -> bool {
        let Some((tree, cell)) = self.tree.leaf(place) else { return false };
        let grid = tree.grid.finer(FINE);
        let fine = grid.cell(place);
        let is_fine = self.known[tree.number].segments.get([fine % grid.size[0], fine / grid.size[0]]);
        is_fine && tree.list(cell).contains(&segment)
    }

    /// Whether one of the fine cells that meet a box is what `is_any` says of a range of them.
    // Not recursive itself, so that it is inlined: few networks have divided cells.
    #[inline]
    fn has_any(
        &self,
        tree: &CellTree,
        bounds: &impl Fn(&Grid) -> CellBox,
        is_any: &impl Fn(&Known, FineRange) -> bool,
    ) -> bool {
        let local = bounds(&tree.grid);
        let [min, max] = [local.min, local.max].map(|corner| corner.map(|x| x * FINE as f64));
        let fine = cell_tree::range(&CellBox { min, max }, tree.grid.size.map(|count| count * FINE));
        let Some(fine) = fine else { return false };
        is_any(&self.known[tree.number], fine)
            || (!tree.divided().is_empty()
                && self.known[tree.number].divided.any(fine.map(|ends| ends.map(|at| at / FINE)))
                && self.has_any_inside(tree, fine, bounds, is_any))
    }

    /// [`Cells::has_any`] for the divided cells.
    #[inline(never)]
    fn has_any_inside(
        &self,
        tree: &CellTree,
        fine: FineRange,
        bounds: &impl Fn(&Grid) -> CellBox,
        is_any: &impl Fn(&Known, FineRange) -> bool,
    ) -> bool {
        let [columns, rows] = fine.map(|ends| ends.map(|at| at / FINE));
        let at = |column: usize, row: usize| (row * tree.grid.size[0] + column) as u32;
        (rows[0]..=rows[1]).any(|row| {
            let (first, last) = (at(columns[0], row), at(columns[1], row));
            let start = tree.divided().partition_point(|&(cell, _)| cell < first);
            let inner = tree.divided()[start..].iter().take_while(|&&(cell, _)| cell <= last);
            inner.flat_map(|(_, inner)| inner.trees()).any(|tree| self.has_any(tree, bounds, is_any))
        })
    }

    /// Calls `found` with the items of all cells that a shape may meet, some of them several times. `shape`
    /// is given in units of the cells of a grid: as its box, and whether it may meet a box.
    pub(super) fn for_each_in<M: Fn(&CellBox) -> bool>(
        &self,
        shape: impl Fn(&Grid) -> (CellBox, M),
        mut found: impl FnMut(Item),
    ) {
        self.for_each_of(&self.tree, &shape, &mut found);
    }

    fn for_each_of<M: Fn(&CellBox) -> bool>(
        &self,
        tree: &CellTree,
        shape: &impl Fn(&Grid) -> (CellBox, M),
        found: &mut impl FnMut(Item),
    ) {
        let (bounds, meets) = shape(&tree.grid);
        let Some(range) = tree.grid.range(&bounds) else { return };
        let mut visit = |cell: usize| {
            if is_crowded(tree, cell)
                && let Some(inner) = tree.inner(cell)
            {
                return inner.trees().for_each(|tree| self.for_each_of(tree, shape, found));
            }
            for &item in tree.list(cell) {
                found(match item.checked_sub(self.segments) {
                    None => Item::Segment(item),
                    Some(vertex) => Item::Vertex(vertex),
                });
            }
        };
        let [columns, rows] = range;
        if columns[1] - columns[0] <= 1 && rows[1] - rows[0] <= 1 {
            // Looking at the items of so few cells is quicker than to leave out one.
            for row in rows[0]..=rows[1] {
                (columns[0]..=columns[1]).for_each(|column| visit(row * tree.grid.size[0] + column));
            }
            return;
        }
        self.known[tree.number].pyramid.for_each_in(range, meets, visit);
    }
}

/// Whether a cell may be divided; to search for it takes longer.
#[inline]
fn is_crowded(tree: &CellTree, cell: usize) -> bool {
    tree.list(cell).len() > FINENESS.crowd
}

impl Known {
    fn new(tree: &CellTree) -> Known {
        let size = tree.grid.size;
        let pyramid = Pyramid::new(size, |cell| !tree.list(cell).is_empty());
        let (near, fine) = (pyramid.finest_spread(), size.map(|count| count * FINE));
        let mut divided = Bits::new(size);
        for cell in tree.divided().iter().map(|&(cell, _)| cell as usize) {
            divided.set([cell % size[0], cell / size[0]]);
        }
        Known { segments: Bits::new(fine), vertices: Bits::new(fine), divided, pyramid, near }
    }

    fn fill(&mut self, tree: &CellTree, item: &impl Fn(u32) -> cell_tree::Item, segments: u32) {
        let grid = tree.grid.finer(FINE);
        let is_whole = |fine: [usize; 2]| {
            let [column, row] = fine.map(|at| at / FINE);
            tree.inner(row * tree.grid.size[0] + column).is_none()
        };
        for number in tree.items() {
            let bits = if number < segments { &mut self.segments } else { &mut self.vertices };
            grid.for_each_cell(item(number), 0.0, &mut |cell| {
                let fine = [cell % grid.size[0], cell / grid.size[0]];
                if is_whole(fine) {
                    bits.set(fine);
                }
            });
        }
    }

    /// Whether nothing is nearer than the side of a cell to a place in units of cells.
    #[inline]
    fn is_far(&self, local: Point2, size: [usize; 2]) -> bool {
        let is_beside = (0..2).any(|axis| local[axis] < -1.0 || local[axis] > size[axis] as f64 + 1.0);
        is_beside || !self.near.get([0, 1].map(|axis| (local[axis] as usize).min(size[axis] - 1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_delaunay::network::{NetworkSegment, NetworkVertex};

    /// Columns of short segments in the unit square, and segments from its middle to other places.
    fn network(count: u32, others: &[Point2]) -> Network {
        let side = count.isqrt();
        let place = |i: u32| [i / side, i % side].map(|step| f64::from(step) / f64::from(side));
        let mut places: Vec<Point2> = (0..count).map(place).collect();
        let middle = places[count as usize / 2];
        places.extend(others);
        places.sort_unstable_by(|a, b| lexicographic(*a, *b));
        let at = |place: Point2| places.iter().position(|&other| other == place).unwrap() as u32;
        let mut ends: Vec<[u32; 2]> = (0..places.len() as u32 - 1).map(|i| [i, i + 1]).collect();
        ends.retain(|ends| ends.iter().all(|&end| !others.contains(&places[end as usize])));
        ends.extend(others.iter().map(|&other| [at(middle).min(at(other)), at(middle).max(at(other))]));
        let vertices = places.iter().map(|&place| NetworkVertex { place, z: None }).collect();
        let segments = ends.into_iter().map(|ends| NetworkSegment { ends, line: 0, is_hard: false });
        Network { vertices, segments: segments.collect(), step: 1e-9 }
    }

    /// The items that small boxes over the unit square meet.
    fn work(network: &Network) -> usize {
        let (cells, mut work) = (Cells::new(network), 0);
        for at in 0..2500 {
            let [x, y] = [f64::from(at % 50) / 50.0, f64::from(at / 50) / 50.0];
            let shape = |grid: &Grid| {
                let local = [[x, y], [x + 0.005, y + 0.005]].map(|corner| grid.local(corner));
                (CellBox::of(&local), |_: &CellBox| true)
            };
            cells.for_each_in(shape, |_| work += 1);
        }
        work
    }

    #[test]
    fn far_vertices_at_most_triple_the_work() {
        let ordinary = work(&network(2_000, &[]));
        // Far beyond, roundings put long segments into more cells.
        for far in [-1e6, -1e3, 3.0, 1e3, 1e6] {
            for others in [&[[far, 0.5]][..], &[[far, far], [0.2, -far], [-far, 3.0]]] {
                let with = work(&network(2_000, others));
                assert!(with <= 3 * ordinary, "{far}: {with} instead of {ordinary}");
            }
        }
    }
}
