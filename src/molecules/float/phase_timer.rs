//! Time of the phases of insertions.

use super::stats::Seconds;
use std::time::{Duration, Instant};

/// One insertion in this many is timed: reading the clock takes time itself.
const SAMPLE: u32 = 8;

/// The phases of an insertion.
#[derive(Debug, Clone, Copy)]
pub(super) enum Phase {
    Locate,
    Predicates,
    Update,
}

/// Time of all insertions, and of the phases of a sample of them.
#[derive(Debug, Default)]
pub(super) struct PhaseTimer {
    all: Option<Instant>,
    last: Option<Instant>,
    parts: [Duration; 3],
}

impl PhaseTimer {
    /// Starts the time of all insertions.
    pub(super) fn begin_all(&mut self) {
        self.all = Some(Instant::now());
    }

    /// An insertion begins.
    #[inline(always)]
    pub(super) fn begin(&mut self, number: u32) {
        self.last = number.is_multiple_of(SAMPLE).then(Instant::now);
    }

    /// A phase of the insertion ends.
    #[inline(always)]
    pub(super) fn end(&mut self, phase: Phase) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            self.parts[phase as usize] += now - *last;
            *last = now;
        }
    }

    /// Ends the time of all insertions, and divides it among the phases as in the sample.
    pub(super) fn end_all(&mut self, seconds: &mut Seconds) {
        let all = self.all.take().map_or(0.0, |begin| begin.elapsed().as_secs_f64());
        let parts = self.parts.map(|part| part.as_secs_f64());
        let sum: f64 = parts.iter().sum();
        let share = |phase: Phase| if sum > 0.0 { all * parts[phase as usize] / sum } else { 0.0 };
        seconds.locate = share(Phase::Locate);
        seconds.predicates = share(Phase::Predicates);
        seconds.update = share(Phase::Update);
    }
}
