//! Where the time of insertions goes.

use super::stats::Seconds;
use std::time::{Duration, Instant};

/// One insertion of so many is timed: reading the clock takes a while itself.
const SAMPLE: u32 = 8;

/// The parts of an insertion.
#[derive(Debug, Clone, Copy)]
pub(super) enum Phase {
    Locate,
    Predicates,
    Update,
}

/// Time of all insertions, and of the parts of some.
#[derive(Debug, Default)]
pub(super) struct PhaseTimer {
    all: Option<Instant>,
    last: Option<Instant>,
    parts: [Duration; 3],
}

impl PhaseTimer {
    /// Starts the time of all.
    pub(super) fn begin_all(&mut self) {
        self.all = Some(Instant::now());
    }

    /// An insertion begins.
    #[inline(always)]
    pub(super) fn begin(&mut self, number: u32) {
        self.last = number.is_multiple_of(SAMPLE).then(Instant::now);
    }

    /// A part of it ends.
    #[inline(always)]
    pub(super) fn end(&mut self, phase: Phase) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            self.parts[phase as usize] += now - *last;
            *last = now;
        }
    }

    /// All insertions end: divides their time as that of those in the sample.
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
