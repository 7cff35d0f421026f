//! Volumes that formulas give.

use super::{Mesh, compared, volumes};
use spmesh_stream::Coordinates;
use spmesh_terrain::diff::{Options, Other, compare, number};

fn square(side: f64, z: [f64; 4]) -> Mesh {
    let places = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
    let vertices = places.iter().zip(z).map(|(&[x, y], z)| [x, y, z]).collect();
    Mesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

/// A square pyramid of side 200 and height 90.
fn pyramid() -> Mesh {
    let mut mesh = square(200.0, [0.0; 4]);
    mesh.vertices.push([100.0, 100.0, 90.0]);
    mesh.triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    mesh
}

fn is_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found:?} {expected:?}");
}

#[test]
fn a_pyramid_has_a_third_of_its_box() {
    let (pyramid, floor) = (pyramid(), square(200.0, [0.0; 4]));
    for coordinates in [
        Coordinates::I32 { scale: [0.01; 3], offset: [12_345.67, 1e6, -3.21] },
        Coordinates::I32 { scale: [0.01, 0.01, 0.0254], offset: [0.0; 3] },
        Coordinates::F64,
    ] {
        let [plane, z] = match coordinates {
            Coordinates::F64 => [1.0; 2],
            Coordinates::I32 { scale, .. } => [scale[0], scale[2]],
        };
        let [a, b] = [&pyramid, &floor].map(|mesh| mesh.surface(coordinates));
        let found = compared(&a, &Other::Mesh(&b));
        let [area, volume] = found.units;
        is_close(number(&found.volumes[0][0].cut) * volume, 1.2e6 * plane * plane * z);
        is_close(number(&found.volumes[0][0].cut_area) * area, 4e4 * plane * plane);
        is_close(a.area(), 4e4 * plane * plane);
        assert_eq!(number(&found.volumes[0][0].fill), 0.0);
    }
}

#[test]
fn planes_that_cross_leave_two_wedges() {
    // z = 0 and z = x - 60 over a square of 90.
    let (flat, sloped) = (square(90.0, [0.0; 4]), square(90.0, [-60.0, 30.0, 30.0, -60.0]));
    let found = volumes(&flat.integers(), &sloped.integers());
    let unit = compared(&flat.integers(), &Other::Mesh(&sloped.integers())).units;
    is_close(number(&found.fill) * unit[1], 30.0 * 30.0 / 2.0 * 90.0);
    is_close(number(&found.cut) * unit[1], 60.0 * 60.0 / 2.0 * 90.0);
    is_close(number(&found.fill_area) * unit[0], 30.0 * 90.0);
    // The same plane, as a function.
    let found = compared(&flat.integers(), &Other::Plane([-60.0, 1.0, 0.0]));
    is_close(number(&found.volumes[0][0].fill) * found.units[1], 30.0 * 30.0 / 2.0 * 90.0);
    is_close(number(&found.volumes[0][0].cut_area) * found.units[0], 60.0 * 90.0);
}

#[test]
fn storage_of_a_pyramid_is_a_cubic() {
    let pyramid = pyramid().integers();
    let levels: Vec<f64> = (-2..=20).map(|number| 5.0 * f64::from(number)).collect();
    let found = compared(&pyramid, &Other::Levels(&levels));
    let [area, volume] = found.units;
    for (level, volumes) in levels.iter().zip(&found.volumes[0]) {
        // What is left of the pyramid above the level.
        let height = (90.0 - level).clamp(0.0, 90.0);
        let cap = 1.2e6 * (height / 90.0).powi(3);
        let under = 1.2e6 - 4e4 * level;
        let cut = if *level < 0.0 { under } else { cap };
        is_close(number(&volumes.cut) * volume, cut);
        is_close(number(&volumes.fill) * volume, cut - under);
        is_close(number(&volumes.cut_area) * area, 4e4 * (height / 90.0).powi(2));
        // A level alone is the same.
        let alone = compared(&pyramid, &Other::Levels(&[*level]));
        assert_eq!(alone.volumes[0][0], *volumes);
    }
}

#[test]
fn degenerate_meshes_have_no_volume() {
    let empty = Mesh { vertices: Vec::new(), triangles: Vec::new() };
    let point = Mesh::of(vec![[1.0, 2.0, 3.0]]);
    let line = Mesh::of(vec![[0.0, 0.0, 1.0], [1.0, 1.0, 4.0], [2.0, 2.0, 1.0]]);
    let full = square(8.0, [1.0, 2.0, 3.0, 4.0]);
    for mesh in [&empty, &point, &line] {
        for coordinates in [super::GRID, Coordinates::F64] {
            let [a, b] = [mesh, &full].map(|mesh| mesh.surface(coordinates));
            assert_eq!(volumes(&a, &b), super::Volumes::default());
            assert_eq!(volumes(&b, &a), super::Volumes::default());
            let found = compared(&a, &Other::Levels(&[0.0, 2.5]));
            assert_eq!(found.volumes[0], vec![super::Volumes::default(); 2]);
        }
    }
    // A stray point far away makes triangles that are wide.
    let mut points = full.vertices.clone();
    points.push([2e9, 1e9, 7.0]);
    let stray = Mesh::of(points);
    let found = compared(&stray.integers(), &Other::Mesh(&stray.raised(|[_, _, z]| z + 1.0).integers()));
    is_close(number(&found.volumes[0][0].fill) * found.units[1], stray.integers().area());
}

#[test]
fn levels_that_are_too_far_and_too_little_memory_are_refused() {
    let full = square(8.0, [1.0, 2.0, 3.0, 4.0]).integers();
    let compared = |other: &Other, memory| {
        let options = Options { polygons: &[], memory, threads: 1 };
        compare(&full, other, &options, &mut |_, _| ()).map(drop).unwrap_err()
    };
    assert_eq!(compared(&Other::Levels(&[1e13]), super::MEMORY).exit_code(), 2);
    assert_eq!(compared(&Other::Plane([0.0, 1e300, 1e300]), super::MEMORY).exit_code(), 2);
    assert_eq!(compared(&Other::Levels(&[1.0]), 1 << 20).exit_code(), 5);
}
