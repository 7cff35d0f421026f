//! Whole tetrahedral meshes by hand: each kind of fault is found and named.

use spmesh::audit::{Audit, Check, PointSet, Standard};
use spmesh::bounds::Bounds;
use spmesh::stream::{Coordinates, Event, Header, Kind, Patch, StreamWriter, Totals};

use super::reference::Random;
use super::solid::{Solid, cubic, grid, position, solid_header};
use super::{Verdict, assert_violates, audit};

const CANONICAL: Standard = Standard::Canonical;

/// Two tetrahedra on a triangle, whose apexes see each other through it.
const BIPYRAMID: [[i32; 3]; 5] = [[0, 0, -30], [20, 0, 0], [-10, 17, 0], [-10, -17, 0], [0, 1, 31]];

/// Its Delaunay tetrahedralization.
const TWO: [[usize; 4]; 2] = [[0, 1, 2, 3], [1, 2, 3, 4]];

fn check_of(result: Result<spmesh::audit::Report, Verdict>) -> Check {
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

/// The tetrahedra that have an inner vertex are away, and the vertex with them.
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

/// A tetrahedron far from the hull is away: its four facets are open, all around it is right.
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
    // A ball less a ball inside of it: the links of the four vertices are disks.
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

/// The second copy is at the same place: every point is covered twice.
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

/// Every tetrahedron, every facet and the link of every vertex is right, but the mesh goes around its axis twice.
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
    // The three tetrahedra around the axis, where the two on both sides of the triangle are right.
    let mesh = Solid::new(&BIPYRAMID, &[[0, 1, 2, 4], [0, 2, 3, 4], [0, 3, 1, 4]]);
    assert_eq!(check_of(mesh.audit(Standard::Delaunay)), Check::Delaunay);
    let flat = BIPYRAMID.map(|[x, y, z]| [x, y, z / 10]);
    assert_eq!(check_of(Solid::new(&flat, &TWO).audit(Standard::Delaunay)), Check::Delaunay);
    Solid::new(&flat, &[[0, 1, 2, 4], [0, 2, 3, 4], [0, 3, 1, 4]]).audit(CANONICAL).unwrap();
}

/// The cube has tetrahedralizations that are all Delaunay; one of them is canonical.
#[test]
fn cube_that_is_not_canonical() {
    let cube = cubic(2);
    let canonical = Solid::canonical(&cube);
    canonical.audit(CANONICAL).unwrap();
    // Five tetrahedra around an inner one, of either kind.
    let five = [[0, 1, 2, 4], [3, 2, 1, 7], [5, 1, 4, 7], [6, 4, 2, 7], [1, 2, 4, 7]];
    let mirrored = five.map(|[a, b, c, d]| [a ^ 1, c ^ 1, b ^ 1, d ^ 1]);
    for tetrahedra in [five, mirrored] {
        let mesh = Solid::new(&cube, &tetrahedra);
        mesh.audit(Standard::Delaunay).unwrap();
        assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Canonical);
    }
    // The mirror image.
    let turned: Vec<[usize; 4]> =
        canonical.tetrahedra.iter().map(|&[a, b, c, d]| [a ^ 1, c ^ 1, b ^ 1, d ^ 1]).collect();
    let mesh = Solid::new(&cube, &turned);
    mesh.audit(Standard::Delaunay).unwrap();
    assert_eq!(check_of(mesh.audit(CANONICAL)), Check::Canonical);
}

/// Two triangulations of the flat bottom of a pyramid.
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

/// A point in the middle of a flat side, and of an edge, that the mesh goes past.
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

#[test]
fn finalization_too_early() {
    let mut writer = StreamWriter::new(Vec::new(), solid_header()).unwrap();
    let new = BIPYRAMID.iter().map(position).collect();
    let first = Patch { new, simplices: vec![0, 1, 2, 3], finalized: vec![0, 3], ..Patch::default() };
    let second = Patch {
        first_id: 5,
        imported: vec![1, 2, 3, 4],
        simplices: vec![0, 1, 2, 3],
        finalized: vec![0, 1, 3],
        ..Patch::default()
    };
    writer.patch(&first).unwrap();
    writer.patch(&second).unwrap();
    let stream = writer.end(5, 0).unwrap();
    let violation = assert_violates(audit(&stream, CANONICAL, None), Check::Finalization, &[]);
    assert!(violation.message.contains("vertex 3 "));
}

