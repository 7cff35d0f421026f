//! Groups that grow together: disjoint sets.

/// The root of a tree of groups; halves the way.
pub(super) fn root(group: &mut [usize], mut at: usize) -> usize {
    while group[at] != at {
        group[at] = group[group[at]];
        at = group[at];
    }
    at
}
