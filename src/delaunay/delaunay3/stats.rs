//! Work and time of a tetrahedralization.

use std::time::{Duration, Instant};

/// Work and time of one tetrahedralization: the columns of thesis table 3.3.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stats {
    /// Tetrahedra created, including infinite ones and those deleted later.
    pub created: u64,
    /// In-sphere tests of the search for cavities.
    pub insphere_tests: u64,
    /// Points that threads have left to the calling thread, as they lie between parts.
    pub refused: u64,
    /// Time for ordering and copying the points.
    pub order: Duration,
    /// Time for all insertions.
    pub insertion: Duration,
    /// Time for the walks. This phase and the next two are zero unless
    /// [`Kernel::is_timed`](super::Kernel::is_timed).
    pub locate: Duration,
    /// Time for the search of the cavities, with its predicates.
    pub cavity: Duration,
    /// Time for writing the stars.
    pub update: Duration,
    /// Greatest number of bytes that the kernel and its result held at once.
    pub bytes: u64,
}

impl Stats {
    /// Adds the work of another thread; times are those of all threads together.
    pub(super) fn merge(&mut self, other: &Stats) {
        self.created += other.created;
        self.insphere_tests += other.insphere_tests;
        self.refused += other.refused;
        self.locate += other.locate;
        self.cavity += other.cavity;
        self.update += other.update;
    }
}

/// Splits the time of insertions into phases, on request only: reading the clock takes time itself.
#[derive(Debug)]
pub(super) struct PhaseTimer {
    last: Option<Instant>,
}

impl PhaseTimer {
    pub(super) fn new(is_wanted: bool) -> PhaseTimer {
        PhaseTimer { last: is_wanted.then(Instant::now) }
    }

    /// Adds the time since the last call to `part`.
    #[inline(always)]
    pub(super) fn end_phase(&mut self, part: &mut Duration) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            *part += now - *last;
            *last = now;
        }
    }
}
