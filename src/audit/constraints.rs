//! The segments of a constrained triangle mesh: chains of edges that meet at ends only.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use super::corner::name_corners;
use super::exact::plane::{Xy, lexicographic, orientation};
use super::hull::Outline;
use super::triangles::Corner;
use spmesh_stream::Segment;

/// Segments, and what is known of the chains of edges on them.
///
/// Memory: all segments, the vertices on them that are live, and two vertices for each part of a segment that
/// is covered.
#[derive(Debug, Default)]
pub(super) struct Constraints {
    segments: Vec<[Xy; 2]>,
    /// Edges on segments whose twin has not come yet; at the end, those of the border. Ids are increasing.
    sides: HashMap<[u64; 2], u32, RandomState>,
    /// Vertices at which an odd number of edges of a segment end: the ends of its chains.
    ends: HashMap<(u32, u64), Xy, RandomState>,
    /// Live vertices on segments.
    touches: HashMap<u64, Touch, RandomState>,
    open: Vec<u32>,
}

/// A segment with a vertex.
#[derive(Debug, Clone, Copy)]
struct Touch {
    segment: u32,
    /// Whether the vertex is between the ends.
    is_inner: bool,
}

impl Constraints {
    pub(super) fn add(&mut self, segments: &[Segment]) {
        self.segments.extend(segments.iter().map(|segment| segment.ends));
    }

    pub(super) fn add_open(&mut self, open: &[u32]) {
        self.open.extend_from_slice(open);
    }

    /// The segment with an edge of the border.
    pub(super) fn of_border(&self, edge: [u64; 2]) -> Option<u32> {
        self.sides.get(&sorted(edge)).copied()
    }

    /// Whether an open segment crosses the interior of a counterclockwise triangle. Cost: the open segments.
    ///
    /// A segment and the interior of a triangle are apart if the line of a side or that of the segment has
    /// them on different sides.
    pub(super) fn has_open_in(&self, corners: [Xy; 3], ledger: &mut Ledger) -> bool {
        let [a, b, c] = corners;
        self.open.iter().any(|&number| {
            let [p, q] = self.segments[number as usize];
            let mut turns = |u, v, places: &[Xy]| {
                let turns = places.iter().map(|&at| orientation(u, v, at));
                let signs = turns.map(|turn| {
                    ledger.count(Check::Border, turn.exactly);
                    turn.sign
                });
                signs.collect::<Vec<Ordering>>()
            };
            let is_beside = |ends: [Xy; 2]| turns(ends[0], ends[1], &[p, q]).iter().all(|turn| turn.is_le());
            if [[a, b], [b, c], [c, a]].into_iter().any(is_beside) {
                return false;
            }
            let sides = turns(p, q, &corners);
            sides.contains(&Ordering::Less) && sides.contains(&Ordering::Greater)
        })
    }

    /// Takes an edge from the first of its triangles, which states that it is on `segment`, or on none.
    pub(super) fn first(
        &mut self,
        [a, b]: [Corner; 2],
        segment: Option<u32>,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let Some(segment) = segment else { return Ok(()) };
        self.sides.insert(sorted([a.id, b.id]), segment);
        for corner in [a, b] {
            self.check_on(segment, corner, ledger)?;
            self.touch(segment, corner)?;
            match self.ends.entry((segment, corner.id)) {
                Entry::Vacant(place) => drop(place.insert(corner.at)),
                Entry::Occupied(place) => drop(place.remove()),
            }
        }
        Ok(())
    }

    /// Takes an edge from the second of its triangles; whether it is on a segment.
    pub(super) fn second(&mut self, [a, b]: [Corner; 2], segment: Option<u32>) -> Result<bool, Violation> {
        let first = self.sides.remove(&sorted([a.id, b.id]));
        if first == segment {
            return Ok(segment.is_some());
        }
        let name = |segment: Option<u32>| segment.map_or("no segment".into(), |s| format!("segment {s}"));
        let message = format!(
            "edge {} to {} is on {} for one of its triangles, on {} for the other",
            a.id,
            b.id,
            name(first),
            name(segment)
        );
        Err(name_corners(Violation::new(Check::Constraints, message), &[a, b]))
    }

    /// Forgets a vertex that was finalized.
    pub(super) fn forget(&mut self, vertex: u64) {
        self.touches.remove(&vertex);
    }