#[test]
fn given_points_must_match() {
    let mesh = Solid::canonical(&BIPYRAMID);
    mesh.audit_with(&[&BIPYRAMID[..], &BIPYRAMID[..2]].concat()).unwrap();
    let more = assert_violates(mesh.audit_with(&[&BIPYRAMID[..], &[[3, 3, 4]]].concat()), Check::Points, &[]);
    assert_eq!(more.vertices, [(None, [3.0, 3.0, 4.0])]);
    assert_violates(mesh.audit_with(&BIPYRAMID[..4]), Check::Points, &[4]);
    // The same x and y are not enough.
    let lower = BIPYRAMID.map(|[x, y, z]| [x, y, z - i32::from(z > 30)]);
    assert_violates(mesh.audit_with(&lower), Check::Points, &[4]);
}

#[test]
fn given_points_of_floats_know_one_zero() {
    let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
    let new = vec![[0.0, 0.25, -0.0], [1e300, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.5, 5e-324]];
    let mut set = PointSet::new(Coordinates::F64, 3);
    set.extend(&[[-0.0, 0.25, 0.0], [0.0, 2.0, 0.0], [1e300, -0.0, -0.0], [-0.0, 0.5, 5e-324]]);
    let set = set.finish(&Coordinates::F64).unwrap();
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let finalized = vec![0, 1, 2, 3];
    writer.patch(&Patch { new, simplices: vec![0, 1, 2, 3], finalized, ..Patch::default() }).unwrap();
    audit(&writer.end(4, 0).unwrap(), CANONICAL, Some(set)).unwrap();
    let other = Coordinates::I32 { scale: [0.001, 0.001, 0.01], offset: [0.0, 100.0, -5.0] };
    assert!(PointSet::new(other, 2).finish(&grid()).is_ok(), "another scale of z means nothing in the plane");
    assert!(PointSet::new(other, 3).finish(&grid()).is_err());
}

#[test]
fn labels_are_for_all_vertices_or_none() {
    let mut mesh = Solid::new(&BIPYRAMID, &TWO);
    assert!(mesh.audit(CANONICAL).unwrap().lines.iter().all(|line| line.check != Check::Labels));
    mesh.labels = vec![7, 7, 8, u64::MAX, 0];
    let report = mesh.audit(CANONICAL).unwrap();
    assert!(report.lines.iter().any(|line| line.check == Check::Labels && line.tests == 5));
}

/// Past the reader, which has checks of its own for these faults.
#[test]
fn labels_follow_their_vertices() {
    let new: Vec<_> = BIPYRAMID.iter().map(position).collect();
    let finalized = vec![0, 1, 2, 3, 4];
    let patch = Patch {
        new,
        simplices: TWO.concat().iter().map(|&v| v as u32).collect(),
        finalized,
        ..Patch::default()
    };
    let end = Event::End(Totals { points: 5, vertices: 5, simplices: 2, ..Totals::default() });
    let verdict = |events: &[Event]| {
        let mut audit = Audit::new(&solid_header(), CANONICAL, None);
        events.iter().try_for_each(|event| audit.event(event)).map_err(|violation| violation.check)
    };
    let patch = Event::Patch(patch);
    let labels = |len: u64| Event::Labels((1..=len).collect());
    assert_eq!(verdict(&[patch.clone(), labels(2), labels(3), end.clone()]), Ok(()));
    assert_eq!(verdict(&[labels(1), patch.clone(), end.clone()]), Err(Check::Labels));
    assert_eq!(verdict(&[patch.clone(), labels(2), end.clone()]), Err(Check::Labels));
    assert_eq!(verdict(&[patch, labels(6), end]), Err(Check::Labels));
}

