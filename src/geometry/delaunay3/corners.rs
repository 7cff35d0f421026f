//! Tetrahedra without their neighbours, in order along the curve: what is left to do is to write them.
//!
//! Insertion in rounds leaves tetrahedra all over the array. Without their neighbours they need half of it only, so that
//! they can be sorted into the other half, and the first one is free for whoever writes them.

use super::tetrahedralization::{Tetrahedralization, Tetrahedron, Vertex};
use crate::order::sizes_to_starts;

/// Tetrahedra that come without order among themselves, and greatest number of such groups.
const GROUP: usize = 4096;
const GROUPS_MAX: usize = 1 << 14;

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

/// What [`Corners`] consists of.
#[derive(Debug)]
pub struct CornerParts<'c> {
    /// The vertices in order along the curve.
    pub vertices: &'c [Vertex],
    /// The corners of each tetrahedron: indices of vertices, positively oriented.
    pub tetrahedra: &'c [[u32; 4]],
    /// Memory that is not used any more, with anything in it: four words or more for each of the tetrahedra.
    pub spare: &'c mut [u32],
}

impl Tetrahedralization {
    /// The corners of the tetrahedra that `keep` wants, told by their indices; in order of their last vertex along the
    /// curve, up to some thousands that come together.
    ///
    /// Cost: two passes, and no memory.
    #[must_use]
    pub fn into_corners(self, keep: impl Fn(usize) -> bool) -> Corners {
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
        if counts.len() == 1 {
            return Corners { vertices, storage, start: 0, end: kept };
        }
        sizes_to_starts(&mut counts);
        let (unordered, ordered) = quadruples.split_at_mut(kept);
        for &corners in &*unordered {
            let place = &mut counts[group(corners, shift)];
            ordered[*place] = corners;
            *place += 1;
        }
        Corners { vertices, storage, start: kept, end: 2 * kept }
    }
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
    /// All of it.
    pub fn parts(&mut self) -> CornerParts<'_> {
        let quadruples: &mut [[u32; 4]] = bytemuck::cast_slice_mut(&mut self.storage);
        let (before, rest) = quadruples.split_at_mut(self.start);
        let (tetrahedra, behind) = rest.split_at_mut(self.end - self.start);
        let spare = if before.len() > behind.len() { before } else { behind };
        CornerParts { vertices: &self.vertices, tetrahedra, spare: spare.as_flattened_mut() }
    }
}
