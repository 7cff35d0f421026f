//! What a tetrahedralization took.

use std::time::{Duration, Instant};

/// Work and time of one tetrahedralization: the columns of thesis table 3.3.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stats {
    /// Tetrahedra made, infinite ones included, those that did not last among them.
    pub created: u64,
    /// In-sphere tests of the search for cavities.
    pub insphere_tests: u64,
    /// Time for ordering and copying the points.
    pub order: Duration,
    /// Time for all insertions.
    pub insertion: Duration,
    /// Of the time for insertions, if it was measured: the walks, the search of the cavities with its predicates, and
    /// writing the stars.
    pub locate: Duration,
    /// See `locate`.
    pub cavity: Duration,
    /// See `locate`.
    pub update: Duration,
    /// Greatest number of bytes that the kernel and its result held at once.
    pub bytes: u64,
}

/// Splits the time of an insertion in parts, if anyone wants to know: looking at a clock takes its time.
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
