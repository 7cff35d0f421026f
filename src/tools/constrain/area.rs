//! Whether triangles are in an area.

use super::cells::{CellBox, Cells};
use spmesh_geometry::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_model::network::{Network, NetworkSegment};
use spmesh_model::points::Point2;

/// Segments of a row of an [`Area`], about.
const SEGMENTS_PER_ROW: usize = 2;

/// What is known of a cell.
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;

/// The union of polygons whose borders are segments of a network.
///
/// Memory: 8 bytes for each segment in each row that it meets, and about 5 for each segment and vertex.
#[derive(Debug)]
pub(super) struct Area {
    /// The ends of the segments of borders, times three, the lower one first, and their polygons.
    edges: Vec<([Point2; 2], u32)>,
    bottom: f64,
    /// Rows per unit of y.
    scale: f64,
    /// For each row the place of its first edge in `items`, and one more.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Cells in which the borders are.
    cells: Cells,
    /// For each cell without a border whether it is inside.
    known: Vec<u8>,
    predicates: FiniteFloatPredicates,
    odd: Vec<u32>,
}

impl Area {
    /// The area of polygons, which are numbers of segments.
    pub(super) fn new(network: &Network, polygons: &[Vec<u32>]) -> Area {
        let mut edges = Vec::new();
        for (polygon, numbers) in (0..).zip(polygons) {
            for &number in numbers {
                let places = network.places(&network.segments[number as usize]);
                let [p, q] = places.map(|place| place.map(|x| 3.0 * x));
                edges.push((if p[1] <= q[1] { [p, q] } else { [q, p] }, polygon));
            }
        }
        let cells = Cells::new(&borders(network, polygons));
        let bottom = edges.iter().fold(f64::INFINITY, |y, (ends, _)| y.min(ends[0][1]));
        let top = edges.iter().fold(f64::NEG_INFINITY, |y, (ends, _)| y.max(ends[1][1]));
        let rows = edges.len() / SEGMENTS_PER_ROW + 1;
        let scale = if top > bottom { rows as f64 / (top - bottom) } else { 0.0 };
        let known = vec![0; cells.count()];
        let predicates = FiniteFloatPredicates::default();
        let (starts, items, odd) = (vec![0; rows + 1], Vec::new(), Vec::new());
        let mut area = Area { edges, bottom, scale, starts, items, cells, known, predicates, odd };
        area.fill(rows);
        area
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.bottom) * self.scale) as usize).min(self.starts.len() - 2)
    }

    fn fill(&mut self, rows: usize) {
        let range = |area: &Area, ends: [Point2; 2]| area.row(ends[0][1])..=area.row(ends[1][1]);
        let mut counts = vec![0u32; rows + 1];
        for &(ends, _) in &self.edges {
            range(self, ends).for_each(|row| counts[row + 1] += 1);
        }
        (1..=rows).for_each(|row| counts[row] += counts[row - 1]);
        self.items = vec![0; counts[rows] as usize];
        let mut next = counts.clone();
        for (number, &(ends, _)) in (0..).zip(&self.edges) {
            for row in range(self, ends) {
                self.items[next[row] as usize] = number;
                next[row] += 1;
            }
        }
        self.starts = counts;
    }

    /// Whether a triangle that no border divides is inside.
    pub(super) fn contains(&mut self, corners: [Point2; 3]) -> bool {
        let bounds = CellBox::of(&corners.map(|corner| self.cells.local(corner)));
        let Some(cell) = self.cells.free_cell(&bounds) else { return self.has(corners) };
        if self.known[cell] == 0 {
            self.known[cell] = if self.has(corners) { INSIDE } else { OUTSIDE };
        }
        self.known[cell] == INSIDE
    }

    /// Whether the middle of a triangle is inside of a polygon. Three times it is the sum of the corners,
    /// which is exact for integers.
    fn has(&mut self, corners: [Point2; 3]) -> bool {
        let middle = [0, 1].map(|axis| corners[0][axis] + corners[1][axis] + corners[2][axis]);
        let row = self.row(middle[1]);
        self.odd.clear();
        for &item in &self.items[self.starts[row] as usize..self.starts[row + 1] as usize] {
            let ([low, high], polygon) = self.edges[item as usize];
            // Half-open, so that a ray through a vertex crosses one of the two edges that pass there.
            let is_crossed = low[1] <= middle[1] && middle[1] < high[1];
            if is_crossed && self.predicates.orient2d(low, high, middle) == Sign::Positive {
                self.odd.push(polygon);
            }
        }
        self.odd.sort_unstable();
        self.odd.chunk_by(|a, b| a == b).any(|same| same.len() % 2 == 1)
    }
}

/// The segments of polygons alone, with their ends.
fn borders(network: &Network, polygons: &[Vec<u32>]) -> Network {
    let all = || polygons.iter().flatten().map(|&number| network.segments[number as usize]);
    let mut used: Vec<u32> = all().flat_map(|segment| segment.ends).collect();
    used.sort_unstable();
    used.dedup();
    let number = |end: u32| used.binary_search(&end).expect("an end of a segment") as u32;
    let segments = all().map(|it| NetworkSegment { ends: it.ends.map(number), ..it }).collect();
    Network { vertices: used.iter().map(|&vertex| network.vertices[vertex as usize]).collect(), segments }
}
