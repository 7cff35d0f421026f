//! The 4D diagram engine against brute force and the audit, at every size of coordinates.

use spmesh_audit::diagram::check;
use spmesh_base::error::ErrorKind;
use spmesh_spacetime::diagram4::{Route, diagram, diagram_by};
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;
use std::num::NonZeroUsize;

use spmesh_reference::diagram4::{self as reference, Cell, Point};
use spmesh_reference::sets::Random;
use spmesh_reference::sets4::{cells4, families, floats, grid, random_points};

const SEED: u64 = 20_260_405;

/// Asserts that the engine finds the cells `expected` after `place` has mapped every coordinate.
fn assert_finds(random: &mut Random, expected: &[Cell], points: &[Point], place: impl Fn(i64) -> f64) {
    let placed: Vec<Point4> = points.iter().map(|point| point.map(&place)).collect();
    let mut input: Vec<Point4> = placed.iter().chain(placed.iter().step_by(3)).copied().collect();
    random.shuffle(&mut input);
    match diagram(input, None) {
        Ok((found, _)) => {
            assert_eq!(found.cells, cells4(expected), "{placed:?}");
            assert_eq!((&found.points, found.merged), (&placed, points.len().div_ceil(3) as u64));
        }
        Err(error) => {
            assert!(expected.is_empty(), "{error}: {placed:?}");
            assert_eq!(error.kind(), ErrorKind::Usage);
            assert!(error.to_string().contains("of 4 dimensions"), "{error}");
        }
    }
}

#[test]
fn brute_force_finds_the_same() {
    let mut random = Random::new(SEED);
    let sets: Vec<Vec<Point>> = (0..10).flat_map(|_| families(&mut random)).collect();
    assert!(sets.len() >= 200);
    for points in sets {
        assert_finds(&mut random, &reference::diagram(&points), &points, |x| x as f64);
    }
}

/// All arithmetics of the engine: small integers, 128-bit integers, and arbitrary precision.
#[test]
fn size_and_place_do_not_matter() {
    let mut random = Random::new(SEED + 1);
    for points in families(&mut random) {
        let expected = reference::diagram(&points);
        for scale in [5e-324, 2f64.powi(-660), 2f64.powi(500), 3.0 * 2f64.powi(18), 2f64.powi(40) + 1.0] {
            assert_finds(&mut random, &expected, &points, |x| x as f64 * scale);
        }
        for offset in [1e6, -1e9, 2f64.powi(50)] {
            assert_finds(&mut random, &expected, &points, |x| x as f64 + offset);
        }
        assert_finds(&mut random, &expected, &points, |x| 1e6 + x as f64 / 64.0);
    }
}

/// Asserts that the diagram passes the audit and does not depend on the order of the points.
fn assert_proved(random: &mut Random, mut points: Vec<Point4>, what: &str) {
    let (found, _) = diagram(points.clone(), None).unwrap_or_else(|e| panic!("{what}: {e}"));
    let proof = check(&found.points, &found.cells).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert!(proof.cells > points.len() / 4, "{what}: {proof:?}");
    random.shuffle(&mut points);
    assert!(diagram(points.clone(), None).unwrap().0 == found, "{what}, shuffled");
    assert_same_on_threads(points, &found, what);
}

/// Asserts that any number of threads finds the same diagram.
fn assert_same_on_threads(points: Vec<Point4>, found: &Diagram4, what: &str) {
    for threads in [2, 3, 7].map(|threads| NonZeroUsize::new(threads).unwrap()) {
        let (shared, _) = diagram_by(Route::default(), threads, points.clone(), None).unwrap();
        assert!(shared == *found, "{what}, on {threads} threads");
    }
}

