//! The simplex that contains a target, found by a walk from one to the next, in the plane and in space alike.
//!
//! From a simplex the walk goes on across a side that the target is beyond. In a Delaunay triangulation, and
//! in a regular one, it meets no simplex twice (Edelsbrunner, "An acyclicity theorem for cell complexes in d
//! dimensions", 1990). All decisions are exact.

use crate::batch;
use crate::points::is_finite;
use crate::predicates::Sign;
use foldhash::HashSet;
use std::num::NonZeroUsize;

/// Steps from a simplex that is probably near, after which another start is tried, too. To find it costs
/// about as much.
const STEPS_TO_NEXT: usize = 16;

/// Most targets that a [`Walker`] jumps to before it tries a walk from the last one again. Of targets in no
/// order, the lost steps are then a small part; where they come in order again, a jump costs a few times a
/// short walk.
const JUMPS_MAX: u32 = 31;

/// Simplices of `N` corners in `D` dimensions, with their neighbours.
pub(crate) trait Walkable<const D: usize, const N: usize>: Sync {
    /// What decides sides; made once for many targets.
    type Predicates: Default;

    /// Number of simplices.
    fn simplices_len(&self) -> usize;

    /// On which side of the facet opposite to corner `corner` of a simplex the target lies: positive on that
    /// of the corner.
    fn side(&self, simplex: u32, corner: usize, target: [f64; D], predicates: &mut Self::Predicates) -> Sign;

    /// The simplex across the facet opposite to a corner; `None` at the hull.
    fn across(&self, simplex: u32, corner: usize) -> Option<u32>;

    /// Where walks to targets in no order begin.
    fn start_near(&self, target: [f64; D]) -> u32;
}

/// Where a walk ends.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Arrival<const N: usize> {
    /// In this simplex, closed: the sides of the target at the facets opposite to the corners, none of them
    /// negative.
    Inside(u32, [Sign; N]),
    /// At the hull: the target lies strictly beyond the facet of this simplex opposite to this corner.
    Outside(u32, usize),
}

impl<const N: usize> Arrival<N> {
    /// The last simplex.
    pub(crate) fn simplex(&self) -> u32 {
        let (Arrival::Inside(simplex, _) | Arrival::Outside(simplex, _)) = *self;
        simplex
    }
}

/// Walks from simplex `start`, or from the last one if there are fewer, to the simplex that contains a
/// target. `None` if there are no simplices or the target is not finite.
#[inline]
pub(crate) fn walk<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    start: u32,
    target: [f64; D],
    predicates: &mut M::Predicates,
) -> Option<Arrival<N>> {
    let start = first(mesh, start, target)?;
    walk_steps(mesh, start, target, usize::MAX, predicates).ok()
}

/// Where a walk to this target may begin.
fn first<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    start: u32,
    target: [f64; D],
) -> Option<u32> {
    let last = mesh.simplices_len().checked_sub(1)? as u32;
    is_finite(&target).then_some(start.min(last))
}

/// Walks from a simplex that is there, at most so many steps.
///
/// # Errors
/// The simplex where it is after as many steps as are allowed.
#[inline]
fn walk_steps<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    start: u32,
    target: [f64; D],
    steps_max: usize,
    predicates: &mut M::Predicates,
) -> Result<Arrival<N>, u32> {
    let mut simplex = start;
    let mut before = None;
    'simplices: for _ in 0..steps_max {
        let mut sides = [Sign::Positive; N];
        for (corner, side) in sides.iter_mut().enumerate() {
            let across = mesh.across(simplex, corner);
            // The target is on this side of the facet that the walk came through.
            if across.is_some() && across == before {
                continue;
            }
            *side = mesh.side(simplex, corner, target, predicates);
            if *side == Sign::Negative {
                let Some(next) = across else { return Ok(Arrival::Outside(simplex, corner)) };
                before = Some(simplex);
                simplex = next;
                continue 'simplices;
            }
        }
        return Ok(Arrival::Inside(simplex, sides));
    }
    Err(simplex)
}

