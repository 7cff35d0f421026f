//! Whole meshes by hand: each kind of fault is found and named.

use spmesh_audit::{Audit, Check, PointSet, Standard};
use spmesh_base::error::ErrorKind;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, StreamWriter, Totals};

use super::reference::Random;
use super::{Mesh, Verdict, assert_violates, audit, grid, mesh_header, point};

const CANONICAL: Standard = Standard::Canonical;

/// A quadrilateral whose Delaunay diagonal is 1 to 3.
const KITE: [[i32; 2]; 4] = [[0, 0], [10, 0], [11, 11], [0, 10]];

fn square_grid(side: i32) -> Vec<[i32; 2]> {
    (0..side * side).map(|i| [i % side, i / side]).collect()
}

#[test]
fn correct_meshes_pass() {
    for (len, side) in [(3, 30), (4, 2), (9, 3), (12, 5), (20, 100), (25, 6)] {
        let points = Random::new(len as u64).distinct_points(len, side);
        let mut mesh = Mesh::canonical(&points);
        for patch_len in [1, 2, 100] {
            mesh.patch_len = patch_len;
            mesh.audit(CANONICAL).unwrap();
            mesh.audit_with(&points).unwrap();
        }
        mesh.merged = 3;
        mesh.audit(Standard::Delaunay).unwrap();
    }
}

#[test]
fn degenerate_inputs_need_no_triangles() {
    Mesh::new(&[], &[]).audit(CANONICAL).unwrap();
    Mesh::new(&[[5, 5]], &[]).audit(CANONICAL).unwrap();
    Mesh::new(&[[5, 5], [7, 1]], &[]).audit(CANONICAL).unwrap();
    Mesh::new(&[[0, 0], [9, 3], [3, 1], [-3, -1]], &[]).audit(CANONICAL).unwrap();
}

#[test]
fn points_off_a_line_need_triangles() {
    let mesh = Mesh::new(&[[0, 0], [4, 2], [2, 1], [3, 1]], &[]);
    assert_violates(mesh.audit(CANONICAL), Check::Hull, &[0, 3, 1]);
}

#[test]
fn coincident_vertices_without_triangles() {
    let mesh = Mesh::new(&[[0, 0], [4, 2], [0, 0]], &[]);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[0, 2]);
}

#[test]
fn flipped_triangle() {
    let mesh = Mesh::new(&KITE, &[[0, 1, 3], [1, 3, 2]]);
    let violation = assert_violates(mesh.audit(CANONICAL), Check::Orientation, &[1, 3, 2]);
    let message = violation.to_error(&mesh_header()).to_string();
    assert!(
        message.contains("(1, 3, 2) is clockwise: 1 at (1000.1, 2000), 3 at (1000, 2000.1)"),
        "{message}"
    );
}

#[test]
fn flat_triangle() {
    let mesh = Mesh::new(&[[0, 0], [5, 0], [9, 0], [0, 9]], &[[0, 2, 3], [0, 1, 2]]);
    assert_violates(mesh.audit(CANONICAL), Check::Orientation, &[0, 1, 2]);
}

#[test]
fn overlapping_triangles_on_one_edge() {
    let mesh = Mesh::new(&[[0, 0], [10, 0], [5, 5], [6, 9]], &[[0, 1, 2], [0, 1, 3]]);
    assert_violates(mesh.audit(CANONICAL), Check::Edges, &[0, 1, 2, 3]);
}

