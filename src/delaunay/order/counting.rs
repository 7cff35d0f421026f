//! The step that all counting sorts share.

use std::ops::AddAssign;

/// Replaces the size of each group by the place where the group starts, if the groups follow each other.
#[inline]
pub fn sizes_to_starts<T: Copy + Default + AddAssign>(groups: &mut [T]) {
    let mut next = T::default();
    for group in groups {
        next += std::mem::replace(group, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_start_where_the_ones_before_end() {
        let mut groups = [3u32, 0, 2, 1];
        sizes_to_starts(&mut groups);
        assert_eq!(groups, [0, 3, 3, 5]);
    }
}
