//! Insertion on several threads: each has a part of the complex, which others neither read nor write.
//!
//! The vertices, in order along the curve, are cut into ranges, one for each thread. A tetrahedron whose
//! finite vertices are all in one range belongs to this part. Tetrahedra with vertices of several ranges
//! belong to none; they lie between the parts, as neighbours have three vertices in common, and are
//! *frozen*: a part has copies of those next to it. A thread inserts points of its own range. If a frozen
//! tetrahedron is in conflict with a point, the point is refused, and inserted when the parts are one
//! complex again. Otherwise the cavity and all around it are in the part, and new tetrahedra are the part's
//! as well: their vertices are those of the cavity and the point. So parts fit together whatever the
//! threads did, and are Delaunay wherever no point is missing. The tetrahedralization is canonical: it does
//! not depend on the order of insertion.

use super::build::Build;
use super::complex::{Complex, DELETED, Facet, TETRAHEDRA_PER_VERTEX};
use super::cut::{Cut, PARTS_MAX};
use super::insertion::Buffers;
use super::slots::Slots;
use super::tetrahedralization::{NONE, Tetrahedron, Vertex, WORDS};
use super::weights::Weights;
use super::whole::{Setting, Tally, Whole};
use crate::order::Insertions;
use spmesh_core::error::Result;
use spmesh_core::parallel;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Greatest number of places along the curve where walks may start.
const STARTS_MAX: usize = 1 << 14;

/// A part has room for one of so many tetrahedra more than it is likely to have.
const SPARE: usize = 50;

/// Inserts vertices on so many threads, where `inserted` vertices are already. Returns those that are not
/// inserted yet: the ones between parts.
///
/// # Errors
/// Never fails: the type is that of [`parallel::map`].
pub(super) fn insert<W: Weights>(
    whole: &mut Whole,
    setting: &Setting<W>,
    inserted: usize,
    insertions: Insertions,
    threads: NonZeroUsize,
    tally: &mut Tally,
) -> Result<Vec<u32>> {
    let coarse = whole.tetrahedra.clone();
    let cut = Cut::new(&coarse, &whole.vertices, threads.get().min(PARTS_MAX));
    let mut numbers = vec![Vec::new(); cut.parts()];
    let new = insertions.filter(|v| !setting.first.contains(v));
    new.for_each(|v| numbers[usize::from(cut.part_of(v))].push(v));
    let sizes: Vec<usize> =
        (0..).zip(&numbers).map(|(part, numbers)| room(&cut, part, inserted, numbers.len())).collect();
    whole.tetrahedra.clear();
    let room = cut.frozen + sizes.iter().sum::<usize>();
    whole.tetrahedra.reserve_exact(room);
    whole.room = whole.room.max(room);
    let mut rest = Slots::of(&mut whole.tetrahedra, room);
    let mut frozen = rest.split_off_front(cut.frozen);
    let mut len = cut.frozen;
    let mut jobs = Vec::new();
    for ((part, numbers), size) in (0..).zip(numbers).zip(sizes) {
        jobs.push((part, numbers, rest.split_off_front(size), word_of(len)));
        len += size;
    }
    let copy = |(part, numbers, room, base)| {
        let (complex, rim) = cut.copy(part, room);
        let frame = Frame { part, own: cut.vertices_of(part), infinite: cut.infinite(), base, rim };
        Ok(Part { frame, complex, numbers })
    };
    let parts = parallel::map(threads, jobs, copy)?;
    let between = cut.frozen_tetrahedra();
    // Memory that the parts need.
    drop(cut);
    drop(coarse);
    let count = std::mem::take(&mut whole.vertices).len();
    let done = parallel::map(threads, parts, |part| Ok(part.run(setting)))?;
    between.write(&mut frozen, done.iter().map(|done| (done.part, &done.rim[..])));
    // SAFETY: each part has filled its room, and the room of frozen tetrahedra is full.
    unsafe { Slots::give_back(&mut whole.tetrahedra, len) };
    Ok(join(whole, done, count, tally))
}

/// Makes the `count` vertices and the free places of parts those of the whole. Returns the vertices that the
/// parts refused.
fn join(whole: &mut Whole, parts: Vec<Done>, count: usize, tally: &mut Tally) -> Vec<u32> {
    let mut refused = Vec::new();
    whole.free.clear();
    for part in parts {
        if whole.vertices.is_empty() {
            whole.vertices = part.vertices;
            whole.vertices.reserve_exact(count - whole.vertices.len());
        } else {
            whole.vertices.extend(part.vertices);
        }
        whole.free.extend(part.free);
        refused.extend(part.refused);
        tally.merge(&part.tally);
    }
    whole.vertices.push(Vertex::default());
    tally.stats.refused += refused.len() as u64;
    refused
}

