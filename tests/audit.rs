//! The audit: it passes correct streams and names the fault of every wrong one.

#[path = "audit/census.rs"]
mod census;
#[path = "audit/command.rs"]
mod command;
#[path = "audit/configurations.rs"]
mod configurations;
#[path = "audit/constrained.rs"]
mod constrained;
#[path = "audit/constrained_mesh.rs"]
pub mod constrained_mesh;
#[path = "audit/diagram.rs"]
pub mod diagram;
#[path = "audit/diagram_damage.rs"]
mod diagram_damage;
#[path = "audit/exhaustive.rs"]
mod exhaustive;
#[path = "audit/held.rs"]
pub mod held;
#[path = "audit/knots.rs"]
mod knots;
#[path = "audit/mesh.rs"]
mod mesh;
#[path = "audit/mutations.rs"]
mod mutations;
#[path = "audit/partial.rs"]
mod partial;
#[path = "audit/points.rs"]
mod points;
#[path = "audit/reference.rs"]
mod reference;
#[path = "audit/solid.rs"]
mod solid;
#[path = "audit/streamed.rs"]
mod streamed;
#[path = "audit/streamed_damage.rs"]
mod streamed_damage;
#[path = "audit/tetrahedra.rs"]
mod tetrahedra;
#[path = "audit/tetrahedra_mutations.rs"]
mod tetrahedra_mutations;
#[path = "audit/tetrahedra_streams.rs"]
mod tetrahedra_streams;
#[path = "audit/tetrahedralized.rs"]
mod tetrahedralized;
#[path = "audit/winding.rs"]
mod winding;

use spmesh_audit::{Audit, Given, PointSet, Report, Standard, Violation};
use spmesh_base::error::ErrorKind;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Header, Kind, Patch, StreamReader, StreamWriter};

/// Audits a whole stream. A malformed stream gives the reader's message instead of a violation.
fn audit(stream: &[u8], standard: Standard, given: Option<PointSet>) -> Result<Report, Verdict> {
    let mut reader = StreamReader::new(stream, "test").map_err(|e| Verdict::Malformed(e.to_string()))?;
    let header = reader.header().clone();
    let mut audit = Audit::new(&header, standard, given.map(Given::All)).unwrap();
    while let Some(event) = reader.next_event().map_err(|e| Verdict::Malformed(e.to_string()))? {
        if let Err(violation) = audit.event(&event) {
            let error = violation.to_error(&header);
            assert_eq!(error.kind(), ErrorKind::Audit);
            assert!(audit.report().violation.is_some());
            assert!(audit.report().lines.iter().any(|line| !line.passed), "{error}");
            return Err(Verdict::Violation(violation));
        }
    }
    assert!(audit.report().lines.iter().all(|line| line.passed));
    Ok(audit.report())
}

/// Why a stream was refused.
#[derive(Debug)]
enum Verdict {
    /// The reader's message.
    Malformed(String),
    Violation(Violation),
}

/// A mesh to be written as a stream: vertex `i` gets the id `i`.
#[derive(Debug, Clone)]
struct Mesh {
    points: Vec<[i32; 2]>,
    triangles: Vec<[usize; 3]>,
    /// Triangles per patch.
    patch_len: usize,
    merged: u64,
}

impl Mesh {
    fn new(points: &[[i32; 2]], triangles: &[[usize; 3]]) -> Self {
        Mesh { points: points.to_vec(), triangles: triangles.to_vec(), patch_len: 2, merged: 0 }
    }

    /// The canonical triangulation, found by trying every triangle.
    fn canonical(points: &[[i32; 2]]) -> Self {
        Mesh::new(points, &reference::canonical_triangulation(points))
    }

    /// All vertices come with the first patch, and each is finalized with its last triangle.
    fn stream(&self) -> Vec<u8> {
        let mut writer = StreamWriter::new(Vec::new(), mesh_header()).unwrap();
        let mut patches: Vec<&[[usize; 3]]> = self.triangles.chunks(self.patch_len).collect();
        if patches.is_empty() {
            patches.push(&[]);
        }
        let last_use = |vertex: usize| {
            let uses = |patch: &&[[usize; 3]]| patch.iter().flatten().any(|&v| v == vertex);
            patches.iter().rposition(uses).unwrap_or(0)
        };
        for (i, triangles) in patches.iter().enumerate() {
            let mut used: Vec<usize> =
                if i == 0 { (0..self.points.len()).collect() } else { triangles.concat() };
            used.sort_unstable();
            used.dedup();
            let local = |vertex: &usize| used.binary_search(vertex).unwrap() as u32;
            writer
                .patch(&Patch {
                    first_id: if i == 0 { 0 } else { self.points.len() as u64 },
                    new: if i == 0 { self.points.iter().map(point).collect() } else { Vec::new() },
                    imported: if i == 0 { Vec::new() } else { used.iter().map(|&v| v as u64).collect() },
                    simplices: triangles.iter().flatten().map(local).collect(),
                    finalized: used.iter().filter(|&&v| last_use(v) == i).map(local).collect(),
                    ..Patch::default()
                })
                .unwrap();
        }
        writer.end(self.points.len() as u64 + self.merged, self.merged).unwrap()
    }

    fn audit(&self, standard: Standard) -> Result<Report, Verdict> {
        audit(&self.stream(), standard, None)
    }

    /// Audits against a set of points.
    fn audit_with(&self, points: &[[i32; 2]]) -> Result<Report, Verdict> {
        audit(&self.stream(), Standard::Canonical, Some(given(points)))
    }
}

fn given(points: &[[i32; 2]]) -> PointSet {
    let mut set = PointSet::new(grid(), 2);
    set.extend(&points.iter().map(point).collect::<Vec<_>>());
    set.finish(&grid()).unwrap()
}

fn mesh_header() -> Header {
    Header::new(Kind::TriangleMesh, grid(), 2, false)
}

fn grid() -> Coordinates {
    Coordinates::I32 { scale: [0.01; 3], offset: [1000.0, 2000.0, 0.0] }
}

fn point(&[x, y]: &[i32; 2]) -> Point {
    [f64::from(x), f64::from(y), 0.0]
}

/// Asserts that a stream was refused by `check`, with these ids.
#[track_caller]
fn assert_violates(result: Result<Report, Verdict>, check: spmesh_audit::Check, ids: &[u64]) -> Violation {
    match result {
        Err(Verdict::Violation(violation)) => {
            let found: Vec<u64> = violation.vertices.iter().filter_map(|(id, _)| *id).collect();
            assert_eq!((violation.check, &found[..]), (check, ids), "{violation:?}");
            violation
        }
        other => panic!("expected a violation of {check:?}, found {other:?}"),
    }
}
