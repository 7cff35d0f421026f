//! Kernels: their results must be provable for any points.

use std::borrow::Cow;
use std::num::NonZeroUsize;

use spmesh_audit::{Audit, Standard, configurations::StreamAudit, diagram::check};
use spmesh_base::error::ErrorKind;
use spmesh_configurations::{Knots, Rule, delaunay, generate};
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_delaunay::{delaunay2, delaunay3};
use spmesh_reference::space::distinct;
use spmesh_reference::tetrahedra::regular;
use spmesh_spacetime::diagram4::{Route, diagram_by};
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;
use spmesh_stream::{Coordinates, Header, Kind, StreamReader, write_configurations, write_triangles};

use crate::points::{moderate, points};
use crate::promises;

/// The triangulation passes the audit of its stream.
pub fn kernel2(bytes: &[u8]) {
    let points = points::<2>(bytes, 300);
    let mesh = delaunay2::triangulate(&points).expect("finite points");
    if mesh.triangles().is_empty() {
        return;
    }
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|triangle| triangle.vertices).collect();
    let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, false);
    let at = |v: u32| [points[v as usize][0], points[v as usize][1], 0.0];
    let (mut stream, merged) = (Vec::new(), mesh.duplicates().len() as u64);
    write_triangles(header, &triangles, points.len(), merged, at, &mut stream).expect("memory takes it");
    let mut reader = StreamReader::new(&stream[..], "kernel2").expect("a header");
    let mut audit = Audit::new(reader.header(), Standard::Canonical, None).expect("a mesh has an audit");
    while let Some(event) = reader.next_event().expect("a stream that was just written") {
        if let Err(violation) = audit.event(&event) {
            panic!("{violation:?}\nlet points = {points:?};");
        }
    }
}

/// The tetrahedra pass a proof that shares no code with the kernel.
pub fn kernel3(bytes: &[u8]) {
    let points = points::<3>(bytes, 120);
    let mut kernel = delaunay3::Kernel::new();
    // The bytes choose the order of insertion, too. Half of the inputs use the default order.
    let choice = bytes.iter().fold(0u8, |sum, &b| sum.wrapping_mul(31).wrapping_add(b));
    if choice & 1 == 1 {
        kernel.curve = Curve::ALL[usize::from(choice >> 1 & 3)];
        let seed = u64::from(choice);
        kernel.sequence =
            [Sequence::Rounds, Sequence::Pass, Sequence::Random { seed }][usize::from(choice >> 3) % 3];
        kernel.by_bit_levels = choice >> 7 == 1;
    }
    let mut mesh = delaunay3::Tetrahedralization::default();
    kernel.triangulate(Cow::Borrowed(&points), &mut mesh).expect("finite points");
    if let Err(message) = promises::prove(&points, &mesh) {
        panic!("{message}\nlet points = {points:?};");
    }
}

/// The regular tetrahedra of few points are those of the definition; of more, equal weights change nothing.
pub fn weighted3(bytes: &[u8]) {
    let (head, rest) = bytes.split_at(bytes.len().min(14));
    let (points, _) = distinct(&points::<3>(rest, 11));
    let lift = |p: &[f64; 3]| p.iter().map(|c| c * c).sum::<f64>().min(f64::MAX / 4.0);
    let all_on_a_plane = head.first().is_some_and(|choice| choice & 1 == 1);
    // Around the lift, all points are near one hyperplane; otherwise weights are small integers.
    let weight = |(i, point): (usize, &[f64; 3])| {
        let change = f64::from(head.get(1 + i).map_or(0, |&byte| byte as i8));
        if all_on_a_plane { lift(point) + f64::from((change / 64.0) as i8) } else { change }
    };
    let weights: Vec<f64> = points.iter().enumerate().map(weight).collect();
    let mut mesh = delaunay3::Tetrahedralization::default();
    delaunay3::Kernel::new()
        .triangulate_weighted(Cow::Borrowed(&points), &weights, &mut mesh)
        .expect("finite points and weights");
    let found = promises::tetrahedra(&mesh);
    let code = || format!("let points = vec!{points:?};\nlet weights = vec!{weights:?};");
    assert_eq!(found, regular(&points, &weights), "{}", code());
    let is_visible = |i: &u32| found.iter().flatten().any(|v| v == i);
    let hidden = (0..points.len() as u32).filter(|i| !found.is_empty() && !is_visible(i));
    let mut of_mesh = mesh.hidden.clone();
    of_mesh.sort_unstable();
    assert!(hidden.eq(of_mesh.iter().copied()), "hidden: {of_mesh:?}\n{}", code());
}

/// Both routes give the same diagram, and an audit proves it.
pub fn diagram4(bytes: &[u8]) {
    let points = moderate::<4>(bytes, 40);
    let by = |route| -> Option<Diagram4> {
        match diagram_by(route, NonZeroUsize::MIN, points.clone(), None) {
            Ok((diagram, _)) => Some(diagram),
            Err(error) => {
                assert!(error.to_string().contains("dimensions"), "{error}");
                None
            }
        }
    };
    let diagram = by(Route::Simplices);
    assert_eq!(diagram, by(Route::Direct), "let points: Vec<Point4> = vec!{points:?};");
    if let Some(Diagram4 { points, cells, .. }) = diagram {
        prove4(&points, &cells);
    }
}

fn prove4(points: &[Point4], cells: &spmesh_stream::model::cells4::Cells4) {
    if let Err(violation) = check(points, cells) {
        panic!("{violation:?}\nlet points = {points:?};");
    }
}

/// Delaunay configurations up to degree 3 pass their audit; other rules end without a panic.
pub fn configurations(bytes: &[u8]) {
    let Some((&choice, rest)) = bytes.split_first() else { return };
    let knots = Knots::new(points::<2>(rest, 40)).expect("finite knots");
    let Ok(start) = delaunay(&knots) else { return };
    let rules = [
        Rule::Delaunay,
        Rule::MinWeight,
        Rule::Ear,
        Rule::Fan,
        Rule::Random(7),
        Rule::Aligned(f64::from(choice)),
    ];
    let rule = &rules[usize::from(choice) % rules.len()];
    let degree = usize::from(choice >> 6).min(knots.len().saturating_sub(3));
    let all = match generate(&knots, start, rule, degree) {
        Ok(all) => all,
        // Under other rules, links need not be simple.
        Err(error) if *rule != Rule::Delaunay => {
            return assert!(matches!(error.kind(), ErrorKind::Audit | ErrorKind::Usage), "{error}");
        }
        Err(error) => panic!("{error}\nlet knots = {:?};", knots.points()),
    };
    let mut stream = Vec::new();
    write_configurations(knots.points(), &all, &mut stream).expect("memory takes it");
    let mut reader = StreamReader::new(&stream[..], "configurations").expect("a header");
    let mut audit = StreamAudit::default();
    while let Some(event) = reader.next_event().expect("a stream that was just written") {
        audit.event(&event).expect("room for all configurations");
    }
    if let Err(error) = audit.prove() {
        panic!("{error}, {rule:?}, degree {degree}\nlet knots = {:?};", knots.points());
    }
}