#[test]
fn hole_in_the_middle() {
    let mut mesh = Mesh::canonical(&square_grid(5));
    let inner = |&v: &usize| (1..4).contains(&(v % 5)) && (1..4).contains(&(v / 5));
    let hole = mesh.triangles.iter().position(|t| t.iter().all(inner)).unwrap();
    let lost = mesh.triangles.remove(hole);
    match mesh.audit(CANONICAL) {
        Err(Verdict::Violation(violation)) => {
            assert_eq!(violation.check, Check::Hull);
            assert!(violation.vertices.iter().all(|(id, _)| lost.contains(&(id.unwrap() as usize))));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn hole_at_a_hull_vertex_is_a_bowtie() {
    let points = [[0, 0], [20, 0], [10, 20], [8, 7], [12, 7]];
    let mut mesh = Mesh::canonical(&points);
    let at = mesh.triangles.iter().position(|t| t == &[2, 3, 4]).unwrap();
    mesh.triangles.remove(at);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[2]);
}

#[test]
fn bowtie_of_two_triangles() {
    let points = [[0, 0], [0, 10], [5, 5], [10, 0], [10, 10]];
    let mesh = Mesh::new(&points, &[[0, 2, 1], [3, 4, 2]]);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[2]);
}

#[test]
fn missing_triangle_at_the_hull() {
    let points = [[0, 0], [10, 0], [5, 3], [5, 20]];
    let mesh = Mesh::new(&points, &[[1, 3, 2], [0, 2, 3]]);
    assert_violates(mesh.audit(CANONICAL), Check::Hull, &[0, 2, 1]);
}

#[test]
fn concave_hull() {
    let points = [[0, 0], [10, 0], [10, 5], [5, 5], [5, 10], [0, 10]];
    let mesh = Mesh::new(&points, &[[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]]);
    assert_violates(mesh.audit(Standard::Delaunay), Check::Hull, &[2, 3, 4]);
}

#[test]
fn collinear_vertices_on_the_hull_are_legal() {
    let points = [[0, 0], [5, 0], [10, 0], [5, 20]];
    Mesh::new(&points, &[[0, 1, 3], [1, 2, 3]]).audit(CANONICAL).unwrap();
}

#[test]
fn vertex_inside_of_a_hull_edge() {
    let points = [[0, 0], [5, 0], [10, 0], [5, 20], [5, -20]];
    let mesh = Mesh::new(&points, &[[0, 1, 3], [1, 2, 3], [0, 4, 2]]);
    assert_violates(mesh.audit(Standard::Delaunay), Check::Vertices, &[0]);
}

#[test]
fn two_components() {
    let points = [[0, 0], [5, 0], [0, 5], [20, 0], [25, 0], [20, 5]];
    let mesh = Mesh::new(&points, &[[0, 1, 2], [3, 4, 5]]);
    assert_violates(mesh.audit(CANONICAL), Check::Hull, &[3, 4]);
}

#[test]
fn the_same_mesh_twice() {
    let points = [KITE, KITE].concat();
    let mesh = Mesh::new(&points, &[[0, 1, 3], [1, 2, 3], [4, 5, 7], [5, 6, 7]]);
    assert_violates(mesh.audit(CANONICAL), Check::Hull, &[4, 5]);
}

/// Every triangle and every edge is right, but the mesh goes around its middle twice.
#[test]
fn double_cover() {
    let points = [[0, 0], [10, -6], [0, 11], [-10, -6], [10, -6], [0, 11], [-10, -6]];
    let triangles: Vec<[usize; 3]> = (0..6).map(|i| [0, i + 1, (i + 1) % 6 + 1]).collect();
    let mesh = Mesh::new(&points, &triangles);
    let violation = assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[0]);
    assert!(violation.message.contains("go around it 2 times"));
}

#[test]
fn diagonal_that_is_not_delaunay() {
    let mesh = Mesh::new(&KITE, &[[0, 1, 2], [0, 2, 3]]);
    assert_violates(mesh.audit(Standard::Delaunay), Check::Delaunay, &[0, 2, 3, 1]);
    Mesh::new(&KITE, &[[0, 1, 3], [1, 2, 3]]).audit(CANONICAL).unwrap();
}

/// The canonical diagonal of a square avoids its largest corner.
#[test]
fn diagonal_that_is_not_canonical() {
    let square = [[0, 0], [10, 0], [10, 10], [0, 10]];
    let mesh = Mesh::new(&square, &[[0, 1, 2], [0, 2, 3]]);
    assert_violates(mesh.audit(CANONICAL), Check::Canonical, &[0, 2, 3, 1]);
    mesh.audit(Standard::Delaunay).unwrap();
    Mesh::new(&square, &[[0, 1, 3], [1, 2, 3]]).audit(CANONICAL).unwrap();
}

