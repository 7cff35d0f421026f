//! Insertion on several threads: each has a part of the complex, which others do not touch.
//!
//! The vertices, in order along the curve, are cut into ranges, one for each thread. A tetrahedron whose
//! finite vertices are all in one range belongs to that part. The others are *frozen*. They lie between the
//! parts, as neighbours have three vertices in common. A thread inserts points of its own range. It refuses a
//! point if the walk comes to a frozen tetrahedron, if a frozen one may be in conflict, or if there is no
//! room; refused points are inserted when all threads are done. Otherwise the cavity is in the part, its
//! neighbours are in the part or frozen, and the new tetrahedra belong to the part: their vertices are those
//! of the cavity and the point. So the parts and the frozen tetrahedra form a Delaunay tetrahedralization of
//! the points inserted so far. It is canonical: it does not depend on the order of insertion.
//!
//! All parts are in one array. A thread reads and writes words of its own tetrahedra. Of frozen ones it reads
//! the vertices, which nobody writes, and it reads and writes the words that name neighbours in its part,
//! which no other part uses.

use std::num::NonZeroUsize;
use std::ops::Range;

use super::build::Build;
use super::complex::{Complex, DELETED, FROZEN, TETRAHEDRA_PER_VERTEX};
use super::insertion::Buffers;
use super::tetrahedralization::{NONE, Tetrahedron, WORDS};
use super::weights::Weights;
use super::whole::{Setting, Tally, Whole};
use super::words::Words;
use crate::error::Result;
use crate::order::Insertions;
use crate::parallel;

/// A part has room for 1/`SPARE` more tetrahedra than it is likely to have.
const SPARE: usize = 50;

/// A place without a tetrahedron.
const GAP: Tetrahedron = Tetrahedron { vertices: [DELETED; 4], neighbours: [0; 4] };

/// What a thread works on.
struct Job<'s> {
    complex: Complex<'s>,
    /// The vertices to insert.
    vertices: Vec<u32>,
    starts: Vec<u32>,
}

/// What it leaves, beside tetrahedra.
struct Done {
    free: Vec<u32>,
    refused: Vec<u32>,
    tally: Tally,
}

/// Inserts vertices on `threads` threads into a complex that has `inserted` of them. Returns the vertices
/// that were refused.
pub(super) fn insert<W: Weights>(
    whole: &mut Whole,
    setting: &Setting<W>,
    inserted: usize,
    insertions: Insertions,
    threads: NonZeroUsize,
    tally: &mut Tally,
) -> Result<Vec<u32>> {
    let finite = whole.vertices.len() - 1;
    let parts = cut(&mut whole.tetrahedra, finite, threads.get());
    let ends: Vec<u32> = parts.iter().map(|part| part.own.end).collect();
    let mut vertices = vec![Vec::new(); parts.len()];
    for v in insertions.filter(|v| !setting.first.contains(v)) {
        vertices[ends.partition_point(|&end| end <= v)].push(v);
    }
    let share = inserted as f64 / finite as f64;
    let there = whole.tetrahedra.len();
    let most = whole.room_max().saturating_sub(there) / parts.len();
    let rooms = parts.iter().zip(&vertices);
    let rooms: Vec<usize> =
        rooms.map(|(part, vertices)| room(part, share, vertices.len()).min(most)).collect();
    let room = there + rooms.iter().sum::<usize>();
    whole.tetrahedra.reserve_exact(room - there);
    whole.room = whole.room.max(room);
    // SAFETY: facets of neighbours are words of tetrahedra in the array, and each part has room of its own,
    // which it uses in order: what is before its first fresh place was written. That parts do not touch each
    // other's words is said above. Nothing else uses the array while they exist.
    let words = unsafe { Words::of(&mut whole.tetrahedra) };
    let mut free = std::mem::take(&mut whole.free);
    let (mut jobs, mut first) = (Vec::new(), there);
    for ((part, vertices), room) in parts.into_iter().zip(vertices).zip(rooms) {
        let complex = Complex {
            vertices: &whole.vertices,
            numbers: vec![0; part.own.len() + 1],
            own: part.own,
            // SAFETY: as above.
            words: unsafe { words.share() },
            free: std::mem::take(&mut free),
            fresh: first..first + room,
        };
        jobs.push(Job { complex, vertices, starts: part.starts });
        first += room;
    }
    let done = parallel::map(threads, jobs, |job| Ok(job.run(setting)))?;
    // SAFETY: there is room for that many tetrahedra, and each part has written all of its own.
    unsafe { whole.tetrahedra.set_len(room) };
    thaw(&mut whole.tetrahedra[..there]);
    let mut refused = Vec::new();
    for part in done {
        whole.free.extend(part.free);
        refused.extend(part.refused);
        tally.merge(&part.tally);
    }
    tally.stats.refused += refused.len() as u64;
    Ok(refused)
}

/// Room for the tetrahedra of `count` more vertices of a part, where `share` of all vertices is inserted. It
/// assumes that inserted vertices are spread evenly along the curve, and that tetrahedra per vertex stay as
/// many. If the room is not enough, points are refused.
fn room(part: &Part, share: f64, count: usize) -> usize {
    let now = share * part.own.len() as f64;
    let likely = (part.size as f64 * (now + count as f64) / now) as usize;
    let likely = likely.min(TETRAHEDRA_PER_VERTEX * part.own.len()).max(part.size);
    likely + likely / SPARE - part.size
}

