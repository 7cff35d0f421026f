//! Constrained triangulations of whole sets against their definition.

use spmesh_delaunay::constrained2::ConstrainedTriangulation;
use spmesh_delaunay::{Error, Location};
use spmesh_reference::constrained::Scene;
use spmesh_reference::noding::snap_round;
use spmesh_reference::segments::{is_on, random_polylines};
use spmesh_reference::sets::{self, Random, as_floats, uniform};
use spmesh_reference::{as_set, exhaustive};
use std::collections::BTreeMap;

type Place = [i64; 2];

fn turn([p, q]: [Place; 2], x: Place) -> i64 {
    ((q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])).signum()
}

/// Checks the arrays, the triangles and the segments of edges against the definition. `firsts` are the
/// indices of the distinct points.
fn check(mesh: &ConstrainedTriangulation, points: &[Place], segments: &[[u32; 2]]) {
    assert_eq!(mesh.points(), as_floats(points));
    let first = |&point: &Place| points.iter().position(|&other| other == point).unwrap() as u32;
    assert_eq!(mesh.representatives(), points.iter().map(first).collect::<Vec<_>>());
    let mut firsts: Vec<u32> = points.iter().map(first).collect();
    firsts.sort_unstable();
    firsts.dedup();
    let place_of = |end: u32| firsts.binary_search(&first(&points[end as usize])).unwrap() as u32;
    let distinct: Vec<Place> = firsts.iter().map(|&v| points[v as usize]).collect();
    let renamed: Vec<[u32; 2]> = segments.iter().map(|ends| ends.map(place_of)).collect();
    let scene = Scene::new(&distinct, &renamed.iter().copied().filter(|[a, b]| a != b).collect::<Vec<_>>());
    let simplices: Vec<[u32; 3]> = mesh.simplices().collect();
    let expected = scene.triangles().into_iter().map(|t| t.map(|v| firsts[v as usize]));
    assert_eq!(as_set(simplices.clone()), as_set(expected), "points {points:?}, segments {segments:?}");
    let mut edges = BTreeMap::new();
    for (number, corners) in (0..).zip(&simplices) {
        for side in 0..3 {
            let ends = [1, 2].map(|turn| corners[(side + turn) % 3]);
            let has_both = |t: &[u32; 3]| ends.iter().all(|end| t.contains(end));
            let mut others = (0..).zip(&simplices).filter(|&(other, t)| other != number && has_both(t));
            assert_eq!(mesh.neighbours(number)[side], others.next().map(|(other, _)| other));
            let at = ends.map(|end| points[end as usize]);
            let covers = |s: &[u32; 2]| at.iter().all(|&x| is_on(s.map(|end| points[end as usize]), x));
            let segment = segments.iter().position(covers).map(|segment| segment as u32);
            assert_eq!(mesh.segments(number)[side], segment);
            segment.map(|segment| edges.insert([ends[0].min(ends[1]), ends[0].max(ends[1])], segment));
        }
    }
    let mut found: Vec<([u32; 2], u32)> = mesh.constrained_edges().collect();
    found.sort_unstable();
    assert_eq!(found, edges.into_iter().collect::<Vec<_>>());
}

/// Compares the location of each place of a small square with a search of all triangles.
fn check_locations(mesh: &ConstrainedTriangulation, points: &[Place], side: i64) {
    let simplices: Vec<[u32; 3]> = mesh.simplices().collect();
    for target in (0..(side + 2).pow(2)).map(|i| [i % (side + 2) - 1, i / (side + 2) - 1]) {
        let mut expected = Location::Outside;
        for (number, corners) in (0..).zip(&simplices) {
            let at = corners.map(|v| points[v as usize]);
            let turns = [0, 1, 2].map(|i| turn([at[(i + 1) % 3], at[(i + 2) % 3]], target));
            if turns.iter().all(|&turn| turn >= 0) {
                let mut face: Vec<u32> = (0..3).filter(|&i| turns[i] > 0).map(|i| corners[i]).collect();
                face.sort_unstable();
                expected = match face[..] {
                    [v] => Location::Vertex(v),
                    [u, v] => Location::Edge([u, v]),
                    _ => Location::Simplex(number),
                };
            }
        }
        if let Some(vertex) = points.iter().position(|&point| point == target) {
            expected = Location::Vertex(vertex as u32);
        }
        assert_eq!(mesh.locate(target.map(|c| c as f64)), expected, "{target:?} in {points:?}");
    }
}

