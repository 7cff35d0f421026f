//! The canonical order of cells: finite ones first, each kind by vertices.

use std::num::NonZeroUsize;
use std::ops::Range;

use spmesh_delaunay::order::sizes_to_starts;
use spmesh_delaunay::parallel::for_each;
use spmesh_stream::model::cells4::Lists4;

/// Pieces per thread: the last to end is then little behind the others.
const PIECES: usize = 4;

/// Classes of one kind, finite or infinite, in canonical order of their cells.
///
/// Cells are put into groups by their first vertex. Within a group, keys of the next three vertices decide
/// all but few comparisons; every cell has at least four vertices.
pub(super) fn canonical(vertices: &Lists4, classes: &[Range<usize>], threads: NonZeroUsize) -> Vec<u32> {
    let (ends, mut keys) = grouped(vertices, classes);
    sort(&mut keys, &ends, vertices, threads);
    keys.into_iter().map(class_of).collect()
}

/// Keys of classes, group by group, and the end of each group.
fn grouped(vertices: &Lists4, classes: &[Range<usize>]) -> (Vec<u32>, Vec<u128>) {
    let first = |class: usize| vertices.get(class)[0] as usize;
    let all = || classes.iter().cloned().flatten();
    let greatest = all().map(first).max().unwrap_or_default();
    let mut ends = vec![0; greatest + 1];
    all().for_each(|class| ends[first(class)] += 1);
    sizes_to_starts(&mut ends);
    let mut keys = vec![0; classes.iter().map(Range::len).sum()];
    for class in all() {
        let &[a, b, c, d, ..] = vertices.get(class) else { unreachable!("cells have four vertices or more") };
        let end = &mut ends[a as usize];
        keys[*end as usize] =
            [b, c, d, class as u32].iter().fold(0, |key, &word| key << 32 | u128::from(word));
        *end += 1;
    }
    (ends, keys)
}

/// Sorts the keys of each group; each thread takes pieces of whole groups.
fn sort(keys: &mut [u128], ends: &[u32], vertices: &Lists4, threads: NonZeroUsize) {
    let piece = keys.len() / (PIECES * threads.get()) + 1;
    let mut pieces = Vec::new();
    let (mut rest, mut start) = (keys, 0);
    for groups in ends.chunk_by(|&end, &next| end as usize / piece == next as usize / piece) {
        let end = groups[groups.len() - 1];
        let (keys, others) = rest.split_at_mut((end - start) as usize);
        pieces.push((keys, start, groups));
        (rest, start) = (others, end);
    }
    for_each(threads, pieces, |(keys, start, ends)| sort_groups(keys, start, ends, vertices));
}

/// Sorts groups of keys whose first is the one of number `start`.
fn sort_groups(mut keys: &mut [u128], mut start: u32, ends: &[u32], vertices: &Lists4) {
    for &end in ends {
        let (group, rest) = keys.split_at_mut((end - start) as usize);
        (keys, start) = (rest, end);
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

/// Sorts distinct numbers below 2^31, the faster the fewer there are.
#[inline(always)]
pub fn sort_distinct(numbers: &mut [u32]) {
    match numbers.len() {
        0..=8 => by_ranks::<8>(numbers),
        9..=16 => by_ranks::<16>(numbers),
        _ => numbers.sort_unstable(),
    }
}

/// Moves each number to the place that is the count of lesser ones, in up to `N` numbers; `N` is a power of
/// two.
#[inline(always)]
fn by_ranks<const N: usize>(numbers: &mut [u32]) {
    let mut padded = [i32::MAX; N];
    for (place, &number) in padded.iter_mut().zip(&*numbers) {
        *place = number as i32;
    }
    let mut ranks = [0; N];
    for other in padded {
        for (rank, number) in ranks.iter_mut().zip(padded) {
            *rank += i32::from(other < number);
        }
    }
    let mut sorted = [0; N];
    for (&number, rank) in numbers.iter().zip(ranks) {
        sorted[rank as usize & (N - 1)] = number;
    }
    numbers.copy_from_slice(&sorted[..numbers.len()]);
}