#[test]
fn duplicate_vertex_in_two_fans() {
    let points = [[0, 0], [20, 0], [20, 20], [0, 20], [10, 9], [10, 9]];
    let mesh = Mesh::new(&points, &[[0, 1, 4], [1, 2, 4], [2, 3, 5], [3, 0, 5]]);
    assert!(matches!(mesh.audit(CANONICAL), Err(Verdict::Violation(_))));
    assert_violates(mesh.audit_with(&points), Check::Points, &[5]);
}

#[test]
fn dangling_vertex() {
    let mesh = Mesh::new(&[[0, 0], [5, 0], [0, 5], [1, 1]], &[[0, 1, 2]]);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[3]);
}

#[test]
fn finalization_too_early() {
    let mut writer = StreamWriter::new(Vec::new(), mesh_header()).unwrap();
    let first = Patch {
        first_id: 0,
        new: KITE.iter().map(point).collect(),
        imported: vec![],
        simplices: vec![0, 1, 3],
        finalized: vec![0, 3],
        ..Patch::default()
    };
    let second = Patch {
        first_id: 4,
        new: vec![],
        imported: vec![1, 2, 3],
        simplices: vec![0, 1, 2],
        finalized: vec![0, 1],
        ..Patch::default()
    };
    writer.patch(&first).unwrap();
    writer.patch(&second).unwrap();
    let stream = writer.end(4, 0).unwrap();
    let violation = assert_violates(audit(&stream, CANONICAL, None), Check::Finalization, &[]);
    assert!(violation.message.contains("vertex 3 "));
}

#[test]
fn vertex_that_is_not_finalized_is_malformed() {
    let mut writer = StreamWriter::new(Vec::new(), mesh_header()).unwrap();
    let new = KITE[..3].iter().map(point).collect();
    writer
        .patch(&Patch { new, simplices: vec![0, 1, 2], finalized: vec![0, 1], ..Patch::default() })
        .unwrap();
    let stream = writer.end(3, 0).unwrap();
    let verdict = audit(&stream, CANONICAL, None);
    assert!(matches!(&verdict, Err(Verdict::Malformed(m)) if m.contains("2 of 3 vertices")), "{verdict:?}");
}

#[test]
fn given_points_must_match() {
    let mesh = Mesh::canonical(&KITE);
    mesh.audit_with(&[&KITE[..], &KITE[..2]].concat()).unwrap();
    let more = assert_violates(mesh.audit_with(&[&KITE[..], &[[3, 3]]].concat()), Check::Points, &[]);
    assert_eq!(more.vertices, [(None, [3.0, 3.0, 0.0])]);
    assert_violates(mesh.audit_with(&KITE[..3]), Check::Points, &[3]);
}

#[test]
fn given_points_of_floats_know_one_zero() {
    let mut set = PointSet::new(Coordinates::F64, 2);
    set.extend(&[[-0.0, 0.25, 7.0], [0.0, 0.25, 8.0], [1e300, -0.0, 0.0], [-5e-324, -1.5, 0.0]]);
    let set = set.finish(&Coordinates::F64).unwrap();
    let mut writer =
        StreamWriter::new(Vec::new(), Header::new(Kind::TriangleMesh, Coordinates::F64, 2, false)).unwrap();
    let new = vec![[-5e-324, -1.5, 0.0], [1e300, 0.0, 0.0], [0.0, 0.25, 0.0]];
    writer
        .patch(&Patch { new, simplices: vec![0, 1, 2], finalized: vec![0, 1, 2], ..Patch::default() })
        .unwrap();
    audit(&writer.end(3, 0).unwrap(), CANONICAL, Some(set)).unwrap();
}

