//! Parts of lines that overlap along a straight line become one segment.
//!
//! This changes no result, as all ends of the parts are hot pixels, and the long segment passes through them.
//! It makes segments few where lines repeat, and leaves only crossings between segments that are not
//! parallel.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::exact::{Place, cross, minus};
use super::nodes::{Nodes, Part, Parts};

/// Segments, of which no two overlap.
pub(super) struct Segments {
    /// Numbers of places, the lexicographically lesser one first.
    pub(super) ends: Vec<[u32; 2]>,
    /// The parts of all segments: those of a segment are consecutive, and start in increasing order along it.
    parts: Vec<Part>,
    /// Number of the first part of each segment.
    starts: Vec<u32>,
}

impl Segments {
    pub(super) fn parts(&self, segment: usize) -> &[Part] {
        let end = self.starts.get(segment + 1).map_or(self.parts.len(), |&next| next as usize);
        &self.parts[self.starts[segment] as usize..end]
    }
}

/// The straight line through a part: its first place and a direction to the right, or upwards.
#[derive(Clone, Copy)]
struct Line {
    place: Place,
    along: Place,
}

impl Line {
    fn of(places: &[Place], part: &Part) -> Line {
        let [a, b] = part.ends.map(|end| places[end as usize]);
        Line { place: a, along: minus(b, a) }
    }

    /// Equal lines have equal keys, because the quotient of two integers that fit f64 is rounded correctly.
    fn key(&self) -> u64 {
        let [dx, dy] = self.along.map(|step| step as f64);
        if dx == 0.0 { f64::INFINITY.to_bits() } else { (dy / dx).to_bits() }
    }

    /// A total order of lines: by slope, then across.
    fn order(&self, other: &Line) -> Ordering {
        let slopes = cross(other.along, self.along).cmp(&0);
        slopes.then_with(|| cross(self.along, minus(self.place, other.place)).cmp(&0))
    }
}

/// Merges parts that overlap along a line.
pub(super) fn merge(places: &[Place], Parts(parts): Parts) -> Segments {
    let line = |key: u128| Line::of(places, &parts[key as u32 as usize]);
    let first = |key: u128| (key >> 32) as u32;
    let numbered = parts.iter().enumerate();
    let mut keys: Vec<u128> = numbered
        .map(|(number, part)| {
            let slope = Line::of(places, part).key();
            u128::from(slope) << 64 | u128::from(part.ends[0]) << 32 | number as u128
        })
        .collect();
    keys.sort_unstable();
    for same_key in keys.chunk_by_mut(|a, b| a >> 64 == b >> 64) {
        if same_key.len() > 1 {
            same_key.sort_unstable_by(|&a, &b| line(a).order(&line(b)).then(first(a).cmp(&first(b))));
        }
    }
    let sorted: Vec<Part> = keys.iter().map(|&key| parts[key as u32 as usize]).collect();
    drop(keys);
    drop(parts);
    let mut segments = Segments { ends: Vec::with_capacity(sorted.len()), parts: sorted, starts: Vec::new() };
    let mut last: Option<Line> = None;
    for (number, part) in segments.parts.iter().enumerate() {
        let line = Line::of(places, part);
        let is_same = last.is_some_and(|last| last.order(&line) == Ordering::Equal);
        match segments.ends.last_mut() {
            // Places of a straight line are in lexicographic order.
            Some(ends) if is_same && part.ends[0] < ends[1] => ends[1] = ends[1].max(part.ends[1]),
            _ => {
                segments.ends.push(part.ends);
                segments.starts.push(number as u32);
            }
        }
        last = Some(line);
    }
    segments
}

/// A piece of a chain, between two consecutive nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// The least line with a part along it.
    pub(super) line: u32,
    /// Whether several parts run along it.
    pub(super) is_shared: bool,
    /// Whether one of these has elevations at both ends.
    pub(super) is_hard: bool,
}

/// Finds what covers the pieces of a chain; keeps its buffers.
#[derive(Default)]
pub(super) struct Cover {
    pub(super) pieces: Vec<Piece>,
    /// Whether a part ends at each node of the chain.
    pub(super) is_end: Vec<bool>,
    /// How many more parts start than end at each node.
    changes: Vec<i32>,
    /// Lines of the parts that have started, and where these end.
    open: BinaryHeap<Reverse<(u32, u32)>>,
}

impl Cover {
    /// Replaces the content by what `parts` cover of the segment with this `chain` of nodes. The parts start
    /// in increasing order along it.
    pub(super) fn find(&mut self, nodes: &Nodes, chain: &[u32], parts: &[Part]) {
        self.pieces.clear();
        self.is_end.clear();
        self.is_end.resize(chain.len(), false);
        if let [part] = parts {
            self.is_end[0] = true;
            self.is_end[chain.len() - 1] = true;
            let piece = Piece { line: part.line, is_shared: false, is_hard: part.is_hard };
            self.pieces.resize(chain.len() - 1, piece);
            return;
        }
        self.changes.clear();
        self.changes.resize(chain.len(), 0);
        self.open.clear();
        let is_falling = nodes.is_falling(chain[0], chain[chain.len() - 1]);
        let key = |&node: &u32| nodes.key_along(node, is_falling);
        let index = |place: u32| chain.partition_point(|node| key(node) < key(&nodes.of_place(place)));
        let mut parts = parts.iter().map(|part| (part.ends.map(index), part)).peekable();
        let (mut count, mut hard_end) = (0, 0);
        for piece in 0..chain.len() - 1 {
            while let Some(([start, end], part)) = parts.next_if(|(ends, _)| ends[0] == piece) {
                self.is_end[start] = true;
                self.is_end[end] = true;
                self.changes[start] += 1;
                self.changes[end] -= 1;
                self.open.push(Reverse((part.line, end as u32)));
                hard_end = if part.is_hard { hard_end.max(end) } else { hard_end };
            }
            count += self.changes[piece];
            while self.open.peek().is_some_and(|Reverse((_, end))| *end as usize <= piece) {
                self.open.pop();
            }
            let line = self.open.peek().map_or(u32::MAX, |Reverse((line, _))| *line);
            debug_assert!(count > 0, "a segment is the union of its parts");
            self.pieces.push(Piece { line, is_shared: count > 1, is_hard: piece < hard_end });
        }
    }
}
