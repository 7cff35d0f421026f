//! The directed edges of a mesh that wait for their twin.

use std::collections::HashMap;

use foldhash::fast::RandomState;

use super::exact::plane::Xy;

/// A vertex as the geometry sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub(super) id: u64,
    pub(super) at: Xy,
}

impl Corner {
    /// The position as a point for messages.
    pub(super) fn point(self) -> [f64; 3] {
        [self.at[0], self.at[1], 0.0]
    }
}

/// What adding a directed edge did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meeting {
    /// Its twin has not come yet.
    Open,
    /// Its twin was open and is not any more; the corner opposite of the edge in the triangle of the twin.
    Twin(Corner),
    /// Another triangle has the same directed edge open.
    Twice(Corner),
}

/// Directed edges, each with the third corner of its triangle, between their triangle and that of their twin.
///
/// Memory: the boundary of the triangles seen so far, which is the front of the stream and the hull.
#[derive(Debug, Default)]
pub(super) struct OpenEdges {
    open: HashMap<[u64; 2], Corner, RandomState>,
}

impl OpenEdges {
    /// Adds the edge `from`, `to` of a triangle whose third corner is `apex`.
    pub(super) fn meet(&mut self, from: u64, to: u64, apex: Corner) -> Meeting {
        if let Some(opposite) = self.open.remove(&[to, from]) {
            return Meeting::Twin(opposite);
        }
        match self.open.insert([from, to], apex) {
            None => Meeting::Open,
            Some(other) => Meeting::Twice(other),
        }
    }

    /// Takes an edge away; whether it was open.
    pub(super) fn close(&mut self, from: u64, to: u64) -> bool {
        self.open.remove(&[from, to]).is_some()
    }

    /// The open edge with the smallest ids.
    pub(super) fn first(&self) -> Option<[u64; 2]> {
        self.open.keys().min().copied()
    }

    /// The open edges in no order.
    pub(super) fn iter(&self) -> impl Iterator<Item = [u64; 2]> + '_ {
        self.open.keys().copied()
    }

    /// Number of open edges.
    pub(super) fn len(&self) -> usize {
        self.open.len()
    }
}
