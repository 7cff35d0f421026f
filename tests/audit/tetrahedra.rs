//! Whole tetrahedral meshes by hand: each kind of fault is found and named.

use spmesh_audit::{Check, Standard};

use super::reference::Random;
use super::solid::{BIPYRAMID, Solid, TWO, cubic, solid_header};
use super::{Verdict, assert_violates};

const CANONICAL: Standard = Standard::Canonical;

fn check_of(result: Result<spmesh_audit::Report, Verdict>) -> Check {
    match result {
        Err(Verdict::Violation(violation)) => violation.check,
        other => panic!("expected a violation, found {other:?}"),
    }
}

fn distinct(seed: u64, len: usize, side: usize) -> Vec<[i32; 3]> {
    let mut random = Random::new(seed);
    let mut points: Vec<[i32; 3]> = Vec::new();
    while points.len() < len {
        let point = [0; 3].map(|_| random.below(side) as i32);
        if !points.contains(&point) {
            points.push(point);
        }
    }
    points
}

#[test]
fn correct_meshes_pass() {
    for (len, side) in [(4, 30), (5, 2), (8, 2), (9, 3), (14, 3), (14, 100), (18, 4)] {
        let points = distinct(len as u64, len, side);
        let mut mesh = Solid::canonical(&points);
        for patch_len in [1, 2, 100] {
            mesh.patch_len = patch_len;
            mesh.audit(CANONICAL).unwrap();
            mesh.audit_with(&points).unwrap();
        }
        mesh.merged = 3;
        mesh.audit(Standard::Delaunay).unwrap();
    }
    assert_eq!(Solid::canonical(&BIPYRAMID).tetrahedra.len(), 2);
    Solid::new(&BIPYRAMID, &TWO).audit(CANONICAL).unwrap();
}

#[test]
fn degenerate_inputs_need_no_tetrahedra() {
    for points in [
        &[][..],
        &[[5, 5, 5]],
        &[[5, 5, 5], [7, 1, 3]],
        &[[5, 5, 5], [7, 1, 3], [0, 0, 0]],
        &[[0, 0, 0], [9, 3, 6], [3, 1, 2], [-3, -1, -2]],
        &[[0, 0, 7], [9, 3, 7], [3, 1, 7], [2, 2, 7]],
        &[[1, 1, 1], [2, 2, 1], [3, 3, 5], [4, 4, -9], [0, 0, 0]],
    ] {
        assert!(Solid::canonical(points).tetrahedra.is_empty());
        Solid::new(points, &[]).audit_with(points).unwrap();
    }
}

#[test]
fn points_off_a_plane_need_tetrahedra() {
    let mesh = Solid::new(&[[0, 0, 0], [4, 2, 0], [2, 1, 0], [3, 1, 0], [1, 1, 1]], &[]);
    assert_violates(mesh.audit(CANONICAL), Check::Hull, &[0, 4, 1, 3]);
    let mesh = Solid::new(&[[0, 0, 0], [1, 1, 1], [2, 2, 2], [0, 1, 5], [3, 3, 3], [1, 0, 0]], &[]);
    assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Hull);
}

#[test]
fn coincident_vertices_without_tetrahedra() {
    let mesh = Solid::new(&[[0, 0, 1], [4, 2, 1], [0, 0, 1]], &[]);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[0, 2]);
}

#[test]
fn inverted_tetrahedron() {
    let mesh = Solid::new(&BIPYRAMID, &[[0, 2, 1, 3], [1, 2, 3, 4]]);
    let violation = assert_violates(mesh.audit(CANONICAL), Check::Orientation, &[0, 2, 1, 3]);
    let message = violation.to_error(&solid_header()).to_string();
    assert!(message.contains("(0, 2, 1, 3) is inverted: 0 at (0, 100, -5.03), 2 at"), "{message}");
}

#[test]
fn flat_tetrahedron() {
    let mesh = Solid::new(&[[0, 0, 0], [5, 0, 0], [0, 5, 0], [6, 7, 0]], &[[0, 1, 2, 3]]);
    assert_violates(mesh.audit(CANONICAL), Check::Orientation, &[0, 1, 2, 3]);
}

#[test]
fn overlapping_tetrahedra_on_one_facet() {
    let points = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [1, 1, 9], [3, 3, 5]];
    let mesh = Solid::new(&points, &[[0, 1, 2, 3], [1, 2, 0, 4]]);
    assert_violates(mesh.audit(CANONICAL), Check::Facets, &[1, 0, 2, 3, 4]);
}

/// All tetrahedra around an inner vertex are missing, then the vertex, too.
#[test]
fn cavity_inside() {
    let points = cubic(3);
    let correct = Solid::canonical(&points);
    correct.audit(CANONICAL).unwrap();
    let mut mesh = correct.clone();
    mesh.tetrahedra.retain(|tetrahedron| !tetrahedron.contains(&13));
    assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Vertices, "vertex 13 has none");
    mesh.points.remove(13);
    mesh.tetrahedra.iter_mut().flatten().for_each(|v| *v -= usize::from(*v > 13));
    assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Vertices, "links are rings");
}

