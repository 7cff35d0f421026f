//! Triangles with last-use flags, as the historical mesh formats store them.

use spmesh_stream::Patch;

/// A corner of a triangle: the vertex, and whether the triangle is the last that uses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Corner {
    pub(crate) id: u64,
    pub(crate) is_final: bool,
}

/// The triangles of a patch with their final corners, and the vertices that it finalizes but that no triangle
/// uses.
pub(crate) fn final_corners(patch: &Patch) -> (Vec<[Corner; 3]>, Vec<u64>) {
    let mut ends = vec![false; patch.vertices()];
    patch.finalized.iter().for_each(|&local| ends[local as usize] = true);
    let mut triangles: Vec<[Corner; 3]> = Vec::with_capacity(patch.simplices.len() / 3);
    for simplex in patch.simplices.rchunks_exact(3) {
        let corner = |local: u32| {
            let is_final = std::mem::take(&mut ends[local as usize]);
            Corner { id: patch.id(local), is_final }
        };
        let corners: Vec<Corner> = simplex.iter().copied().map(corner).collect();
        triangles.push([corners[0], corners[1], corners[2]]);
    }
    triangles.reverse();
    let unused = patch.finalized.iter().filter(|&&local| ends[local as usize]);
    (triangles, unused.map(|&local| patch.id(local)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_use_in_the_patch_is_final() {
        let patch = Patch {
            first_id: 10,
            new: vec![[0.0; 3]; 3],
            imported: vec![4],
            simplices: vec![0, 1, 2, 2, 1, 3],
            finalized: vec![0, 1, 3],
            ..Patch::default()
        };
        let (triangles, unused) = final_corners(&patch);
        let flags: Vec<_> = triangles.iter().map(|t| t.map(|corner| (corner.id, corner.is_final))).collect();
        assert_eq!(flags[0], [(10, true), (11, false), (12, false)]);
        assert_eq!(flags[1], [(12, false), (11, true), (4, true)]);
        assert!(unused.is_empty());
    }
}
