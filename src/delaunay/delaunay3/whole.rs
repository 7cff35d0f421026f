//! The complex of all points between insertions, and insertion on one thread or several.

use super::build::Build;
use super::complex::{Complex, DELETED, TETRAHEDRA_PER_VERTEX};
use super::insertion::Buffers;
use super::stats::Stats;
use super::tetrahedralization::{Tetrahedron, Vertex, WORDS};
use super::weights::Weights;
use super::words::Words;
use super::{Kernel, MAX_POINTS, parts};
use crate::error::{Error, Result};
use crate::order::{Insertions, Sequence};
use crate::predicates::{Arithmetic3, PredicateCounts};
use crate::watch::Watch;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Most tetrahedra whose words have numbers of 32 bits. No room is greater.
pub(super) const NUMBERED: usize = 1 << 29;

/// Greatest number of tetrahedra. It leaves numbers for one more star of all vertices.
pub(super) const TETRAHEDRA_MAX: usize = NUMBERED - 2 * MAX_POINTS;

/// How much denser points are after a phase than before.
const PHASE_FACTOR: usize = 8;

/// What all insertions of a run have in common.
#[derive(Debug)]
pub(super) struct Setting<W> {
    pub(super) weights: W,
    pub(super) arithmetic: Arithmetic3,
    /// See [`super::insertion::Insertion`].
    pub(super) infinite_lift: f64,
    /// The vertices of the first tetrahedron.
    pub(super) first: [u32; 4],
    pub(super) is_timed: bool,
    /// Whether only portable instructions are used.
    pub(super) is_portable: bool,
    pub(super) watch: Option<Arc<Watch>>,
}

/// What insertions did.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) stats: Stats,
    pub(super) counts: PredicateCounts,
}

impl Tally {
    pub(super) fn merge(&mut self, other: &Tally) {
        self.stats.merge(&other.stats);
        self.counts.merge(&other.counts);
    }
}

/// The complex, with its tetrahedra in an array.
#[derive(Debug)]
pub(super) struct Whole {
    /// The vertices, that at infinity last.
    pub(super) vertices: Vec<Vertex>,
    pub(super) tetrahedra: Vec<Tetrahedron>,
    pub(super) free: Vec<u32>,
    /// Number of tetrahedra that there is room for. The array may have more capacity, from earlier uses; the
    /// order of tetrahedra must not depend on it.
    pub(super) room: usize,
    /// Number of tetrahedra from which there is no more room for others.
    most: usize,
    /// See [`Complex::numbers`].
    numbers: Vec<u32>,
}

impl Whole {
    /// The first tetrahedron and those around it, in the memory of an array.
    pub(super) fn new(
        vertices: Vec<Vertex>,
        mut tetrahedra: Vec<Tetrahedron>,
        first: [u32; 4],
        most: usize,
    ) -> Whole {
        tetrahedra.clear();
        let most = most.min(TETRAHEDRA_MAX);
        let room = first_room(vertices.len()).min(room_max(most, vertices.len()));
        if tetrahedra.capacity() < room {
            // To enlarge the array would copy, and so touch, all of its capacity.
            drop(tetrahedra);
            tetrahedra = Vec::with_capacity(room);
        }
        let numbers = vec![0; vertices.len()];
        let mut whole = Whole { vertices, tetrahedra, free: Vec::new(), room, most, numbers };
        whole.change(|complex| complex.begin(first));
        whole
    }

