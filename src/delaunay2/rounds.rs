//! In which order points are inserted.

/// Every `1 << shift`-th point along the curve is inserted in the round of that shift, unless it is in already.
///
/// Each round spreads over the whole set and makes an eighth of the next, so that a point finds small triangles around
/// it, as in a random order; within a round the next point is near.
const SHIFTS: [u32; 4] = [9, 6, 3, 0];

/// Fills `sequence` with the numbers from 1 to `count`, which are in order along the curve, in the order of insertion.
pub(super) fn fill(sequence: &mut Vec<u32>, count: usize) {
    sequence.clear();
    sequence.reserve_exact(count);
    let count = count as u32;
    let mut inserted = u32::MAX;
    for shift in SHIFTS {
        let members = (0..count).step_by(1 << shift);
        sequence.extend(members.filter(|i| inserted == u32::MAX || i & inserted != 0).map(|i| i + 1));
        inserted = (1 << shift) - 1;
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_number_comes_once() {
        for count in [0, 1, 2, 8, 9, 511, 512, 513, 5000] {
            let mut sequence = vec![7; 3];
            super::fill(&mut sequence, count);
            sequence.sort_unstable();
            assert!(sequence.into_iter().eq(1..=count as u32));
        }
    }
}
