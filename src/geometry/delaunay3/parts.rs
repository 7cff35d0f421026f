//! Insertion on several threads: each has a part of the complex, which others neither read nor write.
//!
//! The vertices, in order along the curve, are cut into ranges, one for each thread. A tetrahedron whose finite
//! vertices are all in one range belongs to this part. Tetrahedra with vertices of several ranges belong to
//! none; they lie between the parts, as neighbours have three vertices in common, and are *frozen*: a part has
//! copies of those next to it. A thread inserts points of its own range. If a frozen tetrahedron is in conflict
//! with a point, the point is refused, and inserted when the parts are one complex again. Otherwise the cavity
//! and all around it are in the part, and new tetrahedra are the part's as well: their vertices are those of
//! the cavity and the point. So parts fit together whatever the threads did, and are Delaunay wherever no
//! point is missing. The tetrahedralization is canonical: it does not depend on the order of insertion.

use super::build::Build;
use super::complex::{Complex, DELETED, Facet, TETRAHEDRA_PER_VERTEX};
use super::cut::{Cut, PARTS_MAX};
use super::insertion::Cavity;
use super::slots::Slots;
use super::tetrahedralization::{NONE, Tetrahedron, WORDS};
use super::weights::Weights;
use super::whole::{Setting, Tally, Whole};
use crate::order::Insertions;
use spmesh_core::error::Result;
use spmesh_core::parallel;
use std::num::NonZeroUsize;
use std::ops::Range;

/// A part has room for one of so many tetrahedra more than it is likely to have.
const SPARE: usize = 50;

/// Inserts vertices on so many threads. Returns those that are not inserted yet: the ones between parts.
///
/// # Errors
/// None: for the sake of [`parallel::map`].
pub(super) fn insert<W: Weights>(
    whole: &mut Whole,
    setting: &Setting<W>,
    insertions: Insertions,
    first: [u32; 4],
    threads: usize,
    tally: &mut Tally,
) -> Result<Vec<u32>> {
    let coarse = whole.tetrahedra.clone();
    let cut = Cut::new(&coarse, &whole.vertices, threads.min(PARTS_MAX));
    let mut numbers: Vec<Vec<u32>> = vec![Vec::new(); cut.parts()];
    insertions.filter(|v| !first.contains(v)).for_each(|v| numbers[usize::from(cut.part_of(v))].push(v));
    let sizes: Vec<usize> = (0..cut.parts()).map(|part| room(&cut, part, numbers[part].len())).collect();
    whole.tetrahedra.clear();
    whole.tetrahedra.reserve_exact(cut.frozen + sizes.iter().sum::<usize>());
    let mut room = Slots::of(&mut whole.tetrahedra);
    let mut frozen = room.split_off_front(cut.frozen);
    let mut at = cut.frozen;
    let mut jobs = Vec::new();
    for (part, numbers) in (0..).zip(numbers) {
        let size = sizes[usize::from(part)];
        jobs.push(Job { part, numbers, room: room.split_off_front(size), base: (at * WORDS) as u32 });
        at += size;
    }
    let threads = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    let done = parallel::map(threads, jobs, |job| Ok(job.run(&cut, setting)))?;
    cut.freeze(&mut frozen, done.iter().map(|done| (done.part, &done.rim[..])));
    // SAFETY: each part has filled its room, and the room of frozen tetrahedra is full.
    unsafe { Slots::give_back(&mut whole.tetrahedra, at) };
    let mut refused = Vec::new();
    whole.free.clear();
    for part in done {
        whole.free.extend(part.free);
        refused.extend(part.refused);
        tally.merge(&part.tally);
    }
    Ok(refused)
}

/// Room for the tetrahedra of a part after `count` insertions: as many per vertex as there are now. If it is
/// not enough, points are refused.
fn room(cut: &Cut<'_>, part: usize, count: usize) -> usize {
    let all = cut.vertices_of(part as u16).len();
    let now = (all - count).max(1);
    let likely = (cut.sizes[part] as f64 * all as f64 / now as f64) as usize;
    let likely = likely.min(TETRAHEDRA_PER_VERTEX * all).max(cut.sizes[part]);
    likely + likely / SPARE + cut.frozen
}

