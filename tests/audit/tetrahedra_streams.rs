//! The rules of a stream of tetrahedra besides its geometry: finalization, points, labels, counts, memory.

use spmesh_audit::{Audit, Check, PointSet, Standard};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, StreamWriter, Totals};

use super::solid::{BIPYRAMID, Solid, TWO, cubic, grid, position, solid_header};
use super::{assert_violates, audit};

const CANONICAL: Standard = Standard::Canonical;

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
    // A vertex must match a given point in z as well as in x and y.
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

/// Passes events directly to the audit, because the reader refuses these faults itself.
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
        let mut audit = Audit::new(&solid_header(), CANONICAL, None).unwrap();
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
        let mut audit = Audit::new(&header, CANONICAL, None).unwrap();
        audit.event(&Event::Patch(patch.clone())).unwrap();
        let end = Totals { points, vertices: 5, simplices: 2, ..Totals::default() };
        let verdict = audit.event(&Event::End(end));
        assert_eq!(verdict.err().map(|violation| violation.check), expected);
    }
}

/// Coordinates at the ends of the range of i32, and f64 without a grid.
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

/// Auditing a long bar of cubes that is written slice by slice takes only the memory of a slice.
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
                // A patch numbers its new vertices first; they have the greater x.
                (if v & 1 == 1 { at } else { layer + at }) as u32
            };
            simplices.extend(cube.iter().flatten().map(|&v| local(v)));
        }
        let old: Vec<u32> = if x == 0 { vec![] } else { (layer as u32..2 * layer as u32).collect() };
        let last: Vec<u32> = if x + 1 == slices { (0..layer as u32).collect() } else { vec![] };
        let finalized = [last, old].concat();
        writer.patch(&Patch { first_id, new, imported, simplices, finalized, ..Patch::default() }).unwrap();
    }
    let report = audit(&writer.end(slices * layer, 0).unwrap(), CANONICAL, None).unwrap();
    assert_eq!(report.live_max as u64, 2 * layer);
    assert!(report.open_max as u64 <= slices * 16 + 100, "{}", report.open_max);
}
