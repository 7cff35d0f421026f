//! Questions about many targets, in an order in which the next target is near.

use crate::order::{Curve, SpatialOrder};
use crate::parallel;
use crate::points::is_finite;
use crate::predicates::Extent;
use std::num::NonZeroUsize;

/// Targets that are put in order at once. More are denser, so that the way from one to the next is shorter;
/// their order takes 16 bytes each.
const BLOCK_MAX: usize = 1 << 20;

/// Fewer are not worth a thread.
const BLOCK_MIN: usize = 1 << 13;

/// Lets `ask` write the answer about each target, `width` items of `answers` that are in the order of the
/// targets. Answers about targets that are not finite stay as they are.
///
/// The targets are asked for along a curve, in blocks, on so many threads. What `begin` makes goes from
/// target to target in a block, such as an interpolator that walks from the last target; an answer must not
/// depend on it.
///
/// Cost: a sort of the targets. Memory: 32 to 40 bytes for each target of a block, for each thread.
///
/// # Panics
/// If there are more or fewer than `width` answers for a target.
///
/// ```
/// use spmesh_delaunay::batch;
/// use spmesh_delaunay::delaunay2::{interpolation::Linear, triangulate};
///
/// let mesh = triangulate(&[[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])?;
/// let (values, targets) = ([0.0, 4.0, 8.0], [[1.0, 1.0], [9.0, 9.0], [0.0, 2.0]]);
/// let mut found = [f64::NAN; 3];
/// let two = std::num::NonZeroUsize::new(2).unwrap();
/// batch::answer(two, &targets, &mut found, 1, || Linear::new(&mesh), |linear, target, found| {
///     found[0] = linear.interpolate(&values, target).unwrap_or(f64::NAN);
/// });
/// assert_eq!((found[0], found[1].is_nan(), found[2]), (3.0, true, 4.0));
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
pub fn answer<const D: usize, A: Send, S>(
    threads: NonZeroUsize,
    targets: &[[f64; D]],
    answers: &mut [A],
    width: usize,
    begin: impl Fn() -> S + Sync,
    ask: impl Fn(&mut S, [f64; D], &mut [A]) + Sync,
) {
    assert_eq!(answers.len(), width * targets.len(), "answers for all targets");
    if width == 0 {
        return;
    }
    let block = targets.len().div_ceil(threads.get()).clamp(BLOCK_MIN, BLOCK_MAX);
    let blocks = targets.chunks(block).zip(answers.chunks_mut(block * width));
    parallel::for_each(threads, blocks, |(targets, answers)| {
        // What is not finite has no place in an order: it takes that of the origin.
        let finite: Vec<[f64; D]> =
            targets.iter().map(|target| if is_finite(target) { *target } else { [0.0; D] }).collect();
        let mut order = SpatialOrder::default();
        let mut state = begin();
        for index in order.sort(&finite, &Extent::of(&finite), Curve::Hilbert) {
            let place = index as usize;
            if is_finite(&targets[place]) {
                ask(&mut state, targets[place], &mut answers[place * width..][..width]);
            }
        }
    });
}
