//! Tetrahedral meshes to be audited, and the ways to make them.

use spmesh_audit::{PointSet, Report, Standard};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Header, Kind, Patch, StreamWriter};

use super::{Verdict, audit};
use spmesh_reference::tetrahedra;

/// Two tetrahedra on opposite sides of a triangle; the segment between their apexes crosses the triangle.
pub const BIPYRAMID: [[i32; 3]; 5] = [[0, 0, -30], [20, 0, 0], [-10, 17, 0], [-10, -17, 0], [0, 1, 31]];

/// The Delaunay tetrahedralization of `BIPYRAMID`.
pub const TWO: [[usize; 4]; 2] = [[0, 1, 2, 3], [1, 2, 3, 4]];

/// A mesh to be written as a stream: vertex `i` gets the id `i`.
#[derive(Debug, Clone)]
pub struct Solid {
    pub points: Vec<[i32; 3]>,
    pub tetrahedra: Vec<[usize; 4]>,
    /// Tetrahedra per patch.
    pub patch_len: usize,
    pub merged: u64,
    pub labels: Vec<u64>,
}

impl Solid {
    pub fn new(points: &[[i32; 3]], tetrahedra: &[[usize; 4]]) -> Self {
        let (points, tetrahedra) = (points.to_vec(), tetrahedra.to_vec());
        Solid { points, tetrahedra, patch_len: 3, merged: 0, labels: Vec::new() }
    }

    /// The canonical tetrahedralization, found by trying every tetrahedron.
    pub fn canonical(points: &[[i32; 3]]) -> Self {
        let found = tetrahedra::tetrahedra(&points.iter().map(position).collect::<Vec<_>>());
        Solid::new(points, &found.iter().map(|t| t.map(|v| v as usize)).collect::<Vec<_>>())
    }

    /// All vertices come with the first patch, and each is finalized with its last tetrahedron.
    pub fn stream(&self) -> Vec<u8> {
        let mut writer = StreamWriter::new(Vec::new(), solid_header()).unwrap();
        let mut patches: Vec<&[[usize; 4]]> = self.tetrahedra.chunks(self.patch_len).collect();
        if patches.is_empty() {
            patches.push(&[]);
        }
        let mut last_use = vec![0; self.points.len()];
        for (i, patch) in patches.iter().enumerate() {
            patch.iter().flatten().for_each(|&vertex| last_use[vertex] = i);
        }
        for (i, tetrahedra) in patches.iter().enumerate() {
            let mut used: Vec<usize> =
                if i == 0 { (0..self.points.len()).collect() } else { tetrahedra.concat() };
            used.sort_unstable();
            used.dedup();
            let local = |vertex: &usize| used.binary_search(vertex).unwrap() as u32;
            writer
                .patch(&Patch {
                    first_id: if i == 0 { 0 } else { self.points.len() as u64 },
                    new: if i == 0 { self.points.iter().map(position).collect() } else { Vec::new() },
                    imported: if i == 0 { Vec::new() } else { used.iter().map(|&v| v as u64).collect() },
                    simplices: tetrahedra.iter().flatten().map(local).collect(),
                    finalized: used.iter().filter(|&&v| last_use[v] == i).map(local).collect(),
                    ..Patch::default()
                })
                .unwrap();
        }
        if !self.labels.is_empty() {
            writer.labels(&self.labels).unwrap();
        }
        writer.end(self.points.len() as u64 + self.merged, self.merged).unwrap()
    }

    pub fn audit(&self, standard: Standard) -> Result<Report, Verdict> {
        audit(&self.stream(), standard, None)
    }

    /// Audits against a set of points.
    pub fn audit_with(&self, points: &[[i32; 3]]) -> Result<Report, Verdict> {
        audit(&self.stream(), Standard::Canonical, Some(given(points)))
    }
}

pub fn given(points: &[[i32; 3]]) -> PointSet {
    let mut set = PointSet::new(grid(), 3);
    set.extend(&points.iter().map(position).collect::<Vec<_>>());
    set.finish(&grid()).unwrap()
}

pub fn solid_header() -> Header {
    Header::new(Kind::TetrahedralMesh, grid(), 3, false)
}

pub fn grid() -> Coordinates {
    Coordinates::I32 { scale: [0.001; 3], offset: [0.0, 100.0, -5.0] }
}

pub fn position(point: &[i32; 3]) -> Point {
    point.map(f64::from)
}

/// The points of a lattice of `side * side * side`.
pub fn cubic(side: i32) -> Vec<[i32; 3]> {
    (0..side * side * side).map(|i| [i % side, i / side % side, i / side / side]).collect()
}