impl Job<'_> {
    fn run<W: Weights>(self, setting: &Setting<W>) -> Done {
        let Job { mut complex, vertices, starts } = self;
        let (mut tally, mut refused) = (Tally::default(), Vec::new());
        let mut insertions = Insertions::listed(vertices);
        if !starts.is_empty() {
            let build = Build {
                complex: &mut complex,
                setting,
                buffers: &mut Buffers::default(),
                stats: &mut tally.stats,
                insertions: &mut insertions,
                // They are not among the insertions.
                first: [u32::MAX; 4],
                starts: &starts,
                refused: &mut refused,
            };
            setting.arithmetic.run(build, &mut tally.counts);
        }
        // Without room, or without a tetrahedron to start at.
        refused.extend(insertions);
        let Complex { mut words, mut free, fresh, .. } = complex;
        // In reverse, as the last of `free` is used first.
        for t in fresh.rev().map(|number| (number * WORDS) as u32) {
            words.write(t, GAP.vertices, GAP.neighbours);
            free.push(t);
        }
        Done { free, refused, tally }
    }
}

/// Greatest number of parts.
pub(super) const PARTS_MAX: usize = 1024;

/// Parts are cut at borders of bins of vertices, at most 2^16.
const BITS_OF_BINS: u32 = 16;

/// A cut may be off the even place by 1/`SLACK` of the vertices of a part.
const SLACK: usize = 16;

/// Greatest number of places along the curve, in each part, where walks may start.
const STARTS_MAX: usize = 1 << 14;

/// A part of a complex.
#[derive(Debug)]
pub(super) struct Part {
    /// Its vertices.
    pub(super) own: Range<u32>,
    /// Number of its tetrahedra.
    pub(super) size: usize,
    /// Tetrahedra of the part along the curve. Walks that come to a frozen tetrahedron start again at them.
    pub(super) starts: Vec<u32>,
}

/// Cuts a complex with `finite` finite vertices into parts, at most as many as asked for, and freezes the
/// tetrahedra between them.
pub(super) fn cut(tetrahedra: &mut [Tetrahedron], finite: usize, parts: usize) -> Vec<Part> {
    let ends = ends(tetrahedra, finite, parts.min(PARTS_MAX));
    let mut first = 0;
    let part = |&end: &u32| {
        let own = std::mem::replace(&mut first, end)..end;
        let starts = vec![NONE; own.len().min(STARTS_MAX)];
        Part { own, size: 0, starts }
    };
    let mut parts: Vec<Part> = ends.iter().map(part).collect();
    for (number, tetrahedron) in tetrahedra.iter_mut().enumerate().filter(|(_, t)| t.vertices[0] < DELETED) {
        let (least, greatest) = range(tetrahedron, finite as u32);
        let part = &mut parts[ends.partition_point(|&end| end <= least)];
        if greatest >= part.own.end {
            tetrahedron.vertices = tetrahedron.vertices.map(|v| v | FROZEN);
            continue;
        }
        part.size += 1;
        let place = (least - part.own.start) as usize * part.starts.len() / part.own.len();
        part.starts[place] = (number * WORDS) as u32;
    }
    parts.iter_mut().for_each(|part| fill(&mut part.starts));
    parts
}

/// Undoes the freezing of tetrahedra.
pub(super) fn thaw(tetrahedra: &mut [Tetrahedron]) {
    for tetrahedron in tetrahedra {
        tetrahedron.vertices = tetrahedron.vertices.map(|v| v & !FROZEN);
    }
}

/// Fills gaps with the entry before, the first ones with the first entry. Clears a list without entries.
fn fill(starts: &mut Vec<u32>) {
    let Some(mut last) = starts.iter().copied().find(|&t| t != NONE) else {
        return starts.clear();
    };
    for start in starts {
        if *start == NONE {
            *start = last;
        }
        last = *start;
    }
}

/// The least and the greatest finite vertex.
fn range(tetrahedron: &Tetrahedron, infinite: u32) -> (u32, u32) {
    let [a, b, c, d] = tetrahedron.vertices;
    let finite = tetrahedron.vertices.map(|v| if v == infinite { 0 } else { v });
    (a.min(b).min(c.min(d)), finite.into_iter().fold(0, u32::max))
}

/// Where to cut `count` vertices into parts of almost the same size: where the fewest tetrahedra are cut.
fn ends(tetrahedra: &[Tetrahedron], count: usize, parts: usize) -> Vec<u32> {
    let shift = (usize::BITS - count.leading_zeros()).saturating_sub(BITS_OF_BINS);
    // For each bin, how many more tetrahedra a cut before it splits than a cut before the previous bin.
    let mut cuts = vec![0i64; (count >> shift) + 2];
    for tetrahedron in tetrahedra.iter().filter(|tetrahedron| tetrahedron.vertices[0] < DELETED) {
        let (least, greatest) = range(tetrahedron, count as u32);
        cuts[(least >> shift) as usize + 1] += 1;
        cuts[(greatest >> shift) as usize + 1] -= 1;
    }
    let mut sum = 0;
    for cut in &mut cuts {
        sum += *cut;
        *cut = sum;
    }
    let slack = count / parts / SLACK;
    let mut ends: Vec<u32> = (1..parts)
        .map(|part| {
            let even = (count as u64 * part as u64 / parts as u64) as usize;
            let bins = (even - slack) >> shift..=(even + slack) >> shift;
            let best = bins.min_by_key(|&bin| cuts[bin]).unwrap_or(even >> shift);
            (best << shift) as u32
        })
        .collect();
    ends.push(count as u32);
    ends
}