#[test]
fn given_points_of_another_encoding_cannot_be_compared() {
    let error = PointSet::new(Coordinates::F64, 2).finish(&grid()).map(|_| ()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
}

#[test]
fn moved_vertex() {
    let mut mesh = Mesh::canonical(&square_grid(4));
    mesh.points[5] = [2, 2];
    assert!(matches!(mesh.audit(CANONICAL), Err(Verdict::Violation(_))));
    mesh.points[5] = [1, 3];
    assert!(matches!(mesh.audit(CANONICAL), Err(Verdict::Violation(_))));
}

#[test]
fn bounds_must_hold_the_vertices() {
    let (new, simplices): (Vec<_>, _) = (KITE.iter().map(point).collect(), vec![0, 1, 3, 1, 2, 3]);
    let patch = Patch { new, simplices, finalized: vec![0, 1, 2, 3], ..Patch::default() };
    let end = Totals { points: 4, vertices: 4, simplices: 2, ..Totals::default() };
    for (height, holds) in [(1000.0, true), (1.0, false)] {
        let bounds = Bounds { min: [-1000.0, -1000.0, 0.0], max: [1000.0, height, 0.0] };
        let header = Header { bounds: Some(bounds), ..mesh_header() };
        let mut audit = Audit::new(&header, CANONICAL, None).unwrap();
        audit.event(&Event::Patch(patch.clone())).unwrap();
        let verdict = audit.event(&Event::End(end));
        assert_eq!(verdict.err().map(|violation| violation.check), (!holds).then_some(Check::Bounds));
    }
}

/// Coordinates at the ends of the range of i32, whose differences have 33 bits, and f64 without a grid.
#[test]
fn extreme_coordinates() {
    let (low, high) = (i32::MIN, i32::MAX);
    let square = [[low, low], [high, low], [high, high], [low, high]];
    let good = Mesh::new(&square, &[[0, 1, 3], [1, 2, 3]]).audit(CANONICAL).unwrap();
    assert!(good.lines.iter().any(|line| line.check == Check::Canonical && line.exactly == 1));
    let bad = Mesh::new(&square, &[[0, 1, 2], [0, 2, 3]]);
    assert_violates(bad.audit(CANONICAL), Check::Canonical, &[0, 2, 3, 1]);

    let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, false);
    for scale in [5e-324, 1e-160, 0.1, 1e150, 1e307] {
        let new: Vec<[f64; 3]> = square
            .iter()
            .map(|p| [0, 1].map(|i| f64::from(p[i].signum()) * scale))
            .map(|[x, y]| [x, y, 0.0])
            .collect();
        let mut writer = StreamWriter::new(Vec::new(), header.clone()).unwrap();
        let (simplices, finalized) = (vec![0, 1, 3, 1, 2, 3], vec![0, 1, 2, 3]);
        writer.patch(&Patch { new, simplices, finalized, ..Patch::default() }).unwrap();
        audit(&writer.end(4, 0).unwrap(), CANONICAL, None).unwrap();
    }
}

/// Auditing a long strip that is written row by row takes only the memory of a row.
#[test]
fn memory_is_the_width_of_the_stream() {
    let (rows, columns) = (200, 8);
    let mut writer = StreamWriter::new(Vec::new(), mesh_header()).unwrap();
    for row in 0..rows {
        let first_id = row * columns;
        let new = (0..columns).map(|x| [x as f64, row as f64, 0.0]).collect();
        let imported: Vec<u64> = if row == 0 { vec![] } else { (first_id - columns..first_id).collect() };
        let mut simplices = Vec::new();
        let (above, below) = (|x: u64| x as u32, |x: u64| (columns + x) as u32);
        for x in (0..columns - 1).filter(|_| row > 0) {
            simplices.extend([below(x), below(x + 1), above(x), below(x + 1), above(x + 1), above(x)]);
        }
        let mut finalized: Vec<u32> = if row == 0 { vec![] } else { (0..columns).map(below).collect() };
        if row + 1 == rows {
            finalized.splice(0..0, (0..columns).map(above));
        }
        writer.patch(&Patch { first_id, new, imported, simplices, finalized, ..Patch::default() }).unwrap();
    }
    let report = audit(&writer.end(rows * columns, 0).unwrap(), CANONICAL, None).unwrap();
    assert_eq!(report.live_max as u64, 2 * columns);
    assert!(report.open_max as u64 <= 2 * (rows + columns));
}