#[test]
fn bounds_and_counts_must_hold() {
    let new: Vec<_> = BIPYRAMID.iter().map(position).collect();
    let simplices = TWO.concat().iter().map(|&v| v as u32).collect();
    let patch = Patch { new, simplices, finalized: vec![0, 1, 2, 3, 4], ..Patch::default() };
    for (height, points, expected) in
        [(31.0, 5, None), (30.0, 5, Some(Check::Bounds)), (31.0, 6, Some(Check::Counts))]
    {
        let bounds = Bounds { min: [-1000.0; 3], max: [1000.0, 1000.0, height] };
        let header = Header { bounds: Some(bounds), ..solid_header() };
        let mut audit = Audit::new(&header, CANONICAL, None);
        audit.event(&Event::Patch(patch.clone())).unwrap();
        let end = Totals { points, vertices: 5, simplices: 2, ..Totals::default() };
        let verdict = audit.event(&Event::End(end));
        assert_eq!(verdict.err().map(|violation| violation.check), expected);
    }
}

/// Coordinates at the end of the range of i32, and f64 without any grid.
#[test]
fn extreme_coordinates() {
    let (low, high) = (i32::MIN, i32::MAX);
    let cube = cubic(2);
    let tetrahedra = Solid::canonical(&cube).tetrahedra;
    let corners: Vec<[i32; 3]> = cube.iter().map(|p| p.map(|c| if c == 0 { low } else { high })).collect();
    let report = Solid::new(&corners, &tetrahedra).audit(CANONICAL).unwrap();
    assert!(report.lines.iter().any(|line| line.check == Check::Canonical && line.exactly > 0));

    let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
    for scale in [5e-324, 1e-160, 0.1, 1e75, 1e150, 1e307] {
        let new: Vec<[f64; 3]> = cube.iter().map(|p| p.map(|c| f64::from(c) * scale)).collect();
        let mut writer = StreamWriter::new(Vec::new(), header.clone()).unwrap();
        let simplices = tetrahedra.concat().iter().map(|&v| v as u32).collect();
        writer.patch(&Patch { new, simplices, finalized: (0..8).collect(), ..Patch::default() }).unwrap();
        audit(&writer.end(8, 0).unwrap(), CANONICAL, None).unwrap();
    }
}

/// A long bar of cubes, written slice by slice, is audited in memory of a slice.
#[test]
fn memory_is_the_width_of_the_stream() {
    let (slices, side) = (400_u64, 3_u64);
    let layer = side * side;
    let cube = Solid::canonical(&cubic(2)).tetrahedra;
    let mut writer = StreamWriter::new(Vec::new(), solid_header()).unwrap();
    for x in 0..slices {
        let first_id = x * layer;
        let new = (0..layer).map(|i| [x as f64, (i % side) as f64, (i / side) as f64]).collect();
        let imported: Vec<u64> = if x == 0 { vec![] } else { (first_id - layer..first_id).collect() };
        let mut simplices = Vec::new();
        for corner in (0..layer).filter(|i| x > 0 && i % side < side - 1 && i / side < side - 1) {
            let local = |v: usize| {
                let at = corner + (v as u64 >> 1 & 1) + (v as u64 >> 2) * side;
                // New vertices first, and these have the greater x.
                (if v & 1 == 1 { at } else { layer + at }) as u32
            };
            simplices.extend(cube.iter().flatten().map(|&v| local(v)));
        }
        let old: Vec<u32> = if x == 0 { vec![] } else { (layer as u32..2 * layer as u32).collect() };
        let last: Vec<u32> = if x + 1 == slices { (0..layer as u32).collect() } else { vec![] };
        let finalized = [last, old].concat();
        writer.patch(&Patch { first_id, new, imported, simplices, finalized }).unwrap();
    }
    let report = audit(&writer.end(slices * layer, 0).unwrap(), CANONICAL, None).unwrap();
    assert_eq!(report.live_max as u64, 2 * layer);
    assert!(report.open_max as u64 <= slices * 16 + 100, "{}", report.open_max);
}
