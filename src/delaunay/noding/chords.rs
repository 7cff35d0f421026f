//! Whether segments that pass through a cell from side to side meet in it.
//!
//! Such segments are chords of the cell. Two chords cross if and only if their ends alternate around the
//! cell. Going around it once, with a stack of the chords whose first end has been passed, finds out for all
//! chords together.

use std::cmp::Ordering;

use super::Noded;
use super::exact::{Place, cross, meets_pixel, minus};
use super::search::Cell;

/// Longest side of a cell that can be examined, doubled: a position on a side is then a fraction of a
/// numerator below 2^82 and a denominator up to 2^44, and products of both fit i128.
const SIDE_MAX: i64 = 1 << 38;

/// Numbers of the sides, in counterclockwise order.
const BOTTOM: u8 = 0;
const RIGHT: u8 = 1;
const TOP: u8 = 2;
const LEFT: u8 = 3;

/// A place on the border of a cell: a side, and the fraction of units that it is behind the start of the
/// side, going counterclockwise. The end of a side counts as the start of the next.
#[derive(Debug, Clone, Copy)]
struct End {
    side: u8,
    numerator: i128,
    denominator: i64,
    /// The side and the fraction, rounded.
    about: f64,
    chord: u32,
}

impl End {
    fn order(&self, other: &End) -> Ordering {
        self.side.cmp(&other.side).then_with(|| {
            let one = self.numerator * i128::from(other.denominator);
            one.cmp(&(other.numerator * i128::from(self.denominator)))
        })
    }

    /// Whether the half-open cell contains the place: the bottom and the left side, without the last place.
    fn is_inside(&self) -> bool {
        self.side == BOTTOM || (self.side == LEFT && self.numerator > 0)
    }
}

/// Examines cells; keeps its buffers.
#[derive(Default)]
pub(super) struct Chords {
    ends: Vec<End>,
    /// Ranks of the ends of each chord: how many different places come before them.
    ranks: Vec<[u32; 2]>,
    open: Vec<u32>,
    group: Vec<u32>,
}

impl Chords {
    /// Whether no two of the segments meet in the half-open cell. No segment may end in it, and no two may
    /// overlap. If the cell is one pixel, the answer is exact. For others it is false also where segments
    /// meet on the border, and for large cells.
    pub(super) fn are_apart(&mut self, cell: &Cell, segments: impl Iterator<Item = [Place; 2]>) -> bool {
        let frame = Frame::of(cell);
        if frame.len.iter().any(|&len| len > SIDE_MAX) {
            return false;
        }
        self.ends.clear();
        let mut chords = 0;
        for segment in segments {
            if let Some(ends) = frame.chord(segment, chords) {
                self.ends.extend(ends);
                chords += 1;
            }
        }
        // The exact order costs much less where it finds the ends in order already, but for ties.
        self.ends.sort_unstable_by(|a, b| a.about.total_cmp(&b.about));
        self.ends.sort_by(End::order);
        self.rank(chords as usize);
        self.go_around()
    }

    fn rank(&mut self, chords: usize) {
        self.ranks.clear();
        self.ranks.resize(chords, [u32::MAX; 2]);
        for (rank, group) in self.ends.chunk_by(|a, b| a.order(b) == Ordering::Equal).enumerate() {
            for end in group {
                let ranks = &mut self.ranks[end.chord as usize];
                ranks[usize::from(ranks[0] != u32::MAX)] = rank as u32;
            }
        }
    }

    /// Whether the ends of chords do not alternate, and no two chords have an end in common inside of the
    /// cell.
    fn go_around(&mut self) -> bool {
        self.open.clear();
        for (rank, group) in self.ends.chunk_by(|a, b| a.order(b) == Ordering::Equal).enumerate() {
            let rank = rank as u32;
            if group[0].is_inside() && group.iter().any(|end| end.chord != group[0].chord) {
                return false;
            }
            // Chords that share an end do not cross elsewhere: those that close come first, inner ones first.
            let closing = group.iter().filter(|end| {
                let [first, last] = self.ranks[end.chord as usize];
                last == rank && first != rank
            });
            for _ in closing {
                match self.open.pop() {
                    Some(chord) if self.ranks[chord as usize][1] == rank => {}
                    _ => return false,
                }
            }
            // Those that open come last, outer ones first. A chord of one place crosses nothing.
            self.group.clear();
            let opening = group.iter().map(|end| end.chord).filter(|&chord| {
                let [first, last] = self.ranks[chord as usize];
                first == rank && last != rank
            });
            self.group.extend(opening);
            self.group.sort_unstable_by_key(|&chord| std::cmp::Reverse(self.ranks[chord as usize][1]));
            self.open.extend(&self.group);
        }
        true
    }
}

/// A cell in doubled coordinates, in which its sides are integers.
struct Frame {
    min: Place,
    len: [i64; 2],
}

impl Frame {
    fn of(cell: &Cell) -> Frame {
        let min = cell.min.map(|min| 2 * min - 1);
        Frame { min, len: minus(cell.max.map(|max| 2 * max - 1), min) }
    }

    /// The ends of a chord along a line through two places, the first of which is lexicographically lesser;
    /// `None` if the line does not meet the closed cell.
    fn chord(&self, segment: [Place; 2], chord: u32) -> Option<[End; 2]> {
        let [a, b] = segment.map(|place| place.map(|value| 2 * value));
        let ([dx, dy], [width, height]) = (minus(b, a), self.len);
        let end = |side, numerator: i128, denominator: i64| {
            let len = if side % 2 == 0 { width } else { height };
            if numerator < 0 || numerator > i128::from(len) * i128::from(denominator) {
                return None;
            }
            if numerator == i128::from(len) * i128::from(denominator) {
                let side = (side + 1) % 4;
                return Some(End { side, numerator: 0, denominator: 1, about: f64::from(side), chord });
            }
            let about = f64::from(side) + numerator as f64 / (denominator as f64 * len as f64);
            Some(End { side, numerator, denominator, about, chord })
        };
        if dx == 0 {
            let x = a[0] - self.min[0];
            return Some([end(BOTTOM, x.into(), 1)?, end(TOP, (width - x).into(), 1)?]);
        }
        let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
        // Heights above the bottom, times dx, where the line enters on the left and leaves on the right.
        let entry = cross([dx, dy], minus(a, self.min));
        let (exit, top) = (entry + product(dy, width), product(height, dx));
        if dy == 0 && !(0..=top).contains(&entry) {
            return None;
        }
        let first = match entry {
            ..0 => end(BOTTOM, -entry, dy)?,
            _ if entry > top => end(TOP, product(width, -dy) - (entry - top), -dy)?,
            _ => end(LEFT, top - entry, dx)?,
        };
        let last = match exit {
            ..0 => end(BOTTOM, entry, -dy)?,
            _ if exit > top => end(TOP, product(width, dy) - (top - entry), dy)?,
            _ => end(RIGHT, exit, dx)?,
        };
        Some([first, last])
    }
}

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