    /// Proves that a vertex lies on a segment.
    fn check_on(&self, segment: u32, corner: Corner, ledger: &mut Ledger) -> Result<(), Violation> {
        let [p, q] = self.segments[segment as usize];
        let turn = orientation(p, q, corner.at);
        ledger.count(Check::Constraints, turn.exactly);
        let is_between = lexicographic(p, corner.at) != lexicographic(q, corner.at);
        if turn.sign == Ordering::Equal && is_between {
            return Ok(());
        }
        let message =
            format!("vertex {} is not on segment {segment}, which an edge from it is on", corner.id);
        Err(name_corners(Violation::new(Check::Constraints, message), &[corner]))
    }

    /// Proves that segments have no common point between their ends at a vertex.
    fn touch(&mut self, segment: u32, corner: Corner) -> Result<(), Violation> {
        let is_inner = !self.segments[segment as usize].contains(&corner.at);
        let touch = *self.touches.entry(corner.id).or_insert(Touch { segment, is_inner });
        if touch.segment == segment || !(touch.is_inner || is_inner) {
            return Ok(());
        }
        let message = format!(
            "segments {} and {segment} meet at vertex {}, which is not an end of both",
            touch.segment, corner.id
        );
        Err(name_corners(Violation::new(Check::Constraints, message), &[corner]))
    }

    /// Proves that the edges on each segment cover it, unless it is open. The edges on a segment do not
    /// overlap, so what they cover is known from where their chains end. Where the mesh covers the convex
    /// hull, which is `outline`, an open segment must leave it.
    pub(super) fn check_chains(
        &self,
        outline: Option<&Outline>,
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        let mut found = vec![[false; 2]; self.segments.len()];
        let mut gaps: HashMap<u32, Corner, RandomState> = HashMap::default();
        let mut chains: HashMap<u32, Vec<Xy>, RandomState> = HashMap::default();
        for (&(segment, id), &at) in &self.ends {
            if self.open.binary_search(&segment).is_ok() {
                chains.entry(segment).or_default().push(at);
            }
            match self.segments[segment as usize].iter().position(|&end| end == at) {
                Some(end) => found[segment as usize][end] = true,
                None => {
                    let gap = gaps.entry(segment).or_insert(Corner::new(id, at));
                    *gap = if gap.id <= id { *gap } else { Corner::new(id, at) };
                }
            }
        }
        let mut open = self.open.iter().copied().peekable();
        for (number, ends) in (0..).zip(&found) {
            ledger.add(Check::Constraints, 1);
            let is_open = open.next_if_eq(&number).is_some();
            let is_covered = *ends == [true; 2] && !gaps.contains_key(&number);
            if is_covered == is_open {
                return Err(self.wrong_chain(number, is_open, gaps.get(&number)));
            }
            let chain = chains.get(&number).map_or(&[][..], |chain| chain);
            if is_open && outline.is_some_and(|outline| !self.leaves(number, chain, outline, ledger)) {
                let message = format!("segment {number} is open, but does not leave the convex hull");
                return Err(self.of_segment(number, message));
            }
        }
        Ok(())
    }

    /// Whether a segment may be open: an end is outside of the convex hull, and its edges, from the first
    /// vertex on it to the last, are one chain. (The hull is convex, so edges join all vertices on a
    /// segment.)
    fn leaves(&self, number: u32, chain: &[Xy], outline: &Outline, ledger: &mut Ledger) -> bool {
        let ends = self.segments[number as usize];
        matches!(chain, [] | [_, _]) && ends.into_iter().any(|end| outline.excludes(end, ledger))
    }

    fn wrong_chain(&self, number: u32, is_open: bool, gap: Option<&Corner>) -> Violation {
        let message = match (is_open, gap) {
            (true, _) => format!("segment {number} is open, but edges cover it"),
            (false, None) => format!("edges do not cover segment {number}"),
            (false, Some(gap)) => {
                format!("edges do not cover segment {number}: a chain of them ends at vertex {}", gap.id)
            }
        };
        let violation = self.of_segment(number, message);
        gap.map_or(violation.clone(), |&gap| name_corners(violation, &[gap]))
    }

    fn of_segment(&self, number: u32, message: String) -> Violation {
        let ends = self.segments[number as usize];
        let violation = Violation::new(Check::Constraints, message);
        ends.iter().fold(violation, |violation, &[x, y]| violation.with(None, [x, y, 0.0]))
    }
}

fn sorted([a, b]: [u64; 2]) -> [u64; 2] {
    [a.min(b), a.max(b)]
}
