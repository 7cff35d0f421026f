//! Heights against exact arithmetic.

use spmesh_stream::model::bounds::Point;

use super::{Parts, heights_in, mesh_of, scattered, triangles_of};
use crate::programs::{Folder, run};
use crate::sources::las_file::LasFile;

const NO_DATA: i32 = i32::MIN;

/// The height of a point in steps of the ground as a fraction with a positive denominator; `None` outside.
/// With coordinates below 2^31, no number has more than 100 bits.
fn exact(triangles: &[[Point; 3]], point: [i64; 3]) -> Option<(i128, i128)> {
    let [x, y, z] = point.map(i128::from);
    triangles.iter().find_map(|corners| {
        let [a, b, c] = corners.map(|corner| corner.map(|value| value as i128));
        let share = |p: [i128; 3], q: [i128; 3]| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        let [p, q, r] = [share(b, c), share(c, a), share(a, b)];
        if p < 0 || q < 0 || r < 0 {
            return None;
        }
        let sum = p + q + r;
        Some((z * sum - (p * a[2] + q * b[2] + r * c[2]), sum))
    })
}

/// A fraction divided by `steps`, rounded half away from zero.
fn rounded((numerator, denominator): (i128, i128), steps: i64) -> i32 {
    let denominator = denominator * i128::from(steps);
    let magnitude = (2 * numerator.abs() + denominator) / (2 * denominator);
    i32::try_from(if numerator < 0 { -magnitude } else { magnitude }).unwrap()
}

fn expected(
    triangles: &[[Point; 3]],
    points: &[[i32; 3]],
    place: impl Fn([i32; 3]) -> [i64; 3],
    steps: i64,
) -> Vec<i32> {
    let height =
        |&point: &[i32; 3]| exact(triangles, place(point)).map_or(NO_DATA, |height| rounded(height, steps));
    points.iter().map(height).collect()
}

fn same([x, y, z]: [i32; 3]) -> [i64; 3] {
    [x.into(), y.into(), z.into()]
}

#[test]
fn heights_are_exact_and_rounded_once() {
    let folder = Folder::new();
    // Few steps: many points on edges and corners, duplicates, cocircular sets and ties of rounding.
    for (size, count) in [(4, 30), (30, 200), (1000, 500), (1 << 30, 300)] {
        let mesh = mesh_of(&scattered(count, size, size).bytes());
        let triangles = triangles_of(&mesh);
        let mut points = scattered(2000, size + size / 8, size + 1);
        for (point, triangle) in points.records.iter_mut().zip(&triangles) {
            point.position = triangle[0].map(|value| value as i32);
        }
        let written = Parts::of(&heights_in(&folder, &mesh, &points.bytes(), "out.las", &[]));
        let heights = written.heights();
        assert_eq!(heights, expected(&triangles, &written.points(), same, 1), "{size}");
        let outside = heights.iter().filter(|height| **height == NO_DATA).count();
        assert!(outside > 0 && outside < 1500, "{outside}");
        let on_corners = triangles.len().min(2000);
        assert!(heights[..on_corners].iter().all(|height| *height == 0));
    }
}

#[test]
fn grids_that_agree_are_aligned_without_rounding() {
    let folder = Folder::new();
    let mesh = mesh_of(&LasFile { scale: [0.001; 3], ..scattered(300, 100_000, 5) }.bytes());
    let triangles = triangles_of(&mesh);
    // Ten steps of the ground in each, and an origin of 7 ground steps in x.
    let points = LasFile { scale: [0.01; 3], offset: [0.007, 0.0, -0.5], ..scattered(3000, 10_000, 6) };
    let written = Parts::of(&heights_in(&folder, &mesh, &points.bytes(), "out.las", &[]));
    let place = |[x, y, z]: [i32; 3]| [10 * i64::from(x) + 7, 10 * i64::from(y), 10 * i64::from(z) - 500];
    assert_eq!(written.heights(), expected(&triangles, &written.points(), place, 10));
}

