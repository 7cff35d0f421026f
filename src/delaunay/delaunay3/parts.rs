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

use super::build::Build;
use super::complex::{Complex, DELETED, TETRAHEDRA_PER_VERTEX};
use super::cut::{Part, cut, thaw};
use super::insertion::Buffers;
use super::tetrahedralization::{Tetrahedron, WORDS};
use super::weights::Weights;
use super::whole::{NUMBERED, Setting, Tally, Whole};
use super::words::Words;
use crate::error::Result;
use crate::order::Insertions;
use crate::parallel;
use std::num::NonZeroUsize;

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
    let most = (NUMBERED - there) / parts.len();
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