/// The first word of the tetrahedron of this number.
fn word_of(number: usize) -> u32 {
    (number * WORDS) as u32
}

/// Room for the tetrahedra of a part after `count` insertions: as many per vertex as there are now. If it is
/// not enough, points are refused.
fn room(cut: &Cut<'_>, part: u16, inserted: usize, count: usize) -> usize {
    let (all, size) = (cut.vertices_of(part).len(), cut.sizes[usize::from(part)]);
    // Those inserted so far are evenly spread along the curve.
    let now = inserted as f64 * all as f64 / f64::from(cut.infinite());
    let likely = (size as f64 * (now + count as f64) / now) as usize;
    let likely = likely.min(TETRAHEDRA_PER_VERTEX * all).max(size);
    likely + likely / SPARE + cut.frozen
}

/// Tetrahedra of a part along the curve, from which walks start that would cross other parts otherwise.
fn starts(complex: &Complex<'_>) -> Vec<u32> {
    let finite = complex.infinite() as usize;
    let count = finite.min(STARTS_MAX);
    let mut starts = vec![NONE; count];
    let own = complex.words_of_tetrahedra().filter(|&t| t >= complex.frozen);
    for t in own {
        let least = complex.corners(t).into_iter().fold(NONE, u32::min) as usize;
        starts[least * count / finite] = t;
    }
    let mut last = starts.iter().copied().find(|&t| t != NONE);
    for start in &mut starts {
        match last {
            Some(before) if *start == NONE => *start = before,
            Some(_) => last = Some(*start),
            None => return Vec::new(),
        }
    }
    starts
}

/// How numbers of a part become those of the whole.
struct Frame {
    part: u16,
    /// The vertices of the part.
    own: Range<u32>,
    infinite: u32,
    /// Where the room of the part is, in words.
    base: u32,
    /// The numbers of the frozen tetrahedra that the part has copies of.
    rim: Vec<u32>,
}

/// A part before the insertions.
struct Part<'s> {
    frame: Frame,
    complex: Complex<'s>,
    /// The vertices to insert.
    numbers: Vec<u32>,
}

/// What is left of a part in the whole, beside its tetrahedra.
struct Done {
    part: u16,
    vertices: Vec<Vertex>,
    /// Frozen tetrahedra next to the part, by their numbers, and their neighbouring facets in it.
    rim: Vec<(u32, [Facet; 4])>,
    free: Vec<u32>,
    refused: Vec<u32>,
    tally: Tally,
}

impl Part<'_> {
    fn run<W: Weights>(self, setting: &Setting<W>) -> Done {
        let Part { frame, mut complex, mut numbers } = self;
        let (first, mut tally, mut refused) = (frame.own.start, Tally::default(), Vec::new());
        numbers.iter_mut().for_each(|v| *v -= first);
        let mut insertions = Insertions::listed(numbers);
        let starts = starts(&complex);
        if !starts.is_empty() {
            let build = Build {
                complex,
                setting,
                buffers: &mut Buffers::default(),
                stats: &mut tally.stats,
                insertions: &mut insertions,
                // They are not among the insertions.
                first: [u32::MAX; 4],
                starts: &starts,
                refused: &mut refused,
            };
            complex = setting.arithmetic.run(build, &mut tally.counts);
        }
        // Without room, or without a tetrahedron to start at.
        refused.extend(insertions);
        refused.iter_mut().for_each(|v| *v += first);
        let mut vertices = std::mem::take(&mut complex.vertices);
        vertices.truncate(frame.own.len());
        let (rim, free) = frame.restore(complex);
        Done { part: frame.part, vertices, rim, free, refused, tally }
    }
}

impl Frame {
    fn facet(&self, facet: Facet) -> Facet {
        match self.rim.get(facet as usize / WORDS) {
            Some(&number) => word_of(number as usize) | facet & 3,
            None => facet + self.base,
        }
    }

    /// Numbers all tetrahedra of a part as in the whole, and fills its room with deleted ones. Returns the
    /// neighbours of the copies of frozen tetrahedra, and all deleted tetrahedra.
    fn restore(&self, complex: Complex<'_>) -> (Vec<(u32, [Facet; 4])>, Vec<u32>) {
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
        let gaps = (len..tetrahedra.len()).rev().chain((0..self.rim.len()).rev()).map(word_of);
        (rim, gaps.chain(free).map(|t| t + self.base).collect())
    }
}

/// A place without a tetrahedron.
const GAP: Tetrahedron = Tetrahedron { vertices: [DELETED; 4], neighbours: [0; 4] };