/// A cell of many simplices, to which several threads come: all points of a sphere.
#[test]
fn threads_find_cells_of_many_simplices() {
    let square = |point: &Point4| point.iter().map(|x| (x - 6.0) * (x - 6.0)).sum::<f64>();
    let sphere: Vec<Point4> =
        floats(&grid([13; 4])).into_iter().filter(|point| square(point) == 45.0).collect();
    let (found, stats) = diagram(sphere.clone(), None).unwrap();
    let finite = found.cells.iter().filter(|cell| !cell.is_infinite).count();
    assert_eq!(finite, 1);
    assert!(stats.simplices > 4_096, "too few simplices for threads: {}", stats.simplices);
    assert_same_on_threads(sphere.clone(), &found, "a sphere");
    let other = sphere.iter().map(|&[x, y, z, t]| [x + 3.0, y, z, t]);
    let both: Vec<Point4> = sphere.iter().copied().chain(other).collect();
    let (found, _) = diagram(both.clone(), None).unwrap();
    assert_same_on_threads(both, &found, "two spheres");
}

/// Most cells of a part of a grid have several simplices.
#[test]
fn parts_of_grids_are_proved() {
    let mut random = Random::new(SEED + 7);
    let mut points = floats(&grid([7; 4]));
    random.shuffle(&mut points);
    for count in [2401, 1200, 300] {
        points.truncate(count);
        assert_proved(&mut random, points.clone(), &format!("{count} points of a grid"));
    }
}

#[test]
fn large_sets_are_proved() {
    let mut random = Random::new(SEED + 2);
    let uniform: Vec<Point4> = (0..300).map(|_| [(); 4].map(|()| random.unit())).collect();
    for scale in [1.0, 1e-200, 1e150, 1e-310] {
        let points = uniform.iter().map(|point| point.map(|x| x * scale)).collect();
        assert_proved(&mut random, points, &format!("uniform, times {scale}"));
    }
    let far = uniform.iter().map(|point| point.map(|x| 1e6 + x * 1e-3)).collect();
    assert_proved(&mut random, far, "1e6 and a little");
    for side in [10, 1 << 10, 1 << 20, 1 << 40] {
        let points = floats(&random_points(&mut random, 1000, side));
        assert_proved(&mut random, points, &format!("integers below {side}"));
    }
    let tenths = random_points(&mut random, 500, 8);
    let tenths = tenths.iter().map(|point| point.map(|x| x as f64 * 0.1)).collect();
    assert_proved(&mut random, tenths, "multiples of 0.1, rounded");
}

/// Points on a sphere up to rounding: every decision is close.
#[test]
fn rounded_spheres_are_proved() {
    let mut random = Random::new(SEED + 3);
    for steps in [1e3, 1e15] {
        let mut on_sphere = || {
            let point: Point4 = [(); 4].map(|()| random.unit() - 0.5);
            let length = point.iter().map(|x| x * x).sum::<f64>().sqrt();
            point.map(|x| (x / length * steps).round() / steps)
        };
        let points: Vec<Point4> = (0..80).map(|_| on_sphere()).collect();
        assert_proved(&mut random, points, &format!("a sphere, rounded to 1/{steps}"));
    }
}

#[test]
fn sampled_grids_are_proved() {
    let mut random = Random::new(SEED + 4);
    for part in [20, 50, 90] {
        let mut points = floats(&grid([6, 7, 5, 6]));
        random.shuffle(&mut points);
        points.truncate(points.len() * part / 100);
        assert_proved(&mut random, points, &format!("{part} % of a grid"));
    }
}

#[test]
fn full_grids_are_cubes() {
    for counts in [[2, 2, 2, 2], [3, 2, 4, 2], [5, 4, 3, 6], [2, 9, 2, 3]] {
        let (found, _) = diagram(floats(&grid(counts)), None).unwrap();
        let finite: Vec<_> = found.cells.iter().filter(|cell| !cell.is_infinite).collect();
        assert_eq!(finite.len() as i64, counts.iter().map(|n| n - 1).product::<i64>());
        assert!(finite.iter().all(|cell| cell.vertices.len() == 16 && cell.neighbours.len() == 8));
        check(&found.points, &found.cells).unwrap();
    }
}

#[test]
fn numbers_that_are_none_are_named() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut points = floats(&grid([2; 4]));
        points[7][2] = bad;
        let error = diagram(points, None).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Malformed);
        assert!(error.to_string().contains("point 7"), "{error}");
    }
}
