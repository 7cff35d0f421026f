//! Meshes as programs write them, in the plane and in space: a vertex comes with its first simplex and is
//! finalized with its last.

use std::collections::{BTreeMap, BTreeSet};

use spmesh_audit::{Report, Standard};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Header, Patch, StreamWriter};

use super::reference::canonical_triangulation;
use super::solid::solid_header;
use super::{Verdict, audit, mesh_header};
use spmesh_reference::tetrahedra::tetrahedra;

/// Points in D dimensions, and simplices with N = D + 1 corners given as indices of points.
#[derive(Debug, Clone)]
pub struct Streamed<const D: usize, const N: usize> {
    pub points: Vec<[i32; D]>,
    pub simplices: Vec<[usize; N]>,
    /// Simplices per patch.
    pub patch_len: usize,
}

pub type Flat = Streamed<2, 3>;
pub type Solid = Streamed<3, 4>;

impl<const D: usize, const N: usize> Streamed<D, N> {
    pub fn new(points: &[[i32; D]], simplices: &[[usize; N]]) -> Self {
        Streamed { points: points.to_vec(), simplices: simplices.to_vec(), patch_len: 2 }
    }

    /// The canonical simplices of distinct points, found by trying all.
    pub fn canonical(points: &[[i32; D]]) -> Self {
        let positions: Vec<Point> = points.iter().map(position).collect();
        let widened = |found: &[usize]| std::array::from_fn(|corner| found[corner]);
        let simplices: Vec<[usize; N]> = if D == 2 {
            let plane: Vec<[i32; 2]> = points.iter().map(|point| [point[0], point[1]]).collect();
            canonical_triangulation(&plane).iter().map(|found| widened(found)).collect()
        } else {
            tetrahedra(&positions).iter().map(|found| widened(&found.map(|vertex| vertex as usize))).collect()
        };
        Streamed::new(points, &simplices)
    }

    /// Patches of `patch_len` simplices, and one patch of the vertices that no simplex uses.
    pub fn patches(&self) -> Vec<Patch> {
        let mut ids: BTreeMap<usize, u64> = BTreeMap::new();
        let chunks: Vec<&[[usize; N]]> = self.simplices.chunks(self.patch_len).collect();
        let last_use =
            |vertex: &usize| chunks.iter().rposition(|chunk| chunk.as_flattened().contains(vertex));
        let mut patches = Vec::new();
        for (i, chunk) in chunks.iter().enumerate() {
            let used: BTreeSet<usize> = chunk.as_flattened().iter().copied().collect();
            let (mut old, new): (Vec<usize>, Vec<usize>) =
                used.into_iter().partition(|vertex| ids.contains_key(vertex));
            old.sort_by_key(|vertex| ids[vertex]);
            let first_id = ids.len() as u64;
            ids.extend(new.iter().copied().zip(first_id..));
            let locals = [&new[..], &old].concat();
            let local = |vertex: &usize| locals.iter().position(|other| other == vertex).unwrap() as u32;
            patches.push(Patch {
                first_id,
                new: new.iter().map(|&vertex| position(&self.points[vertex])).collect(),
                imported: old.iter().map(|vertex| ids[vertex]).collect(),
                simplices: chunk.as_flattened().iter().map(local).collect(),
                finalized: locals.iter().filter(|vertex| last_use(vertex) == Some(i)).map(local).collect(),
                ..Patch::default()
            });
        }
        let unused = (0..self.points.len()).filter(|vertex| !ids.contains_key(vertex));
        let new: Vec<Point> = unused.map(|vertex| position(&self.points[vertex])).collect();
        if !new.is_empty() {
            let (first_id, finalized) = (ids.len() as u64, (0..new.len() as u32).collect());
            patches.push(Patch { first_id, new, finalized, ..Patch::default() });
        }
        patches
    }

    pub fn audit(&self) -> Result<Report, Verdict> {
        audit_patches::<D>(&self.patches())
    }

    /// The simplices as a sorted set: each has its corners in increasing order, up to the exchange that keeps
    /// its orientation.
    pub fn set(&self) -> Vec<[usize; N]> {
        let mut set: Vec<[usize; N]> = self.simplices.iter().map(|simplex| ordered(*simplex)).collect();
        set.sort_unstable();
        set
    }
}

/// The verdict on a stream of triangles (D = 2) or tetrahedra (D = 3).
pub fn audit_patches<const D: usize>(patches: &[Patch]) -> Result<Report, Verdict> {
    audit(&written::<D>(patches), Standard::Canonical, None)
}

fn written<const D: usize>(patches: &[Patch]) -> Vec<u8> {
    let header: Header = if D == 2 { mesh_header() } else { solid_header() };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    patches.iter().for_each(|patch| writer.patch(patch).unwrap());
    writer.end(patches.iter().map(|patch| patch.new.len() as u64).sum(), 0).unwrap()
}

fn position<const D: usize>(point: &[i32; D]) -> Point {
    std::array::from_fn(|axis| point.get(axis).map_or(0.0, |&value| f64::from(value)))
}

fn ordered<const N: usize>(mut simplex: [usize; N]) -> [usize; N] {
    let mut swaps = 0;
    for end in (1..N).rev() {
        for i in 0..end {
            if simplex[i] > simplex[i + 1] {
                simplex.swap(i, i + 1);
                swaps += 1;
            }
        }
    }
    if swaps % 2 == 1 {
        simplex.swap(N - 2, N - 1);
    }
    simplex
}
