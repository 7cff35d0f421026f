//! The simplex that contains a target, found by a walk from one to the next, in the plane and in space alike.
//!
//! From a simplex the walk goes on across a side that the target is beyond. In a Delaunay triangulation, and in
//! a regular one, it meets no simplex twice (Edelsbrunner, "An acyclicity theorem for cell complexes in d
//! dimensions", 1990). All decisions are exact.

use crate::order::{Curve, SpatialOrder};
use crate::parallel;
use crate::predicates::{Extent, Sign};
use std::num::NonZeroUsize;

/// Targets that are put in order at once: with their order they fit into the second cache.
const BLOCK: usize = 1 << 20;

/// Simplices of `N` corners in `D` dimensions, with their neighbours.
pub(crate) trait Walkable<const D: usize, const N: usize>: Sync {
    /// What decides sides; made once for many targets.
    type Predicates: Default;

    /// On which side of the facet opposite to corner `corner` of a simplex the target lies: positive on that of
    /// the corner.
    fn side(&self, simplex: u32, corner: usize, target: [f64; D], predicates: &mut Self::Predicates) -> Sign;

    /// The simplex across the facet opposite to a corner; `None` at the hull.
    fn across(&self, simplex: u32, corner: usize) -> Option<u32>;
}

/// Where a walk ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End<const N: usize> {
    /// The last simplex.
    pub(crate) simplex: u32,
    /// The sides of the target at its facets, if it contains the target; else the target is outside of the
    /// hull, beyond one of them.
    pub(crate) sides: Option<[Sign; N]>,
}

/// Walks from `start` to a simplex that contains a target with finite coordinates.
#[inline]
pub(crate) fn walk<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    start: u32,
    target: [f64; D],
    predicates: &mut M::Predicates,
) -> End<N> {
    let mut simplex = start;
    let mut before = None;
    'simplices: loop {
        let mut sides = [Sign::Positive; N];
        for (corner, side) in sides.iter_mut().enumerate() {
            let across = mesh.across(simplex, corner);
            // The target is on this side of the facet that the walk came through.
            if across.is_some() && across == before {
                continue;
            }
            *side = mesh.side(simplex, corner, target, predicates);
            if *side == Sign::Negative {
                let Some(next) = across else { return End { simplex, sides: None } };
                before = Some(simplex);
                simplex = next;
                continue 'simplices;
            }
        }
        return End { simplex, sides: Some(sides) };
    }
}

/// The least of the simplices that contain a target in common, one of which a walk has found.
pub(crate) fn least<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    found: u32,
    sides: [Sign; N],
    target: [f64; D],
    predicates: &mut M::Predicates,
) -> u32 {
    if !sides.contains(&Sign::Zero) {
        return found;
    }
    let mut all = vec![found];
    let mut place = 0;
    while let Some(&simplex) = all.get(place) {
        place += 1;
        for corner in 0..N {
            if mesh.side(simplex, corner, target, predicates) == Sign::Zero
                && let Some(other) = mesh.across(simplex, corner)
                && !all.contains(&other)
            {
                all.push(other);
            }
        }
    }
    all.into_iter().min().unwrap_or(found)
}

/// For each target the least simplex that contains it, its border included, or `none`: outside, or not finite.
pub(crate) fn find_all<const D: usize, const N: usize, M: Walkable<D, N>>(
    mesh: &M,
    targets: &[[f64; D]],
    threads: NonZeroUsize,
    none: u32,
) -> Vec<u32> {
    let mut found = vec![none; targets.len()];
    let begin = || (0, M::Predicates::default());
    in_order(threads, targets, &mut found, begin, |(start, predicates), target| {
        let end = walk(mesh, *start, target, predicates);
        *start = end.simplex;
        end.sides.map_or(none, |sides| least(mesh, end.simplex, sides, target, predicates))
    });
    found
}

/// Asks for each target, in an order in which the next one is near, and writes the answers to the places of the
/// targets. Those of targets that are not finite stay as they are. What `begin` makes goes from target to target,
/// in blocks; an answer must not depend on it.
pub(crate) fn in_order<const D: usize, A: Send, S>(
    threads: NonZeroUsize,
    targets: &[[f64; D]],
    answers: &mut [A],
    begin: impl Fn() -> S + Sync,
    ask: impl Fn(&mut S, [f64; D]) -> A + Sync,
) {
    let blocks = targets.chunks(BLOCK).zip(answers.chunks_mut(BLOCK));
    parallel::for_each(threads, blocks, |(targets, answers)| {
        let is_finite = |target: &[f64; D]| target.iter().all(|coordinate| coordinate.is_finite());
        // What is not finite has no place in an order: it takes that of the origin.
        let finite: Vec<[f64; D]> =
            targets.iter().map(|target| if is_finite(target) { *target } else { [0.0; D] }).collect();
        let mut order = SpatialOrder::default();
        let mut state = begin();
        for index in order.sort(&finite, &Extent::of(&finite), Curve::Hilbert) {
            let target = targets[index as usize];
            if is_finite(&target) {
                answers[index as usize] = ask(&mut state, target);
            }
        }
    });
}