/// What a thread does.
struct Job<'s> {
    part: u16,
    /// The vertices to insert.
    numbers: Vec<u32>,
    /// Room for the tetrahedra of the part, and before them for copies of the frozen ones next to it.
    room: Slots<'s>,
    /// Where the room is in the whole, in words.
    base: u32,
}

/// What is left of a part in the whole, beside its tetrahedra.
struct Done {
    part: u16,
    /// Frozen tetrahedra next to the part, by their numbers, and their neighbouring facets in it.
    rim: Vec<(u32, [Facet; 4])>,
    free: Vec<u32>,
    refused: Vec<u32>,
    tally: Tally,
}

impl Job<'_> {
    fn run<W: Weights>(self, cut: &Cut<'_>, setting: &Setting<W>) -> Done {
        let Job { part, mut numbers, room, base } = self;
        let own = cut.vertices_of(part);
        let (complex, rim) = cut.copy(part, room);
        let mut tally = Tally::default();
        let mut refused = Vec::new();
        let start = complex.frozen;
        let complex = if complex.tetrahedra.len() > rim.len() {
            numbers.iter_mut().for_each(|v| *v -= own.start);
            let mut insertions = Insertions::listed(numbers);
            let build = Build {
                complex,
                weights: &setting.weights,
                cavity: &mut Cavity::default(),
                stats: &mut tally.stats,
                is_timed: setting.is_timed,
                is_portable: setting.is_portable,
                insertions: &mut insertions,
                // Those that are there already are not among the numbers.
                first: [NONE; 4],
                start,
                refused: &mut refused,
                infinite_lift: setting.infinite_lift,
            };
            let complex = setting.arithmetic.run(build, &mut tally.counts);
            // If there was no more room.
            refused.extend(insertions);
            refused.iter_mut().for_each(|v| *v += own.start);
            complex
        } else {
            refused = numbers;
            complex
        };
        let (rim, free) = Restored { own, infinite: cut.infinite(), base, rim }.restore(complex);
        Done { part, rim, free, refused, tally }
    }
}

/// From numbers of a part to numbers of the whole.
struct Restored {
    own: Range<u32>,
    infinite: u32,
    base: u32,
    /// The numbers of the frozen tetrahedra that the part has copies of.
    rim: Vec<u32>,
}

impl Restored {
    fn facet(&self, facet: Facet) -> Facet {
        match self.rim.get(facet as usize / WORDS) {
            Some(number) => number * WORDS as u32 + (facet & 3),
            None => facet + self.base,
        }
    }

    /// Numbers all tetrahedra of a part as in the whole, and fills its room with deleted ones. Returns what the
    /// copies of frozen tetrahedra have as neighbours, and all deleted tetrahedra.
    fn restore(self, complex: Complex<'_>) -> (Vec<(u32, [Facet; 4])>, Vec<u32>) {
        let Complex { mut tetrahedra, free, .. } = complex;
        let (copies, own) = tetrahedra.split_at_mut(self.rim.len());
        let neighbours = copies.iter().map(|copy| copy.neighbours.map(|facet| self.facet(facet)));
        let rim = self.rim.iter().copied().zip(neighbours).collect();
        copies.fill(GAP);
        let count = self.own.end - self.own.start;
        for Tetrahedron { vertices, neighbours } in own.iter_mut().filter(|t| t.vertices[0] < DELETED) {
            *vertices = vertices.map(|v| if v < count { v + self.own.start } else { self.infinite });
            *neighbours = neighbours.map(|facet| self.facet(facet));
        }
        let len = tetrahedra.len();
        while tetrahedra.left() > 0 {
            tetrahedra.push(GAP);
        }
        // The last one is taken first.
        let word = |place: usize| place as u32 * WORDS as u32 + self.base;
        let gaps = (len..tetrahedra.len()).rev().map(word).chain((0..self.rim.len()).rev().map(word));
        (rim, gaps.chain(free.into_iter().map(|t| t + self.base)).collect())
    }
}

/// A place without a tetrahedron.
const GAP: Tetrahedron = Tetrahedron { vertices: [DELETED; 4], neighbours: [0; 4] };
