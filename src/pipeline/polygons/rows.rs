//! Edges in horizontal rows, and the exact test of a place among those of its row.

use super::Side;
use spmesh_delaunay::cell_lists::CellLists;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_stream::model::points::Point2;

/// Entries of all rows, per edge, at most about. Long edges are in many rows.
const ENTRIES_PER_EDGE: usize = 8;

/// Edges per row, at least.
const EDGES_PER_ROW: usize = 2;

/// An edge of a polygon, from its lower end to its upper one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) ends: [Point2; 2],
    pub(super) polygon: u32,
}

/// The edges of polygons by rows.
#[derive(Debug)]
pub(super) struct Rows {
    /// Those of one polygon come one after the other.
    pub(super) edges: Vec<Edge>,
    /// Where rows begin, but the first one. As many edges begin in each row, so that edges far from all
    /// others leave rows as they are.
    bottoms: Vec<f64>,
    /// Numbers of edges in each row.
    entries: CellLists,
    /// For each row the place of its first group, and one more.
    starts: Vec<usize>,
    /// One for each polygon in a row, in increasing order.
    groups: Vec<Group>,
}

/// The edges of a polygon in a row.
#[derive(Debug, Clone, Copy)]
struct Group {
    /// The least and the greatest x of the edges.
    width: [f64; 2],
    /// The places of the first and behind the last one among those of the row.
    places: [u32; 2],
}

impl Rows {
    pub(super) fn new(sides: impl Iterator<Item = (u32, [Point2; 2])>) -> Rows {
        let upward = |[from, to]: [Point2; 2]| if from[1] <= to[1] { [from, to] } else { [to, from] };
        let edges: Vec<Edge> = sides.map(|(polygon, ends)| Edge { ends: upward(ends), polygon }).collect();
        assert!(u32::try_from(edges.len()).is_ok(), "more than 2^32 edges");
        let bottoms = bottoms(&edges);
        let (entries, starts) = (CellLists::default(), vec![0; bottoms.len() + 2]);
        let mut found = Rows { edges, bottoms, entries, starts, groups: Vec::new() };
        found.fill();
        found
    }

    /// Number of polygons with edges, or more.
    pub(super) fn polygons(&self) -> usize {
        self.edges.last().map_or(0, |edge| edge.polygon as usize + 1)
    }

    fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The row of a place. It never decreases with y, so an edge that meets the height of a place is in its
    /// row.
    fn row(&self, y: f64) -> usize {
        row(&self.bottoms, y)
    }

    fn fill(&mut self) {
        let rows = self.rows();
        let entries = CellLists::of(rows, self.edges.len() as u32, usize::MAX, |edge, visit| {
            let [first, last] = self.edges[edge as usize].ends.map(|end| self.row(end[1]));
            (first..=last).for_each(visit);
        });
        self.entries = entries.expect("fewer than 2^32 entries");
        for row in 0..rows {
            self.starts[row] = self.groups.len();
            self.group(row);
        }
        self.starts[rows] = self.groups.len();
    }

    /// Makes the groups of a row.
    fn group(&mut self, row: usize) {
        let mut before = None;
        for (place, &number) in (0..).zip(self.entries.get(row)) {
            let edge = self.edges[number as usize];
            if before.replace(edge.polygon) != Some(edge.polygon) {
                self.groups.push(Group { width: [f64::INFINITY, f64::NEG_INFINITY], places: [place; 2] });
            }
            let [a, b] = edge.ends.map(|end| end[0]);
            if let Some(Group { width, places }) = self.groups.last_mut() {
                *width = [width[0].min(a).min(b), width[1].max(a).max(b)];
                places[1] = place + 1;
            }
        }
    }

    /// Number of polygons that a test of a place looks at.
    #[cfg(test)]
    pub(super) fn work(&self, place: Point2) -> usize {
        let row = self.row(place[1]);
        self.starts[row + 1] - self.starts[row]
    }

    /// Where a place lies.
    pub(super) fn side(&self, place: Point2) -> Side {
        let mut found = Side::Outside;
        for (_, side) in self.at(place) {
            found = found.max(side);
            // Thousands of polygons may lie on each other, of which one decides.
            if found == Side::Inside {
                break;
            }
        }
        found
    }

    /// The polygons that have a place inside or on their border, in increasing order.
    pub(super) fn at(&self, place: Point2) -> impl Iterator<Item = (u32, Side)> {
        let row = if self.edges.is_empty() { None } else { Some(self.row(place[1])) };
        let entries = row.map_or(&[][..], |row| self.entries.get(row));
        let groups = row.map_or(&[][..], |row| &self.groups[self.starts[row]..self.starts[row + 1]]);
        groups.iter().filter_map(move |&Group { width: [low, high], places: [first, behind] }| {
            // Beyond these edges, a ray to the right meets none of them, or each crossing has its
            // counterpart.
            if place[0] < low || place[0] > high {
                return None;
            }
            let edges = &entries[first as usize..behind as usize];
            let side = self.side_of(edges, place);
            (side != Side::Outside).then(|| (self.edges[edges[0] as usize].polygon, side))
        })
    }

    /// Where a place lies for a polygon with these edges in its row.
    fn side_of(&self, edges: &[u32], place: Point2) -> Side {
        let mut predicates = FiniteFloatPredicates::default();
        let mut is_inside = false;
        for &edge in edges {
            match meeting(self.edges[edge as usize].ends, place, &mut predicates) {
                Meeting::On => return Side::Border,
                Meeting::Crossed => is_inside = !is_inside,
                Meeting::Not => {}
            }
        }
        if is_inside { Side::Inside } else { Side::Outside }
    }
}

fn row(bottoms: &[f64], y: f64) -> usize {
    bottoms.partition_point(|&bottom| bottom <= y)
}

/// Where rows begin, but the first one.
fn bottoms(edges: &[Edge]) -> Vec<f64> {
    let mut all: Vec<f64> = edges.iter().map(|edge| edge.ends[0][1]).collect();
    all.sort_unstable_by(f64::total_cmp);
    let thinned = |step: usize| {
        let mut bottoms: Vec<f64> = all.iter().copied().skip(step).step_by(step).collect();
        bottoms.dedup();
        bottoms
    };
    let bottoms = thinned(EDGES_PER_ROW);
    let entries = |edge: &Edge| {
        let [first, last] = edge.ends.map(|end| row(&bottoms, end[1]));
        last - first + 1
    };
    let entries: usize = edges.iter().map(entries).sum();
    match entries.div_ceil(ENTRIES_PER_EDGE * edges.len().max(1)) {
        0 | 1 => bottoms,
        // Edges are in as many fewer rows.
        times => thinned(times * EDGES_PER_ROW),
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
