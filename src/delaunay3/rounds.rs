//! In which order points are inserted.

/// Every `1 << shift`-th point along the curve is inserted in the round of that shift, unless it is in already.
const SHIFTS: [u32; 4] = [9, 6, 3, 0];

/// The numbers below `count`, which are in order along the curve, in the order of insertion.
pub(super) fn strided(count: u32) -> impl Iterator<Item = u32> {
    let inserted = [u32::MAX].into_iter().chain(SHIFTS.map(|shift| (1 << shift) - 1));
    SHIFTS.into_iter().zip(inserted).flat_map(move |(shift, inserted)| {
        (0..count).step_by(1 << shift).filter(move |i| inserted == u32::MAX || i & inserted != 0)
    })
}
