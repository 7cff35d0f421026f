//! Edges in horizontal rows, and the exact test of a place among those of its row.

use super::Side;
use crate::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_model::points::Point2;

/// Entries of all rows, per edge, at most about. Long edges are in many rows.
const ENTRIES_PER_EDGE: f64 = 8.0;

/// Rows per edge, at most.
const ROWS_PER_EDGE: f64 = 0.5;

/// An edge of a polygon, from its lower end to its upper one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) ends: [Point2; 2],
    polygon: u32,
}

/// The edges of polygons by rows.
#[derive(Debug)]
pub(super) struct Rows {
    /// Those of one polygon in a row.
    pub(super) edges: Vec<Edge>,
    /// The least and the greatest x of each polygon.
    widths: Vec<[f64; 2]>,
    bottom: f64,
    /// Rows per unit of y.
    scale: f64,
    /// For each row the place of its first entry, and one more.
    starts: Vec<usize>,
    /// Numbers of edges, increasing in each row.
    entries: Vec<u32>,
}

impl Rows {
    pub(super) fn new(sides: impl Iterator<Item = (u32, [Point2; 2])>) -> Rows {
        let (mut edges, mut widths) = (Vec::new(), Vec::new());
        for (polygon, [from, to]) in sides {
            edges.push(Edge { ends: if from[1] <= to[1] { [from, to] } else { [to, from] }, polygon });
            let most = widths.len().max(polygon as usize + 1);
            widths.resize(most, [f64::INFINITY, f64::NEG_INFINITY]);
            let width = &mut widths[polygon as usize];
            *width = [width[0].min(from[0].min(to[0])), width[1].max(from[0].max(to[0]))];
        }
        assert!(u32::try_from(edges.len()).is_ok(), "more than 2^32 edges");
        let bottom = edges.iter().fold(f64::INFINITY, |y, edge| y.min(edge.ends[0][1]));
        let top = edges.iter().fold(f64::NEG_INFINITY, |y, edge| y.max(edge.ends[1][1]));
        let height = 0.5 * top - 0.5 * bottom;
        // The sum of the heights of edges, in units of the whole.
        let part = |edge: &Edge| (0.5 * edge.ends[1][1] - 0.5 * edge.ends[0][1]) / height;
        let parts: f64 = if height > 0.0 { edges.iter().map(part).sum() } else { 0.0 };
        let count = edges.len() as f64;
        let rows = (ROWS_PER_EDGE * count).min(ENTRIES_PER_EDGE * count / parts.max(1.0)) as usize + 1;
        let scale = rows as f64 / height * 0.5;
        let scale = if scale.is_finite() { scale } else { 0.0 };
        let mut found = Rows { edges, widths, bottom, scale, starts: vec![0; rows + 1], entries: Vec::new() };
        found.fill();
        found
    }

    fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The row of a place. It never decreases with y, so an edge that meets the height of a place is in its row.
    fn row(&self, y: f64) -> usize {
        // Halves, because a difference may exceed the range of f64.
        ((0.5 * y - 0.5 * self.bottom) * 2.0 * self.scale).min(self.rows() as f64 - 1.0) as usize
    }

    fn fill(&mut self) {
        let range = |rows: &Rows, edge: &Edge| rows.row(edge.ends[0][1])..=rows.row(edge.ends[1][1]);
        let mut next = vec![0; self.starts.len()];
        for edge in &self.edges {
            range(self, edge).for_each(|row| next[row + 1] += 1);
        }
        (1..next.len()).for_each(|row| next[row] += next[row - 1]);
        self.starts.copy_from_slice(&next);
        self.entries = vec![0; next[self.rows()]];
        for (number, edge) in (0..).zip(&self.edges) {
            for row in range(self, edge) {
                self.entries[next[row]] = number;
                next[row] += 1;
            }
        }
    }

    /// Where a place lies.
    pub(super) fn side(&self, place: Point2) -> Side {
        let mut found = Side::Outside;
        self.for_each_at(place, |_, side| found = found.max(side));
        found
    }

    /// Calls `found` with the polygons that have a place inside or on their border, in increasing order.
    pub(super) fn for_each_at(&self, place: Point2, mut found: impl FnMut(u32, Side)) {
        if self.edges.is_empty() {
            return;
        }
        let row = self.row(place[1]);
        let entries = &self.entries[self.starts[row]..self.starts[row + 1]];
        let edges = entries.iter().map(|&entry| &self.edges[entry as usize]);
        let mut open: Option<(u32, Side)> = None;
        let mut predicates = FiniteFloatPredicates::default();
        for edge in edges {
            let [low, high] = self.widths[edge.polygon as usize];
            if place[0] < low || place[0] > high {
                continue;
            }
            let (polygon, side) = match open {
                Some(known) if known.0 == edge.polygon => known,
                before => {
                    before.iter().filter(|known| known.1 != Side::Outside).for_each(|&(a, b)| found(a, b));
                    (edge.polygon, Side::Outside)
                }
            };
            let side = match (side, meeting(edge.ends, place, &mut predicates)) {
                (Side::Border, _) | (_, Meeting::On) => Side::Border,
                (Side::Outside, Meeting::Crossed) | (Side::Inside, Meeting::Not) => Side::Inside,
                (Side::Inside, Meeting::Crossed) | (Side::Outside, Meeting::Not) => Side::Outside,
            };
            open = Some((polygon, side));
        }
        open.iter().filter(|known| known.1 != Side::Outside).for_each(|&(a, b)| found(a, b));
    }
}

/// How the ray from a place to the right meets an edge.
enum Meeting {
    Not,
    /// It crosses it. An edge has its lower end, and not its upper one.
    Crossed,
    /// The place is on the edge.
    On,
}

fn meeting([low, high]: [Point2; 2], [x, y]: Point2, predicates: &mut FiniteFloatPredicates) -> Meeting {
    if y < low[1] || y > high[1] || x > low[0].max(high[0]) {
        return Meeting::Not;
    }
    let is_left = x < low[0].min(high[0]);
    if !is_left {
        match predicates.orient2d(low, high, [x, y]) {
            // Between the ends in x and y, and on their line.
            Sign::Zero => return Meeting::On,
            Sign::Negative => return Meeting::Not,
            Sign::Positive => {}
        }
    }
    if y < high[1] { Meeting::Crossed } else { Meeting::Not }
}
