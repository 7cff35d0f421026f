//! Square cells over a network of lines, and what lies in them.

use super::pyramid::{Bits, Pyramid};
use spmesh_delaunay::cell_lists::CellLists;
use spmesh_delaunay::cell_walk::{TOLERANCE, for_each_cell};
use spmesh_delaunay::network::{Network, NetworkSegment};
use spmesh_delaunay::predicates::lexicographic;
use spmesh_stream::model::points::Point2;

/// Cells per segment and vertex, about, and their least and greatest number.
const CELLS_PER_ITEM: f64 = 1.0;
const CELLS_MIN: f64 = 4096.0;
pub(super) const CELLS_MAX: f64 = 4_194_304.0;

/// Items of all cells, for each segment and vertex, and beside these, at most: with more, cells are larger.
const ITEMS_MAX: [usize; 2] = [32, 1 << 20];

/// Fine cells along the side of a cell: they say quickly that nothing is near.
const FINE: usize = 4;

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
    origin: Point2,
    /// Cells per unit.
    scale: f64,
    columns: usize,
    rows: usize,
    /// Numbers of segments; those of vertices come after all segments.
    items: CellLists,
    segments: u32,
    /// Fine cells that a segment meets.
    fine_segments: Bits,
    /// Fine cells with vertices that were not found yet.
    fine_vertices: Bits,
    /// Fine cells with segments that leave the mesh, if there are any.
    fine_leaving: Option<Bits>,
    pyramid: Pyramid,
    /// Cells with an item in them or beside them.
    near: Bits,
}

/// A box in units of cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellBox {
    pub(super) min: Point2,
    pub(super) max: Point2,
}

impl CellBox {
    pub(super) fn of(places: &[Point2]) -> CellBox {
        let mut bounds = CellBox { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        places.iter().for_each(|&place| bounds.extend(place));
        bounds
    }

    pub(super) fn extend(&mut self, place: Point2) {
        let [[left, bottom], [right, top]] = [self.min, self.max];
        self.min = [left.min(place[0]), bottom.min(place[1])];
        self.max = [right.max(place[0]), top.max(place[1])];
    }
}

impl Cells {
    /// Segments that `leaving` says, if it is not empty, leave the mesh.
    pub(super) fn new(network: &Network, leaving: &[bool]) -> Cells {
        let mut bounds = CellBox::of(&[]);
        network.vertices.iter().for_each(|vertex| bounds.extend(vertex.place));
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let wanted = CELLS_PER_ITEM * (network.segments.len() + network.vertices.len()) as f64;
        let wanted = wanted.clamp(CELLS_MIN, CELLS_MAX);
        // A long thin box has few cells across, and at most as many along as it may have in all.
        let side = (width * height / wanted).sqrt().max(width.max(height) / wanted);
        let mut side = if side > 0.0 { side } else { 1.0 };
        loop {
            let count = |length: f64| (length / side) as usize + 1;
            let mut cells = Cells::empty(bounds.min, 1.0 / side, [count(width), count(height)]);
            if cells.fill(network) {
                cells.fine_leaving = (!leaving.is_empty()).then(|| {
                    let numbered = network.segments.iter().zip(leaving);
                    cells.fine(network, numbered.filter(|(_, leaves)| **leaves).map(|(segment, _)| segment))
                });
                return cells;
            }
            // One cell has each item once.
            side *= 2.0;
        }
    }

    fn empty(origin: Point2, scale: f64, [columns, rows]: [usize; 2]) -> Cells {
        Cells {
            origin,
            scale,
            columns,
            rows,
            items: CellLists::default(),
            segments: 0,
            fine_segments: Bits::default(),
            fine_vertices: Bits::default(),
            fine_leaving: None,
            pyramid: Pyramid::default(),
            near: Bits::default(),
        }
    }

    /// Cells per unit.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// A place in units of cells.
    pub(super) fn local(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (place[axis] - self.origin[axis]) * self.scale)
    }

    /// Enters what is in each cell. Returns whether that is few enough.
    fn fill(&mut self, network: &Network) -> bool {
        self.segments = network.segments.len() as u32;
        let size = [self.columns, self.rows];
        let count = self.segments + network.vertices.len() as u32;
        let most = ITEMS_MAX[0] * count as usize + ITEMS_MAX[1];
        let items = CellLists::of(self.columns * self.rows, count, most, |item, visit| {
            if let Some(vertex) = item.checked_sub(self.segments) {
                return visit(self.cell(network.vertices[vertex as usize].place));
            }
            let ends = network.places(&network.segments[item as usize]).map(|end| self.local(end));
            for_each_cell(ends, size, |[column, row]| visit(row * self.columns + column));
        });
        let Some(items) = items else { return false };
        self.pyramid = Pyramid::new(size, |cell| !items.get(cell).is_empty());
        self.near = self.pyramid.finest_spread();
        self.items = items;
        self.fill_fine(network);
        true
    }

    fn fill_fine(&mut self, network: &Network) {
        let mut vertices = Bits::new(self.fine_size());
        network.vertices.iter().for_each(|vertex| vertices.set(self.fine_cell(vertex.place)));
        (self.fine_segments, self.fine_vertices) = (self.fine(network, network.segments.iter()), vertices);
    }