/// A tetrahedron far from the hull is missing: its four facets are open, and all other simplices are right.
#[test]
fn hole_of_one_tetrahedron() {
    let points: Vec<[i32; 3]> = distinct(3, 22, 60);
    let correct = Solid::canonical(&points);
    let mut boundary = Vec::new();
    for tetrahedron in &correct.tetrahedra {
        for side in 0..4 {
            let facet: Vec<usize> = (0..4).filter(|&i| i != side).map(|i| tetrahedron[i]).collect();
            let has = |t: &&[usize; 4]| facet.iter().all(|v| t.contains(v));
            if correct.tetrahedra.iter().filter(has).count() == 1 {
                boundary.extend(facet);
            }
        }
    }
    let inner = correct.tetrahedra.iter().position(|t| t.iter().all(|v| !boundary.contains(v)));
    let mut mesh = correct.clone();
    mesh.tetrahedra.remove(inner.expect("a tetrahedron inside"));
    // The links of its four vertices are disks, as on a hull, so only the check of the hull finds the cavity.
    assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Hull);
}

#[test]
fn two_tetrahedra_at_one_vertex() {
    let points = [[0, 0, 0], [9, 0, 9], [0, 9, 9], [0, 0, 9], [-9, 0, -9], [0, -9, -9], [0, 0, -9]];
    let mesh = Solid::new(&points, &[[0, 1, 2, 3], [0, 4, 6, 5]]);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[0]);
}

#[test]
fn two_tetrahedra_at_one_edge() {
    let points = [[0, 0, 0], [0, 0, 9], [9, 0, 4], [9, 9, 4], [-9, 0, 4], [-9, -9, 4]];
    let mesh = Solid::new(&points, &[[0, 2, 3, 1], [0, 4, 5, 1]]);
    assert_violates(mesh.audit(CANONICAL), Check::Hull, &[0, 1]);
}

#[test]
fn dent_in_the_hull() {
    let points = [[0, 0, 0], [20, 0, 0], [0, 20, 0], [5, 5, 4], [5, 5, 60]];
    let correct = Solid::canonical(&points);
    correct.audit(CANONICAL).unwrap();
    assert_eq!(correct.tetrahedra.len(), 4);
    let mut mesh = correct;
    let bottom = mesh.tetrahedra.iter().position(|t| !t.contains(&4)).unwrap();
    mesh.tetrahedra.remove(bottom);
    let violation = match mesh.audit(CANONICAL) {
        Err(Verdict::Violation(violation)) => violation,
        other => panic!("{other:?}"),
    };
    assert_eq!(violation.check, Check::Hull);
    assert!(violation.message.contains("concave"), "{violation:?}");
}

#[test]
fn two_components() {
    let far = BIPYRAMID.map(|[x, y, z]| [x + 100, y, z]);
    let mut tetrahedra = TWO.to_vec();
    tetrahedra.extend(TWO.map(|t| t.map(|v| v + 5)));
    let mesh = Solid::new(&[BIPYRAMID, far].concat(), &tetrahedra);
    let violation = match mesh.audit(CANONICAL) {
        Err(Verdict::Violation(violation)) => violation,
        other => panic!("{other:?}"),
    };
    assert_eq!(violation.check, Check::Hull);
    assert!(violation.message.contains("not one convex surface"), "{violation:?}");
}

/// The second copy lies on the first: every point is covered twice.
#[test]
fn the_same_mesh_twice() {
    let mut tetrahedra = TWO.to_vec();
    tetrahedra.extend(TWO.map(|t| t.map(|v| v + 5)));
    let mesh = Solid::new(&[BIPYRAMID, BIPYRAMID].concat(), &tetrahedra);
    let violation = match mesh.audit(CANONICAL) {
        Err(Verdict::Violation(violation)) => violation,
        other => panic!("{other:?}"),
    };
    assert_eq!(violation.check, Check::Hull);
    assert!(violation.message.contains("goes around 2 times"), "{violation:?}");
}

/// Every tetrahedron, every facet and every link is right, but the mesh goes around its axis twice.
#[test]
fn double_cover() {
    let ring = [[100, 0, 0], [-50, 87, 0], [-50, -87, 0]];
    let points = [&[[0, 0, -5], [0, 0, 5]][..], &ring, &ring].concat();
    let around = |i: usize| [0, 2 + i, 2 + (i + 1) % 6, 1];
    let mesh = Solid::new(&points, &(0..6).map(around).collect::<Vec<_>>());
    let violation = assert_violates(mesh.audit(CANONICAL), Check::Hull, &[0]);
    assert!(violation.message.contains("goes around 2 times"), "{violation:?}");
    let once = Solid::new(&points[..5], &[[0, 2, 3, 1], [0, 3, 4, 1], [0, 4, 2, 1]]);
    once.audit_with(&points).unwrap();
}

