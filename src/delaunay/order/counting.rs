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
