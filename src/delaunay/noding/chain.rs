//! The segments to which a part of a line was bent.

use super::Noded;
use super::exact::{Place, meets_pixel, minus};

/// The segments of a network by their ends.
#[derive(Debug)]
pub struct Chains<'n> {
    noded: &'n Noded,
    /// For each vertex the place of its first segment in `segments`, and one more.
    starts: Vec<u32>,
    segments: Vec<u32>,
}

impl<'n> Chains<'n> {
    /// Memory: 4 bytes for each vertex, and 8 for each segment.
    pub fn new(noded: &'n Noded) -> Chains<'n> {
        let mut starts = vec![0u32; noded.vertices.len() + 1];
        let ends = || noded.segments.iter().flat_map(|segment| segment.ends);
        ends().for_each(|end| starts[end as usize + 1] += 1);
        (1..starts.len()).for_each(|place| starts[place] += starts[place - 1]);
        let mut next = starts.clone();
        let mut segments = vec![0; 2 * noded.segments.len()];
        for (number, segment) in (0..).zip(&noded.segments) {
            for end in segment.ends {
                segments[next[end as usize] as usize] = number;
                next[end as usize] += 1;
            }
        }
        Chains { noded, starts, segments }
    }

    /// Calls `found` with the numbers of the segments to which the part of a line from `a` to `b` was bent,
    /// in their order. Returns whether they form a chain, which they do for parts of the lines that were
    /// noded.
    ///
    /// A segment passes through the hot pixels that it meets, in the order of their centres: neither
    /// coordinate turns back. So the next vertex is the first one, in this order, of the neighbours whose
    /// pixels it meets.
    pub fn of_part(&self, a: Place, b: Place, mut found: impl FnMut(u32)) -> bool {
        let vertices = &self.noded.vertices;
        let number = |place: Place| vertices.binary_search_by(|vertex| vertex.place.cmp(&place)).ok();
        let (Some(mut at), Some(end)) = (number(a), number(b)) else { return false };
        let part = if a < b { [a, b] } else { [b, a] };
        let signs = minus(b, a).map(|difference| if difference < 0 { -1 } else { 1 });
        while at != end {
            let here = vertices[at].place;
            let around = &self.segments[self.starts[at] as usize..self.starts[at + 1] as usize];
            let steps = around.iter().filter_map(|&segment| {
                let [first, second] = self.noded.segments[segment as usize].ends;
                let other = if first as usize == at { second } else { first } as usize;
                let place = vertices[other].place;
                let [x, y] = minus(place, here);
                let step = [x * signs[0], y * signs[1]];
                let is_next = step[0] >= 0 && step[1] >= 0 && meets_pixel(part, place);
                is_next.then_some((step, other, segment))
            });
            let Some((_, next, segment)) = steps.min() else { return false };
            found(segment);
            at = next;
        }
        true
    }
}
