//! Tetrahedra without their neighbours, in order along the curve, ready to be written.
//!
//! Insertion in rounds leaves tetrahedra in no useful order. Without their neighbours they need only half of
//! the array, so they are sorted into the other half; the first half is then free for the writer.

use super::tetrahedralization::{Tetrahedralization, Tetrahedron, Vertex};
use crate::error::Result;
use crate::order::sizes_to_starts;
use crate::parallel;
use std::num::NonZeroUsize;

/// Tetrahedra of a group, about, and greatest number of groups: the groups are found first, then the order in
/// each, so that memory is not accessed at random.
const GROUP: usize = 4096;
const GROUPS_MAX: usize = 1 << 14;

/// Groups that a thread sorts at a time.
const GROUPS_AT_A_TIME: usize = 64;

/// Tetrahedra as their corners, and the vertices.
#[derive(Debug)]
pub struct Corners {
    vertices: Vec<Vertex>,
    /// Holds the corners, two by two.
    storage: Vec<Tetrahedron>,
    /// Where in the storage the corners are, in quadruples.
    start: usize,
    end: usize,
}

/// The parts of [`Corners`].
#[derive(Debug)]
pub struct CornerParts<'c> {
    /// The vertices in order along the curve.
    pub vertices: &'c [Vertex],
    /// The corners of each tetrahedron: indices of vertices, positively oriented, the greatest last and of
    /// the others the least first.
    pub tetrahedra: &'c mut [[u32; 4]],
    /// Unused memory of arbitrary content: four words or more for each of the tetrahedra.
    pub spare: &'c mut [u32],
}

impl Tetrahedralization {
    /// The corners of the tetrahedra whose indices `keep` accepts, ordered by their last vertex along the
    /// curve, then by their other vertices. So they depend on the points alone, and not on the order of
    /// insertion.
    ///
    /// Cost: three passes, of which `threads` share the last, and 100 kB for each thread.
    ///
    /// # Errors
    /// Never fails: the type is that of [`parallel::map`].
    pub fn into_corners(self, keep: impl Fn(usize) -> bool, threads: NonZeroUsize) -> Result<Corners> {
        let Tetrahedralization { vertices, tetrahedra: mut storage, .. } = self;
        let shift = shift_of_groups(vertices.len(), storage.len());
        let mut counts = vec![0usize; (vertices.len() >> shift) + 1];
        let quadruples: &mut [[u32; 4]] = bytemuck::cast_slice_mut(&mut storage);
        let mut kept = 0;
        for t in 0..quadruples.len() / 2 {
            if keep(t) {
                let corners = quadruples[2 * t];
                quadruples[kept] = corners;
                counts[group(corners, shift)] += 1;
                kept += 1;
            }
        }
        sizes_to_starts(&mut counts);
        let (unordered, ordered) = quadruples.split_at_mut(kept);
        for &corners in &*unordered {
            let place = &mut counts[group(corners, shift)];
            ordered[*place] = corners;
            *place += 1;
        }
        // Now the ends of the groups.
        sort_groups(&mut ordered[..kept], &counts, shift, threads)?;
        Ok(Corners { vertices, storage, start: kept, end: 2 * kept })
    }
}

/// Sorts all groups, of which the ends are given.
fn sort_groups(
    mut tetrahedra: &mut [[u32; 4]],
    ends: &[usize],
    shift: u32,
    threads: NonZeroUsize,
) -> Result<()> {
    let (mut tasks, mut start) = (Vec::new(), 0);
    for (number, ends) in ends.chunks(GROUPS_AT_A_TIME).enumerate() {
        let end = ends[ends.len() - 1];
        let (task, rest) = std::mem::take(&mut tetrahedra).split_at_mut(end - start);
        tasks.push((task, ends, start, (number * GROUPS_AT_A_TIME) << shift));
        (tetrahedra, start) = (rest, end);
    }
    let sort = |(mut task, ends, mut start, mut vertex): (&mut [[u32; 4]], &[usize], usize, usize)| {
        let mut sorter = Sorter::default();
        for &end in ends {
            let (group, rest) = std::mem::take(&mut task).split_at_mut(end - start);
            sorter.sort(group, vertex as u32, shift);
            (task, start, vertex) = (rest, end, vertex + (1 << shift));
        }
        Ok(())
    };
    parallel::map(threads, tasks, sort).map(drop)
}

/// Buffers for the sort of one group.
#[derive(Default)]
struct Sorter {
    places: Vec<u32>,
    keys: Vec<u128>,
}

impl Sorter {
    /// Sorts tetrahedra whose last vertices are `first` and the next `1 << shift`: a counting sort by the
    /// last vertex, then a sort of the few that have it in common.
    fn sort(&mut self, group: &mut [[u32; 4]], first: u32, shift: u32) {
        self.places.clear();
        self.places.resize(1 << shift, 0);
        self.keys.clear();
        self.keys.resize(group.len(), 0);
        for corners in &mut *group {
            *corners = turned(*corners);
            self.places[(corners[3] - first) as usize] += 1;
        }
        sizes_to_starts(&mut self.places);
        for &[a, b, c, d] in &*group {
            let place = &mut self.places[(d - first) as usize];
            self.keys[*place as usize] = u128::from(a) << 64 | u128::from(b) << 32 | u128::from(c);
            *place += 1;
        }
        let mut start = 0;
        for (d, &end) in (first..).zip(&self.places) {
            let equal = start..end as usize;
            let keys = &mut self.keys[equal.clone()];
            keys.sort_unstable();
            for (corners, key) in group[equal].iter_mut().zip(keys) {
                *corners = [(*key >> 64) as u32, (*key >> 32) as u32, *key as u32, d];
            }
            start = end as usize;
        }
    }
}

/// The same tetrahedron in the same orientation, its greatest vertex last and of the others the least first.
#[inline(always)]
pub fn turned(corners: [u32; 4]) -> [u32; 4] {
    let [mut a, mut b, mut c, mut d] = corners;
    let mut is_odd = false;
    let mut order = |p: &mut u32, q: &mut u32| {
        let (less, greater) = ((*p).min(*q), (*p).max(*q));
        is_odd ^= less != *p;
        (*p, *q) = (less, greater);
    };
    order(&mut a, &mut b);
    order(&mut c, &mut d);
    order(&mut a, &mut c);
    order(&mut b, &mut d);
    order(&mut b, &mut c);
    if is_odd { [a, c, b, d] } else { [a, b, c, d] }
}

/// The group of a tetrahedron is the number of its last vertex without so many low bits.
fn shift_of_groups(vertices: usize, tetrahedra: usize) -> u32 {
    let groups = (tetrahedra / GROUP).clamp(1, GROUPS_MAX);
    (vertices / groups).max(1).ilog2() + 1
}

#[inline(always)]
fn group([a, b, c, d]: [u32; 4], shift: u32) -> usize {
    (a.max(b).max(c.max(d)) >> shift) as usize
}

impl Corners {
    /// The parts.
    pub fn parts(&mut self) -> CornerParts<'_> {
        let quadruples: &mut [[u32; 4]] = bytemuck::cast_slice_mut(&mut self.storage);
        let (before, rest) = quadruples.split_at_mut(self.start);
        let (tetrahedra, behind) = rest.split_at_mut(self.end - self.start);
        let spare = if before.len() > behind.len() { before } else { behind };
        CornerParts { vertices: &self.vertices, tetrahedra, spare: spare.as_flattened_mut() }
    }
}
