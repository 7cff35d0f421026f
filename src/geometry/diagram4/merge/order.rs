//! The canonical order of cells: finite ones first, each kind by vertices.

use crate::order::sizes_to_starts;
use spmesh_model::cells4::Lists4;

/// The classes in canonical order of their cells. The first ones are finite.
///
/// Cells are put into groups by their kind and first vertex. Within a group, keys of the next three vertices
/// decide all but few comparisons; every cell has at least four vertices.
pub(super) fn canonical(vertices: &Lists4, finite: usize) -> Vec<u32> {
    let (finite_ends, mut keys) = grouped(vertices, 0..finite);
    sort(&mut keys, &finite_ends, vertices);
    let mut order: Vec<u32> = keys.into_iter().map(class_of).collect();
    let (infinite_ends, mut keys) = grouped(vertices, finite..vertices.len());
    sort(&mut keys, &infinite_ends, vertices);
    order.extend(keys.into_iter().map(class_of));
    order
}

/// Keys of a range of classes, group by group, and the end of each group.
fn grouped(vertices: &Lists4, classes: std::ops::Range<usize>) -> (Vec<u32>, Vec<u128>) {
    let first = |class: usize| vertices.get(class)[0] as usize;
    let greatest = classes.clone().map(first).max().unwrap_or_default();
    let mut ends = vec![0; greatest + 1];
    classes.clone().for_each(|class| ends[first(class)] += 1);
    sizes_to_starts(&mut ends);
    let mut keys = vec![0; classes.len()];
    for class in classes {
        let &[a, b, c, d, ..] = vertices.get(class) else { unreachable!("cells have four vertices or more") };
        let end = &mut ends[a as usize];
        keys[*end as usize] =
            [b, c, d, class as u32].iter().fold(0, |key, &word| key << 32 | u128::from(word));
        *end += 1;
    }
    (ends, keys)
}

/// Sorts the keys of each group.
fn sort(keys: &mut [u128], ends: &[u32], vertices: &Lists4) {
    let mut start = 0;
    for &end in ends {
        let group = &mut keys[start as usize..end as usize];
        start = end;
        group.sort_unstable();
        for equal in group.chunk_by_mut(|key, other| key >> 32 == other >> 32) {
            if equal.len() > 1 {
                equal.sort_unstable_by_key(|&key| vertices.get(class_of(key) as usize));
            }
        }
    }
}

/// The class in the low bits of a key.
fn class_of(key: u128) -> u32 {
    key as u32
}
