//! Starts of walks, found among few samples.

/// Items that are looked at in each round.
const PER_ROUND: usize = 32;
/// A round looks at this part of the range before: the samples of a range are half of it apart, at most.
const SHRINKING: usize = 16;

/// The number of an item near a target, of `count` items that follow a curve through space, about. `distance`
/// is that of an item; it may be rounded.
///
/// The range of numbers shrinks around the nearest sample. If the items are in no order at all, these are
/// random samples, and the nearest of k among n has about n / k items nearer to the target.
///
/// Cost: O(log count) samples.
pub(crate) fn nearest_of_samples(count: usize, mut distance: impl FnMut(usize) -> f64) -> usize {
    let (mut nearest, mut least) = (0, f64::INFINITY);
    let mut reach = count;
    let mut range = 0..count;
    while !range.is_empty() {
        let step = (range.len() / PER_ROUND).max(1);
        for item in range.step_by(step) {
            let distance = distance(item);
            if distance < least {
                (nearest, least) = (item, distance);
            }
        }
        reach /= SHRINKING;
        range = if step == 1 { 0..0 } else { nearest.saturating_sub(reach)..count.min(nearest + reach) };
    }
    nearest
}