/// Walks to a target from simplex `near`; if that is a long way, from the one that `far` gives, too: in
/// turns, as either may be the longer way, such as around a vertex of many simplices. `None` as of [`walk`].
pub(crate) fn walk_from_either<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    near: u32,
    far: impl FnOnce() -> Option<u32>,
    target: [f64; D],
    predicates: &mut M::Predicates,
) -> Option<Arrival<N>> {
    let near = first(mesh, near, target)?;
    let after = match walk_steps(mesh, near, target, STEPS_TO_NEXT, predicates) {
        Ok(arrival) => return Some(arrival),
        Err(after) => after,
    };
    let Some(far) = far() else { return walk(mesh, after, target, predicates) };
    let mut ways = [first(mesh, far, target)?, after];
    let mut steps = STEPS_TO_NEXT;
    loop {
        for simplex in &mut ways {
            match walk_steps(mesh, *simplex, target, steps, predicates) {
                Ok(arrival) => return Some(arrival),
                Err(after) => *simplex = after,
            }
        }
        steps *= 2;
    }
}

/// Walks from target to target. Where it arrives does not depend on the targets before, but for the choice
/// among simplices that all contain a target.
#[derive(Debug)]
pub(crate) struct Walker<'m, M: Walkable<D, N>, const D: usize, const N: usize> {
    pub(crate) mesh: &'m M,
    pub(crate) predicates: M::Predicates,
    last: u32,
    /// How many targets are to be jumped to at once, without a walk from the last one.
    jumps: u32,
    /// How many there were after the last walk that was too long.
    jumps_before: u32,
}

impl<'m, M: Walkable<D, N>, const D: usize, const N: usize> Walker<'m, M, D, N> {
    pub(crate) fn new(mesh: &'m M) -> Self {
        Walker { mesh, predicates: M::Predicates::default(), last: 0, jumps: 0, jumps_before: 0 }
    }

    /// Walks to a target, from the last one if it is near. `None` as of [`walk`].
    pub(crate) fn walk(&mut self, target: [f64; D]) -> Option<Arrival<N>> {
        let (mesh, last, is_jump) = (self.mesh, self.last, self.jumps > 0);
        let near = if is_jump { mesh.start_near(target) } else { last };
        let mut is_long = false;
        let far = || {
            is_long = true;
            Some(if is_jump { last } else { mesh.start_near(target) })
        };
        let arrival = walk_from_either(mesh, near, far, target, &mut self.predicates)?;
        if is_jump {
            self.jumps -= 1;
        } else {
            // Each walk that is too long doubles the number of targets without one, since its steps are lost.
            self.jumps_before = if is_long { (2 * self.jumps_before + 1).min(JUMPS_MAX) } else { 0 };
            self.jumps = self.jumps_before;
        }
        self.last = arrival.simplex();
        Some(arrival)
    }

    /// On which side of a facet of a simplex the target lies, as of [`Walkable::side`].
    pub(crate) fn side(&mut self, simplex: u32, corner: usize, target: [f64; D]) -> Sign {
        self.mesh.side(simplex, corner, target, &mut self.predicates)
    }

    /// The least of the simplices that contain the target, of which this one is found.
    pub(crate) fn least(&mut self, found: u32, sides: [Sign; N], target: [f64; D]) -> u32 {
        least(self.mesh, found, sides, target, &mut self.predicates)
    }
}

/// The least of the simplices that contain a target in common, one of which a walk has found.
fn least<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    found: u32,
    sides: [Sign; N],
    target: [f64; D],
    predicates: &mut M::Predicates,
) -> u32 {
    if !sides.contains(&Sign::Zero) {
        return found;
    }
    let (mut left, mut seen): (_, HashSet<u32>) = (vec![found], [found].into_iter().collect());
    while let Some(simplex) = left.pop() {
        for corner in 0..N {
            if mesh.side(simplex, corner, target, predicates) == Sign::Zero
                && let Some(other) = mesh.across(simplex, corner)
                && seen.insert(other)
            {
                left.push(other);
            }
        }
    }
    seen.into_iter().min().unwrap_or(found)
}

/// For each target the least simplex that contains it, its border included, or `none`: outside, or not
/// finite.
pub(crate) fn find_all<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    targets: &[[f64; D]],
    threads: NonZeroUsize,
    none: u32,
) -> Vec<u32> {
    let mut found = vec![none; targets.len()];
    let begin = || (0, M::Predicates::default());
    batch::answer(threads, targets, &mut found, 1, begin, |(start, predicates), target, found| {
        let Some(arrival) = walk(mesh, *start, target, predicates) else { return };
        *start = arrival.simplex();
        if let Arrival::Inside(simplex, sides) = arrival {
            found[0] = least(mesh, simplex, sides, target, predicates);
        }
    });
    found
}