    fn change(&mut self, change: impl FnOnce(&mut Complex<'_>)) {
        let fresh = self.tetrahedra.len()..self.room;
        let finite = self.vertices.len() as u32 - 1;
        let mut complex = Complex {
            vertices: &self.vertices,
            own: 0..finite,
            numbers: std::mem::take(&mut self.numbers),
            // SAFETY: facets of neighbours are words of tetrahedra in the array, and room is used in order:
            // what is before the first fresh place was written. Nothing else is made of the array, or uses
            // it.
            words: unsafe { Words::of(&mut self.tetrahedra) },
            free: std::mem::take(&mut self.free),
            fresh,
        };
        change(&mut complex);
        (self.numbers, self.free) = (complex.numbers, complex.free);
        let len = complex.fresh.start;
        // SAFETY: there is room for that many tetrahedra, and they have been written.
        unsafe { self.tetrahedra.set_len(len) };
    }

    /// Inserts vertices, except those of the first tetrahedron, on the calling thread.
    pub(super) fn insert<W: Weights>(
        &mut self,
        setting: &Setting<W>,
        insertions: &mut Insertions,
        buffers: &mut Buffers,
        tally: &mut Tally,
    ) -> Result<()> {
        let mut refused = Vec::new();
        loop {
            self.run(setting, insertions, buffers, tally, &mut refused);
            Watch::check(setting.watch.as_deref())?;
            // Only lack of room refuses vertices here.
            while let Some(vertex) = refused.pop() {
                self.grow()?;
                self.run(setting, &mut Insertions::listed(vec![vertex]), buffers, tally, &mut refused);
            }
            if insertions.len() == 0 {
                return Ok(());
            }
        }
    }

    fn run<W: Weights>(
        &mut self,
        setting: &Setting<W>,
        insertions: &mut Insertions,
        buffers: &mut Buffers,
        tally: &mut Tally,
        refused: &mut Vec<u32>,
    ) {
        let first_there = self.tetrahedra.iter().position(|tetrahedron| tetrahedron.vertices[0] < DELETED);
        let starts = [(first_there.unwrap_or(0) * WORDS) as u32];
        let Tally { stats, counts } = tally;
        let first = setting.first;
        self.change(|complex| {
            let build =
                Build { complex, setting, buffers, stats, insertions, first, starts: &starts, refused };
            setting.arithmetic.run(build, counts);
        });
    }

    #[cold]
    fn grow(&mut self) -> Result<()> {
        let len = self.tetrahedra.len();
        if len >= self.most {
            return Err(Error::TooManyTetrahedra(self.most));
        }
        self.room = greater_room(len, self.vertices.len()).min(self.room_max());
        self.tetrahedra.reserve_exact(self.room - len);
        Ok(())
    }

    /// The greatest room.
    pub(super) fn room_max(&self) -> usize {
        room_max(self.most, self.vertices.len())
    }
}

/// The greatest room for `most` tetrahedra: with it, one more star of all vertices.
fn room_max(most: usize, vertices: usize) -> usize {
    (most + 2 * vertices).min(NUMBERED)
}

/// Room to begin with.
fn first_room(vertices: usize) -> usize {
    (TETRAHEDRA_PER_VERTEX * vertices).min(NUMBERED)
}

/// Room to enlarge an array of `len` tetrahedra to; `len` is at most [`TETRAHEDRA_MAX`].
fn greater_room(len: usize, vertices: usize) -> usize {
    (len + len / 4 + 2 * vertices).min(NUMBERED)
}

/// The numbers of points at the ends of phases: all points of the first phase are inserted on one thread.
///
/// After a phase there are `PHASE_FACTOR` times as many points as before it, so that tetrahedra between
/// parts, which stay as they are during a phase, are thin. The last phase is split off while it has
/// `points_per_thread` points for each of two threads.
fn phases(count: usize, points_per_thread: usize) -> Vec<usize> {
    let mut ends = vec![count];
    let mut end = count;
    while end - end / PHASE_FACTOR >= 2 * points_per_thread.max(1) {
        end /= PHASE_FACTOR;
        ends.push(end);
    }
    ends.reverse();
    ends
}

impl Kernel {
    /// Inserts all vertices, with threads if that is worth it.
    pub(super) fn insert_all<W: Weights>(
        &mut self,
        whole: &mut Whole,
        setting: &Setting<W>,
        mut insertions: Insertions,
        tally: &mut Tally,
    ) -> Result<()> {
        let has_threads =
            self.threads.get() > 1 && W::ARE_EQUAL && self.sequence != Sequence::Pass && !self.by_bit_levels;
        if !has_threads {
            return whole.insert(setting, &mut insertions, &mut self.buffers, tally);
        }
        let mut done = 0;
        for end in phases(insertions.len(), self.points_per_thread) {
            let count = end - done;
            let threads = self.threads.get().min(count / self.points_per_thread.max(1));
            let mut numbers = Insertions::listed(insertions.by_ref().take(count).collect());
            if let Some(threads) = NonZeroUsize::new(threads)
                && threads.get() > 1
                && done > 0
            {
                let refused = parts::insert(whole, setting, done, numbers, threads, tally)?;
                numbers = Insertions::listed(refused);
            }
            whole.insert(setting, &mut numbers, &mut self.buffers, tally)?;
            done = end;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_greatest_rooms_have_numbers() {
        for vertices in [5, MAX_POINTS / 2, MAX_POINTS + 1] {
            let first = first_room(vertices);
            let greatest = greater_room(TETRAHEDRA_MAX - 1, vertices);
            assert!(greatest >= TETRAHEDRA_MAX - 1 + 2 * (vertices - 1));
            for room in [first, greatest] {
                assert!(u32::try_from(room * WORDS - 1).is_ok(), "{room} tetrahedra of {vertices} vertices");
            }
        }
    }
}
