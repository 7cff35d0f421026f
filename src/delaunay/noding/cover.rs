//! Which parts of lines cover each piece of a segment.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::nodes::Nodes;
use super::places::Part;

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
