//! Memory: complete lines are written while triangles arrive, and pieces join in any order.

use spmesh_base::error::ErrorKind;
use spmesh_terrain::contours::Options;

use super::{WHOLE, options, try_lines};
use crate::dem::Mesh;
use spmesh_reference::sets::Random;

/// Two rows of vertices, one step apart, from left to right.
fn strip(columns: u32, elevation: impl Fn(u32, u32) -> f64) -> Mesh {
    let points =
        (0..2 * columns).map(|i| [f64::from(i / 2), f64::from(i % 2), elevation(i / 2, i % 2)]).collect();
    let square = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
    Mesh { points, triangles: (0..columns - 1).flat_map(square).collect() }
}

#[test]
fn lines_that_are_over_are_not_held() {
    // The elevation rises by two per column, so each square has two levels, and each line ends on both sides
    // of the strip.
    let stream = strip(60_000, |x, _| f64::from(2 * x)).stream(WHOLE);
    let (lines, stats) = try_lines(&stream, &options(1.0, 0.5)).unwrap();
    assert_eq!((lines.len(), stats.points), (2 * 59_999, 3 * 2 * 59_999));
    assert!(stats.open_points + stats.open_ends < 120_000, "{stats:?}");
}

#[test]
fn levels_are_few_per_triangle_on_average() {
    // Each of these triangles has 1000 levels.
    let steep = |triangles: u32| strip(triangles, |_, y| f64::from(1000 * y)).stream(WHOLE);
    assert!(try_lines(&steep(60), &options(1.0, 0.5)).is_ok());
    let error = try_lines(&steep(200), &options(1.0, 0.5)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert!(error.to_string().contains("at most 256 per"), "{error}");
}

#[test]
fn pieces_are_joined_in_any_order() {
    let mesh = strip(20_000, |_, y| f64::from(y)).shuffled(&mut Random::new(5));
    let (lines, stats) = try_lines(&mesh.stream(WHOLE), &options(1.0, 0.5)).unwrap();
    assert_eq!((lines.len(), stats.points), (1, 2 * 19_999 + 1));
    // Higher ground is on the left and the upper row is higher, so the line runs to the right.
    assert_eq!([lines[0].points[0], lines[0].points[39_998]], [[0.0, 0.5], [19_999.0, 0.5]]);
    // With every second triangle first, no pieces can be joined until the other triangles arrive.
    let mut mesh = strip(20_000, |_, y| f64::from(y));
    let every_second = |from: usize| mesh.triangles.iter().copied().skip(from).step_by(2);
    mesh.triangles = every_second(0).chain(every_second(1)).collect();
    let options = Options { points: Some(1000), ..options(1.0, 0.5) };
    let (parts, stats) = try_lines(&mesh.stream(WHOLE), &options).unwrap();
    assert!(parts.iter().all(|line| line.points.len() <= 2000) && stats.cuts > 10, "{stats:?}");
    assert_eq!(parts.iter().map(|line| line.segments().count()).sum::<usize>(), 2 * 19_999);
}
