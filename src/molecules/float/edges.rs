//! Pairs of facets around a cavity that share an edge.

const CLOSED: u32 = u32::MAX;

#[derive(Debug, Clone, Copy, Default)]
struct Slot {
    edge: [u32; 2],
    /// The slot is empty unless this is the stamp of the table.
    stamp: u32,
    side: u32,
}

/// What a table of edges knows of the edge of a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shared {
    /// No other side was at this edge so far.
    WithNone,
    /// This one was.
    With(u32),
    /// Two others were: the surface branches.
    WithTwo,
}

/// A hash table of the edges of one surface at a time.
#[derive(Debug, Default)]
pub(super) struct Edges {
    slots: Vec<Slot>,
    stamp: u32,
}

impl Edges {
    /// Empties the table, and makes it large enough for the edges of a surface of `facets` triangles.
    pub(super) fn clear(&mut self, facets: usize) {
        let slots = (4 * facets).next_power_of_two();
        if self.stamp == u32::MAX || self.slots.len() < slots {
            self.slots.clear();
            self.slots.resize(slots.max(256), Slot::default());
            self.stamp = 0;
        }
        self.stamp += 1;
    }

    /// Enters a side (below 2^32 - 1) at the edge between two vertices.
    ///
    /// Domain: at most three sides per facet of the surface that the table was cleared for.
    #[inline(always)]
    pub(super) fn enter(&mut self, u: u32, v: u32, side: u32) -> Shared {
        let edge = [u.min(v), u.max(v)];
        let bits = (u64::from(edge[0]) << 32 | u64::from(edge[1])).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut place = (bits >> 32) as usize & (self.slots.len() - 1);
        loop {
            let slot = &mut self.slots[place];
            if slot.stamp != self.stamp {
                *slot = Slot { edge, stamp: self.stamp, side };
                return Shared::WithNone;
            }
            if slot.edge == edge {
                let other = std::mem::replace(&mut slot.side, CLOSED);
                return if other == CLOSED { Shared::WithTwo } else { Shared::With(other) };
            }
            place = (place + 1) & (self.slots.len() - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_meet_once() {
        let mut edges = Edges::default();
        for facets in [1, 4, 1000] {
            edges.clear(facets);
            for side in 0..3 * facets as u32 {
                assert_eq!(edges.enter(side, 7_000_000, side), Shared::WithNone);
            }
            edges.clear(facets);
            assert_eq!(edges.enter(1, 2, 10), Shared::WithNone);
            assert_eq!(edges.enter(2, 1, 11), Shared::With(10));
            assert_eq!(edges.enter(1, 2, 12), Shared::WithTwo);
        }
    }
}
