//! What a run did, and how long its phases took.

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

/// What a run did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stats {
    /// Tetrahedra created, infinite ones included.
    pub created: u64,
    /// Points tested against spheres, or against planes of the hull.
    pub in_sphere_tests: u64,
    /// Points tested against planes of facets in walks.
    pub orientation_tests: u64,
    /// Tetrahedra that walks stepped into.
    pub walk_steps: u64,
    /// In-sphere tests whose sign was wrong where the exact one is not zero. Only if signs are checked, like
    /// the next two.
    pub wrong_signs: u64,
    /// In-sphere tests whose exact value is zero, and the computed one is not.
    pub wrong_zeros: u64,
    /// In-sphere tests whose value was not the exact one. Known only of points with integer coordinates that
    /// differ by less than 2^23.
    pub rounded: u64,
    /// Orientations from spheres that were zero, so that the side was chosen at random.
    pub random_sides: u64,
    /// Walks that began again, elsewhere.
    pub restarts: u64,
    /// Points that rounding left in a tetrahedron but outside of its sphere: they were taken to be inside.
    pub forced: u64,
    /// Times that a cavity was changed so that the point sees all of its facets.
    pub repairs: u64,
    /// Distinct points that are no vertex of any tetrahedron: they were left out, or lost. If all points lie
    /// in a plane, these are all.
    pub missing: u64,
    /// Where the time went.
    pub seconds: Seconds,
    /// Memory in use at the end, the result not included.
    pub bytes: u64,
}

/// Seconds by part of the work. Those of the last three are shares, known from a sample, of the time for all
/// insertions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// Levels, order along the curve, removal of duplicates.
    pub order: f64,
    /// Walks, their tests included.
    pub locate: f64,
    /// Search of the cavity by in-sphere tests, and the equations of new spheres.
    pub predicates: f64,
    /// Linking and writing new tetrahedra.
    pub update: f64,
    /// Reading out the result.
    pub extract: f64,
}