    /// The fine cells that segments meet.
    fn fine<'n>(&self, network: &Network, segments: impl Iterator<Item = &'n NetworkSegment>) -> Bits {
        let size = self.fine_size();
        let mut bits = Bits::new(size);
        for segment in segments {
            let ends = network.places(segment).map(|end| self.local(end).map(|x| x * FINE as f64));
            for_each_cell(ends, size, |cell| bits.set(cell));
        }
        bits
    }

    fn fine_size(&self) -> [usize; 2] {
        [self.columns, self.rows].map(|count| count * FINE)
    }

    fn fine_cell(&self, place: Point2) -> [usize; 2] {
        let (local, size) = (self.local(place), self.fine_size());
        [0, 1].map(|axis| ((local[axis] * FINE as f64) as usize).min(size[axis] - 1))
    }

    /// The cell of a place.
    fn cell(&self, place: Point2) -> usize {
        let [column, row] = self.local(place).map(|x| x as usize);
        row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)
    }

    /// The vertex of the network at a place in the box of the network.
    pub(super) fn vertex_at(&self, place: Point2, network: &Network) -> Option<u32> {
        let vertices = self.vertices(self.cell(place));
        let place_of = |item: u32| network.vertices[(item - self.segments) as usize].place;
        let at = vertices.partition_point(|&item| lexicographic(place_of(item), place).is_lt());
        vertices.get(at).filter(|&&item| place_of(item) == place).map(|item| item - self.segments)
    }

    /// The items of a cell that are vertices. They grow, and so do their places in lexicographic order.
    fn vertices(&self, cell: usize) -> &[u32] {
        let items = self.items.get(cell);
        &items[items.partition_point(|&item| item < self.segments)..]
    }

    /// Notes that a vertex is found. `is_found` says which are, this one included.
    pub(super) fn find(&mut self, vertex: u32, network: &Network, is_found: &[bool]) {
        let place = network.vertices[vertex as usize].place;
        let (vertices, fine) = (self.vertices(self.cell(place)), self.fine_cell(place));
        let is_left = |&item: &u32| {
            let other = (item - self.segments) as usize;
            !is_found[other] && self.fine_cell(network.vertices[other].place) == fine
        };
        // From the vertex to both sides, as vertices are found about in the order of their places: in a
        // crowded cell, the next one is left.
        let at = vertices.partition_point(|&item| item < self.segments + vertex);
        let beside = |step: usize| [at.checked_sub(step), Some(at + step)];
        let mut others = (1..vertices.len()).flat_map(beside).flatten();
        if !others.any(|other| vertices.get(other).is_some_and(is_left)) {
            self.fine_vertices.clear(fine);
        }
    }

    /// Whether nothing is nearer to a place than the side of a cell; may be false then, too.
    #[inline]
    pub(super) fn is_far(&self, place: Point2) -> bool {
        let (local, size) = (self.local(place), [self.columns, self.rows]);
        let is_beside = (0..2).any(|axis| local[axis] < -1.0 || local[axis] > size[axis] as f64 + 1.0);
        is_beside || !self.near.get([0, 1].map(|axis| (local[axis] as usize).min(size[axis] - 1)))
    }

    /// Whether no segment is in a box.
    #[inline]
    pub(super) fn is_free(&self, bounds: &CellBox) -> bool {
        self.fine_range(bounds).is_none_or(|range| !self.fine_segments.any(range))
    }

    /// Whether all vertices in a box were found, and no segment in it leaves the mesh.
    #[inline]
    pub(super) fn is_found(&self, bounds: &CellBox) -> bool {
        self.fine_range(bounds).is_none_or(|range| !self.fine_vertices.any(range)) && !self.may_leave(bounds)
    }

    /// Whether a segment in a box leaves the mesh.
    #[inline]
    pub(super) fn may_leave(&self, bounds: &CellBox) -> bool {
        let Some(leaving) = &self.fine_leaving else { return false };
        self.fine_range(bounds).is_some_and(|range| leaving.any(range))
    }

    /// Whether a segment that leaves the mesh is in the cell of a place of the box of the network, and in the
    /// fine one.
    pub(super) fn has(&self, place: Point2, segment: u32) -> bool {
        let is_fine = self.fine_leaving.as_ref().is_some_and(|leaving| leaving.get(self.fine_cell(place)));
        is_fine && self.items.get(self.cell(place)).contains(&segment)
    }

    #[inline]
    fn fine_range(&self, bounds: &CellBox) -> Option<[[usize; 2]; 2]> {
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.map(|x| x * FINE as f64));
        range(&CellBox { min, max }, self.fine_size())
    }

    /// Calls `found` with the items of all cells that meet a box and that `meets` accepts, some of them
    /// several times. `meets` takes a box and may accept too much.
    pub(super) fn for_each_in(
        &self,
        bounds: &CellBox,
        meets: impl Fn(&CellBox) -> bool,
        mut found: impl FnMut(Item),
    ) {
        let Some(range) = range(bounds, [self.columns, self.rows]) else { return };
        let mut visit = |cell: usize| {
            for &item in self.items.get(cell) {
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
                (columns[0]..=columns[1]).for_each(|column| visit(row * self.columns + column));
            }
            return;
        }
        self.pyramid.for_each_in(range, meets, visit);
    }
}

/// The columns and rows that a box meets; `None` if it is outside.
#[inline]
fn range(bounds: &CellBox, size: [usize; 2]) -> Option<[[usize; 2]; 2]> {
    let mut ranges = [[0; 2]; 2];
    for axis in 0..2 {
        let [low, high] = [bounds.min[axis] - TOLERANCE, bounds.max[axis] + TOLERANCE];
        if high < 0.0 || low > size[axis] as f64 {
            return None;
        }
        // Conversions saturate: what is below zero or not a number becomes zero.
        ranges[axis] = [low as usize, high as usize].map(|cell| cell.min(size[axis] - 1));
    }
    Some(ranges)
}
