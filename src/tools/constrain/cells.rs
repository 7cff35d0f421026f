//! Square cells over a network of lines, and what lies in them.

use super::bits::Bits;
use super::pyramid::Pyramid;
use spmesh_geometry::cell_walk::{TOLERANCE, for_each_cell};
use spmesh_geometry::predicates::lexicographic;
use spmesh_model::network::Network;
use spmesh_model::points::Point2;

/// Cells per segment and vertex, about, and their least and greatest number.
const CELLS_PER_ITEM: f64 = 1.0;
const CELLS: [f64; 2] = [4096.0, 4_194_304.0];

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
    /// For each cell the place of its first item, and one more.
    starts: Vec<u32>,
    /// Numbers of segments; those of vertices come after all segments.
    items: Vec<u32>,
    segments: u32,
    /// Fine cells that a segment meets.
    fine_segments: Bits,
    /// Fine cells with vertices that were not found yet.
    fine_vertices: Bits,
    pyramid: Pyramid,
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
    pub(super) fn new(network: &Network) -> Cells {
        let places: Vec<Point2> = network.vertices.iter().map(|vertex| vertex.place).collect();
        let bounds = CellBox::of(&places);
        drop(places);
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let wanted = CELLS_PER_ITEM * (network.segments.len() + network.vertices.len()) as f64;
        let wanted = wanted.clamp(CELLS[0], CELLS[1]);
        // A long thin box has few cells across, and at most as many along as it may have in all.
        let side = (width * height / wanted).sqrt().max(width.max(height) / wanted);
        let side = if side > 0.0 { side } else { 1.0 };
        let count = |length: f64| (length / side) as usize + 1;
        let [columns, rows] = [count(width), count(height)];
        let mut cells = Cells {
            origin: bounds.min,
            scale: 1.0 / side,
            columns,
            rows,
            starts: vec![0; columns * rows + 1],
            items: Vec::new(),
            segments: network.segments.len() as u32,
            fine_segments: Bits::new([columns * FINE, rows * FINE]),
            fine_vertices: Bits::new([columns * FINE, rows * FINE]),
            pyramid: Pyramid::default(),
        };
        cells.fill(network);
        let is_occupied = |cell: usize| cells.starts[cell] < cells.starts[cell + 1];
        cells.pyramid = Pyramid::new([columns, rows], is_occupied);
        cells
    }

    /// Cells per unit.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// A place in units of cells.
    pub(super) fn local(&self, place: Point2) -> Point2 {
        [0, 1].map(|axis| (place[axis] - self.origin[axis]) * self.scale)
    }

    /// Counts the items of each cell, then puts them in.
    fn fill(&mut self, network: &Network) {
        let mut counts = vec![0u32; self.columns * self.rows];
        self.for_each_place(network, |cell, _| counts[cell] += 1);
        let mut sum = 0;
        for (start, count) in self.starts.iter_mut().zip(counts.iter().chain([&0])) {
            *start = sum;
            sum += count;
        }
        let mut items = vec![0; sum as usize];
        let mut next = counts;
        next.copy_from_slice(&self.starts[..self.starts.len() - 1]);
        self.for_each_place(network, |cell, item| {
            items[next[cell] as usize] = item;
            next[cell] += 1;
        });
        self.items = items;
        let mut fine = std::mem::take(&mut self.fine_segments);
        let size = self.fine_size();
        for segment in &network.segments {
            let ends = network.places(segment).map(|end| self.local(end).map(|x| x * FINE as f64));
            for_each_cell(ends, size, |cell| fine.set(cell));
        }
        self.fine_segments = fine;
        for vertex in &network.vertices {
            self.fine_vertices.set(self.fine_cell(vertex.place));
        }
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
        let items = &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize];
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

    fn for_each_place(&self, network: &Network, mut found: impl FnMut(usize, u32)) {
        let size = [self.columns, self.rows];
        for (number, segment) in (0..).zip(&network.segments) {
            let ends = network.places(segment).map(|end| self.local(end));
            for_each_cell(ends, size, |[column, row]| found(row * self.columns + column, number));
        }
        for (number, vertex) in (self.segments..).zip(&network.vertices) {
            found(self.cell(vertex.place), number);
        }
    }

    /// Whether no segment is in a box.
    #[inline]
    pub(super) fn is_free(&self, bounds: &CellBox) -> bool {
        self.fine_range(bounds).is_none_or(|range| !self.fine_segments.any(range))
    }

    /// Whether all vertices in a box were found.
    #[inline]
    pub(super) fn is_found(&self, bounds: &CellBox) -> bool {
        self.fine_range(bounds).is_none_or(|range| !self.fine_vertices.any(range))
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
        self.pyramid.for_each_in(range, meets, |cell| {
            for &item in &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                found(match item.checked_sub(self.segments) {
                    None => Item::Segment(item),
                    Some(vertex) => Item::Vertex(vertex),
                });
            }
        });
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