#[test]
fn facet_that_is_not_delaunay() {
    // Three tetrahedra around the axis, although the two on both sides of the triangle are Delaunay.
    let mesh = Solid::new(&BIPYRAMID, &[[0, 1, 2, 4], [0, 2, 3, 4], [0, 3, 1, 4]]);
    assert_eq!(check_of(mesh.audit(Standard::Delaunay)), Check::Delaunay);
    let flat = BIPYRAMID.map(|[x, y, z]| [x, y, z / 10]);
    assert_eq!(check_of(Solid::new(&flat, &TWO).audit(Standard::Delaunay)), Check::Delaunay);
    Solid::new(&flat, &[[0, 1, 2, 4], [0, 2, 3, 4], [0, 3, 1, 4]]).audit(CANONICAL).unwrap();
}

/// The cube has several Delaunay tetrahedralizations; one of them is canonical.
#[test]
fn cube_that_is_not_canonical() {
    let cube = cubic(2);
    let canonical = Solid::canonical(&cube);
    canonical.audit(CANONICAL).unwrap();
    // The two divisions into five tetrahedra, one of them in the middle.
    let five = [[0, 1, 2, 4], [3, 2, 1, 7], [5, 1, 4, 7], [6, 4, 2, 7], [1, 2, 4, 7]];
    let mirrored = five.map(|[a, b, c, d]| [a ^ 1, c ^ 1, b ^ 1, d ^ 1]);
    for tetrahedra in [five, mirrored] {
        let mesh = Solid::new(&cube, &tetrahedra);
        mesh.audit(Standard::Delaunay).unwrap();
        assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Canonical);
    }
    // The mirror image of the canonical tetrahedralization.
    let turned: Vec<[usize; 4]> =
        canonical.tetrahedra.iter().map(|&[a, b, c, d]| [a ^ 1, c ^ 1, b ^ 1, d ^ 1]).collect();
    let mesh = Solid::new(&cube, &turned);
    mesh.audit(Standard::Delaunay).unwrap();
    assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Canonical);
}

/// The two triangulations of the flat bottom of a pyramid.
#[test]
fn flat_hull_that_is_not_canonical() {
    let points = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [5, 5, 30]];
    let canonical = Solid::canonical(&points);
    canonical.audit(CANONICAL).unwrap();
    let one = [[0, 1, 2, 4], [0, 2, 3, 4]];
    let other = [[0, 1, 3, 4], [1, 2, 3, 4]];
    let verdicts = [one, other].map(|t| Solid::new(&points, &t).audit(CANONICAL).is_ok());
    assert_eq!(verdicts, [false, true], "the diagonal avoids the greatest point");
    for tetrahedra in [one, other] {
        Solid::new(&points, &tetrahedra).audit(Standard::Delaunay).unwrap();
    }
}

/// The mesh ignores a point inside a hull facet and a point inside a hull edge.
#[test]
fn vertex_inside_of_a_hull_facet() {
    let points = [[0, 0, 0], [12, 0, 0], [0, 12, 0], [0, 0, 12], [3, 3, 0], [6, 0, 0]];
    let correct = Solid::canonical(&points);
    correct.audit_with(&points).unwrap();
    let past = Solid::new(&points, &[[0, 1, 2, 3]]);
    assert_eq!(check_of(past.audit(CANONICAL)), Check::Vertices);
    let mesh = Solid::new(&points[..4], &[[0, 1, 2, 3]]);
    mesh.audit(CANONICAL).unwrap();
    assert_eq!(check_of(mesh.audit_with(&points)), Check::Points);
}

#[test]
fn duplicate_vertex() {
    let mut points = cubic(2);
    let mut mesh = Solid::canonical(&points);
    points.push([1, 1, 0]);
    mesh.points = points.clone();
    let half = mesh.tetrahedra.len() / 2;
    mesh.tetrahedra[half..].iter_mut().flatten().filter(|v| **v == 3).for_each(|v| *v = 8);
    assert!(matches!(mesh.audit(CANONICAL), Err(Verdict::Violation(_))));
    assert_violates(mesh.audit_with(&points), Check::Points, &[8]);
}

#[test]
fn dangling_vertex() {
    let mesh = Solid::new(&[&BIPYRAMID[..], &[[1, 1, 1]]].concat(), &TWO);
    assert_violates(mesh.audit(CANONICAL), Check::Vertices, &[5]);
}

#[test]
fn moved_vertex() {
    let mut mesh = Solid::canonical(&cubic(3));
    mesh.points[13] = [2, 2, 2];
    assert!(matches!(mesh.audit(CANONICAL), Err(Verdict::Violation(_))));
    mesh.points[13] = [1, 1, 3];
    assert!(matches!(mesh.audit(CANONICAL), Err(Verdict::Violation(_))));
}
