//! Plateaus, single points, meshes of one triangle or none, and extreme numbers.

use spmesh_stream::Coordinates;
use spmesh_terrain::contours::Options;

use super::{Line, WHOLE, lines, options, try_lines};
use crate::dem::Mesh;

/// A square grid of vertices with given elevations; each square is cut from lower left to upper right.
fn grid(side: u32, elevation: impl Fn(u32, u32) -> f64) -> Mesh {
    let vertex = |x: u32, y: u32| y * side + x;
    let points =
        (0..side * side).map(|i| [f64::from(i % side), f64::from(i / side), elevation(i % side, i / side)]);
    let squares = (0..(side - 1) * (side - 1)).map(|i| [i % (side - 1), i / (side - 1)]);
    let triangles = squares.flat_map(|[x, y]| {
        let [a, b, c, d] = [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh { points: points.collect(), triangles: triangles.collect() }
}

fn ring(elevation: f64, points: &[[f64; 2]]) -> Line {
    Line { elevation, is_closed: true, is_depression: false, points: points.to_vec() }
}

#[test]
fn plateaus_on_a_level_have_a_line_where_the_ground_falls() {
    // The elevation is 57 steps of 0.01, the level 3 x 0.19: both are exactly 0.57, but neither product is in
    // f64.
    let coordinates = Coordinates::I32 { scale: [1.0, 1.0, 0.01], offset: [0.0; 3] };
    let is_inside = |x: u32, y: u32| (1..=3).contains(&x) && (1..=3).contains(&y);
    let around =
        |outside: f64| grid(5, |x, y| if is_inside(x, y) { 57.0 } else { outside }).stream(coordinates);
    let border: Vec<[f64; 2]> = [[1, 1], [2, 1], [3, 1], [3, 2], [3, 3], [2, 3], [1, 3], [1, 2]]
        .map(|point| point.map(f64::from))
        .to_vec();
    // Higher ground on the left: counterclockwise.
    assert_eq!(lines(&around(56.0), &options(0.19, 0.0)), [ring(0.57, &border)]);
    // A lake gives no line at its own level; a slightly higher level gives a line around its shore.
    assert_eq!(lines(&around(58.0), &options(0.19, 0.0)), []);
    let mut shore = border;
    shore[1..].reverse();
    // The line is nearer to the shore than a hundredth of a step.
    let shore = Line { is_depression: true, ..ring(0.57001, &shore) };
    assert_eq!(lines(&around(100.0), &options(10.0, 0.57001)), [shore]);
}

#[test]
fn tops_on_a_level_are_no_lines() {
    let stream = grid(3, |x, y| if [x, y] == [1, 1] { 10.0 } else { 9.0 }).stream(WHOLE);
    let (found, stats) = try_lines(&stream, &options(5.0, 0.0)).unwrap();
    assert_eq!((found, stats.single_points, stats.levels), (Vec::new(), 1, 0));
    // Two adjacent vertices give a line there and back.
    let stream = grid(4, |x, y| if y == 1 && (1..=2).contains(&x) { 10.0 } else { 9.0 }).stream(WHOLE);
    assert_eq!(lines(&stream, &options(5.0, 0.0)), [ring(10.0, &[[1.0, 1.0], [2.0, 1.0]])]);
}

#[test]
fn one_triangle_and_none() {
    let mesh =
        Mesh { points: vec![[0.0, 0.0, 1.0], [8.0, 0.0, 3.0], [0.0, 8.0, 3.0]], triangles: vec![[0, 1, 2]] };
    let line = |elevation, points| Line { is_closed: false, ..ring(elevation, points) };
    let expected = [line(2.0, &[[0.0, 4.0], [4.0, 0.0]]), line(3.0, &[[0.0, 8.0], [8.0, 0.0]])];
    for coordinates in [WHOLE, Coordinates::F64] {
        assert_eq!(lines(&mesh.stream(coordinates), &options(1.0, 0.0)), expected);
    }
    let empty = Mesh { points: Vec::new(), triangles: Vec::new() };
    let (found, stats) = try_lines(&empty.stream(WHOLE), &options(1.0, 0.0)).unwrap();
    assert_eq!((found, stats.elevations), (Vec::new(), None));
}

#[test]
fn triangles_with_long_edges_end_lines() {
    let mut mesh = grid(3, |x, _| f64::from(x));
    let count = |mesh: &Mesh, kill| {
        let options = Options { kill, ..options(1.0, 0.5) };
        let (lines, stats) = try_lines(&mesh.stream(Coordinates::F64), &options).unwrap();
        (lines.len(), stats.points, stats.killed)
    };
    assert_eq!(count(&mesh, Some(2f64.sqrt())), (2, 10, 0));
    assert_eq!(count(&mesh, Some(1.4)), (0, 0, 8));
    // Move the vertex in the middle of the left side to the left.
    mesh.points[3][0] = -2.0;
    assert_eq!(count(&mesh, None), (2, 10, 0));
    assert_eq!(count(&mesh, Some(1.5)), (2, 7, 3));
}

#[test]
fn two_triangles_on_one_side_of_an_edge_are_malformed() {
    let points = vec![[0.0, 0.0, 1.0], [8.0, 0.0, 3.0], [0.0, 8.0, 3.0], [8.0, 8.0, 1.0]];
    let fails = |triangles: &[[u32; 3]], part: &str| {
        let stream = Mesh { points: points.clone(), triangles: triangles.to_vec() }.stream(WHOLE);
        let error = try_lines(&stream, &options(1.0, 0.5)).unwrap_err();
        assert!(error.exit_code() == 3 && error.to_string().contains(part), "{error}");
    };
    fails(&[[0, 1, 2], [0, 1, 3]], "have the edge between vertices 0 and 1 on the same side");
    fails(&[[0, 2, 1], [1, 3, 2]], "is clockwise");
}

#[test]
fn numbers_at_the_ends_of_their_range() {
    let stream = |scale: f64, height: f64| {
        let points = vec![[-scale, -scale, 0.0], [scale, -scale, height], [0.0, scale, height]];
        Mesh { points, triangles: vec![[0, 1, 2]] }.stream(Coordinates::F64)
    };
    let message = |stream: Vec<u8>, interval: f64, base: f64| {
        let error = try_lines(&stream, &options(interval, base)).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string()
    };
    assert!(message(stream(1e308, 1.0), 0.3, 0.0).contains("too great to interpolate between"));
    assert!(message(stream(1.0, 1e300), 1.0, 0.0).contains("cannot be told apart at elevation 1"));
    assert!(message(stream(1.0, 1.0), 1e-300, 0.0).contains("take a larger distance"));
    assert!(message(stream(1.0, 1.0), 1.0, 1e300).contains("take a larger distance"));
    assert!(message(stream(1.0, 1e6), 0.001, 0.0).contains("1000000000 levels pass through one triangle"));
    assert_eq!(lines(&stream(1.0, 1e6), &options(1e308, 0.0)), []);
    assert_eq!(lines(&stream(1.0, 1e-300), &options(3e-301, 0.0)).len(), 3);
    assert_eq!(lines(&stream(1e150, 1e300), &options(3e299, 0.0)).len(), 3);
    assert_eq!(lines(&stream(1.0, 100.0), &options(0.001, 0.0)).len(), 100_000);
}