#[test]
fn grounds_of_other_grids_are_interpolated_in_floating_point() {
    let folder = Folder::new();
    let whole = scattered(300, 1000, 8);
    let text: String = whole
        .records
        .iter()
        .map(|record| record.position.map(|value| f64::from(value) / 3.0))
        .map(|[x, y, z]| format!("{x:.12} {y:.12} {z:.12}\n"))
        .collect();
    let mesh = mesh_of(text.as_bytes());
    let triangles = triangles_of(&mesh);
    let points = LasFile { scale: [0.01; 3], ..scattered(3000, 33_333, 9) };
    let written = Parts::of(&heights_in(&folder, &mesh, &points.bytes(), "out.las", &[]));
    let mut inside = 0;
    for (point, height) in written.points().iter().zip(written.heights()) {
        let [x, y, z] = point.map(|value| f64::from(value) * 0.01);
        let found = triangles.iter().find_map(|[a, b, c]| {
            let cross = |p: &Point, q: &Point| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
            let [u, v, w] = [cross(b, c), cross(c, a), cross(a, b)];
            (u >= 0.0 && v >= 0.0 && w >= 0.0).then(|| z - (u * a[2] + v * b[2] + w * c[2]) / (u + v + w))
        });
        match found {
            Some(expected) => {
                assert!((f64::from(height) - expected * 100.0).abs() <= 0.5 + 1e-6, "{point:?}");
                inside += 1;
            }
            None => assert_eq!(height, NO_DATA, "{point:?}"),
        }
    }
    assert!(inside > 2000);
}

#[test]
fn points_outside_can_have_heights_above_the_nearest_place() {
    let folder = Folder::new();
    let mesh = mesh_of(&scattered(100, 1000, 2).bytes());
    let triangles = triangles_of(&mesh);
    let mut points = scattered(1000, 3000, 3);
    points.records.iter_mut().for_each(|record| record.position[0] -= 1000);
    let bytes = points.bytes();
    let written = Parts::of(&heights_in(&folder, &mesh, &bytes, "out.las", &["--outside", "nearest"]));
    let mut outside = 0;
    for (point, height) in written.points().iter().zip(written.heights()) {
        if let Some(inside) = exact(&triangles, same(*point)) {
            assert_eq!(height, rounded(inside, 1));
            continue;
        }
        outside += 1;
        let [x, y, z] = point.map(f64::from);
        let edges = triangles.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
        let places = edges.map(|[p, q]| {
            let along = [q[0] - p[0], q[1] - p[1]];
            let part =
                ((x - p[0]) * along[0] + (y - p[1]) * along[1]) / (along[0].powi(2) + along[1].powi(2));
            [0, 1, 2].map(|axis| p[axis] + (q[axis] - p[axis]) * part.clamp(0.0, 1.0))
        });
        let nearest = places.min_by(|p, q| {
            let distance = |place: &Point| (place[0] - x).hypot(place[1] - y);
            distance(p).total_cmp(&distance(q))
        });
        let expected = z - nearest.unwrap()[2];
        assert!((f64::from(height) - expected).abs() <= 0.5 + 1e-6, "{point:?}: {height} {expected}");
    }
    assert!(outside > 500);
    // z can hold the same numbers.
    let replaced = Parts::of(&heights_in(&folder, &mesh, &bytes, "z.las", &["--replace-z"]));
    let z: Vec<i32> = replaced.points().iter().map(|point| point[2]).collect();
    assert_eq!(z, written.heights());
}

/// Batches of points, and blocks of triangles, do not show.
#[test]
fn results_do_not_depend_on_memory_and_threads() {
    let folder = Folder::new();
    let mesh = mesh_of(&scattered(20_000, 10_000, 12).bytes());
    let points = scattered(60_000, 10_000, 13).compressed(5000);
    let whole = heights_in(&folder, &mesh, &points, "out.laz", &[]);
    assert_eq!(Parts::of(&whole).records().len(), 60_000);
    for flags in [["--memory", "1"], ["--memory", "500K"], ["--threads", "1"], ["--threads", "3"]] {
        assert!(whole == heights_in(&folder, &mesh, &points, "out.laz", &flags), "{flags:?}");
    }
    // Any order of the triangles gives the same heights.
    let finer = run("spfinalize", &["-q", "--level", "4", "-"], &scattered(20_000, 10_000, 12).bytes());
    let again = run("spdelaunay2d", &["-q"], &finer.stdout);
    assert!(again.status.success() && mesh != again.stdout);
    assert!(whole == heights_in(&folder, &again.stdout, &points, "out.laz", &[]));
}