/// Segments along polylines that overlap, and pass through points, and some between equal points.
fn segments(random: &mut Random, points: &[Place]) -> Vec<[u32; 2]> {
    let index = |place: &Place| points.iter().rposition(|point| point == place).unwrap() as u32;
    let lines = random_polylines(random, points, 3);
    let parts = lines.iter().flat_map(|line| line.windows(2));
    let mut segments: Vec<[u32; 2]> = parts.map(|part| [index(&part[0]), index(&part[1])]).collect();
    segments.extend((0..points.len() as u32).take(2).map(|end| [end, index(&points[end as usize])]));
    random.shuffle(&mut segments);
    segments
}

#[test]
fn points_and_segments_follow_the_definition() {
    for seed in 0..500 {
        let mut random = Random::new(seed);
        let side = [1, 3, 4, 6, 1000][seed as usize % 5];
        let count = random.integer(0, 11) as usize;
        let mut points = uniform(&mut random, count, side);
        if seed % 7 == 0 {
            points.iter_mut().for_each(|point| point[1] = point[0]);
        }
        points.extend_from_within(..points.len().min(seed as usize % 3));
        let segments = if points.is_empty() { Vec::new() } else { segments(&mut random, &points) };
        let mesh = ConstrainedTriangulation::new(&as_floats(&points), &segments).unwrap();
        check(&mesh, &points, &segments);
        if side < 10 {
            check_locations(&mesh, &points, side);
        }
    }
}

#[test]
fn without_segments_it_is_the_delaunay_triangulation() {
    let mut random = Random::new(5);
    for exponent in [-1060, -500, 0, 500, 900] {
        let points = as_floats(&uniform(&mut random, 12, 9));
        let points: Vec<[f64; 2]> =
            points.iter().map(|p| p.map(|c| c * 2f64.powi(exponent / 2).powi(2))).collect();
        let mesh = ConstrainedTriangulation::new(&points, &[]).unwrap();
        assert_eq!(as_set(mesh.simplices()), exhaustive::triangles(&points));
    }
}

#[test]
fn segments_that_cross_are_refused_and_others_are_not() {
    let (mut crossing, mut clear) = (0, 0);
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let points = uniform(&mut random, 7, [4, 100][seed as usize % 2]);
        let last = points.len() as i64 - 1;
        let segments: Vec<[u32; 2]> =
            (0..3).map(|_| [(); 2].map(|()| random.integer(0, last) as u32)).collect();
        let places: Vec<[Place; 2]> = segments.iter().map(|s| s.map(|end| points[end as usize])).collect();
        let divides = |s: [Place; 2], [a, b]: [Place; 2]| turn(s, a) * turn(s, b) < 0;
        let meet_at_point = |s, t| points.iter().any(|&x| is_on(s, x) && is_on(t, x));
        let cross = |s, t| divides(s, t) && divides(t, s) && !meet_at_point(s, t);
        let expected = places.iter().any(|&s| places.iter().any(|&t| cross(s, t)));
        match ConstrainedTriangulation::new(&as_floats(&points), &segments) {
            Err(Error::Crossing(ends)) => {
                assert!(expected, "{points:?} {segments:?}");
                let ends = ends.map(|end| end.map(|c| c as i64));
                assert!(places.iter().any(|&s| is_on(s, ends[0]) && is_on(s, ends[1])));
                crossing += 1;
            }
            other => {
                assert!(other.is_ok() && !expected, "{points:?} {segments:?}");
                clear += 1;
            }
        }
    }
    assert!(crossing > 50 && clear > 50, "{crossing}, {clear}");
}

#[test]
fn segments_that_cross_are_noded_on_the_grid() {
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let count = random.integer(1, 6) as usize;
        let places = uniform(&mut random, count, [4, 12][seed as usize % 2]);
        let last = places.len() as i64 - 1;
        let segments: Vec<[u32; 2]> =
            (0..3).map(|_| [(); 2].map(|()| random.integer(0, last) as u32)).collect();
        let lines = segments.iter().map(|s| s.map(|end| places[end as usize]).to_vec());
        let (vertices, parts) = snap_round(&lines.chain(places.iter().map(|&p| vec![p])).collect::<Vec<_>>());
        let points: Vec<Place> = vertices.into_iter().collect();
        let index = |place: &Place| points.binary_search(place).unwrap() as u32;
        let ends: Vec<[u32; 2]> = parts.keys().map(|part| [index(&part[0]), index(&part[1])]).collect();
        let mesh = ConstrainedTriangulation::noded(&places, &segments, 100).unwrap();
        assert_eq!(mesh.points(), as_floats(&points));
        assert_eq!(as_set(mesh.simplices()), Scene::new(&points, &ends).triangles());
        if mesh.simplices().count() > 0 {
            let found: BTreeMap<[u32; 2], u32> = mesh.constrained_edges().collect();
            let expected = ends.into_iter().zip(parts.values().map(|&line| line as u32)).collect();
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn depths_count_rings_around_triangles() {
    for seed in 0..60 {
        let mut random = Random::new(seed);
        // Boxes that neither touch nor cross, and points anywhere.
        let mut boxes: Vec<[Place; 2]> = Vec::new();
        for _ in 0..40 {
            let corner = [(); 2].map(|()| random.integer(0, 30));
            let size = [(); 2].map(|()| random.integer(1, 15));
            let new = [corner, [corner[0] + size[0], corner[1] + size[1]]];
            let holds = |a: [Place; 2], b: [Place; 2]| (0..2).all(|i| a[0][i] < b[0][i] && b[1][i] < a[1][i]);
            let is_apart =
                |a: [Place; 2], b: [Place; 2]| (0..2).any(|i| a[1][i] < b[0][i] || b[1][i] < a[0][i]);
            if boxes.iter().all(|&old| holds(old, new) || holds(new, old) || is_apart(old, new)) {
                boxes.push(new);
            }
        }
        let corners = boxes.iter().flat_map(|&[[a, b], [c, d]]| [[a, b], [c, b], [c, d], [a, d]]);
        let mut points: Vec<Place> = corners.collect();
        let segments: Vec<[u32; 2]> =
            (0..points.len() as u32).map(|v| [v, if v % 4 == 3 { v - 3 } else { v + 1 }]).collect();
        points.extend(sets::uniform(&mut random, 30, 40));
        let mesh = ConstrainedTriangulation::new(&as_floats(&points), &segments).unwrap();
        for (corners, depth) in mesh.simplices().zip(mesh.depths()) {
            let at = corners.map(|v| points[v as usize]);
            let centre = [0, 1].map(|i| at[0][i] + at[1][i] + at[2][i]);
            let is_in = |b: &&[Place; 2]| (0..2).all(|i| 3 * b[0][i] < centre[i] && centre[i] < 3 * b[1][i]);
            assert_eq!(depth as usize, boxes.iter().filter(is_in).count(), "{corners:?} in {points:?}");
        }
    }
}

#[test]
fn ends_that_are_no_points_are_refused() {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let error = Error::NoSuchPoint { segment: 1, ends: [0, 3] };
    assert_eq!(ConstrainedTriangulation::new(&points, &[[0, 1], [0, 3]]).err(), Some(error.clone()));
    assert_eq!(ConstrainedTriangulation::noded(&[[0, 0]; 3], &[[0, 1], [0, 3]], 0).err(), Some(error));
    let mesh = ConstrainedTriangulation::new(&points, &[]).unwrap();
    assert_eq!(mesh.locate([f64::NAN, 0.0]), Location::Outside);
}
