//! Points inserted one by one give the triangulation of all, whatever comes first.

use super::kernel::checked;
use spmesh_delaunay::Error;
use spmesh_delaunay::delaunay2::{Triangles, Triangulation, triangulate};
use spmesh_reference::sets::{self, Random};
use spmesh_reference::{as_set, exhaustive, incremental};

fn arrays(mesh: &Triangulation) -> &Triangles {
    mesh.arrays()
}

/// Triangulates the first `bulk` points, inserts the others, and compares with `expected`. Checks all arrays
/// after each insertion if there are few points.
fn check(points: &[[f64; 2]], bulk: usize, expected: &[[u32; 3]]) {
    let mut mesh = triangulate(&points[..bulk]).unwrap();
    for (number, &point) in points.iter().enumerate().skip(bulk) {
        let near = number as u32 * 7 % 11;
        let index = if number % 3 == 0 { mesh.insert_near(point, near) } else { mesh.insert(point) };
        assert_eq!(index, Ok(number as u32));
        if points.len() < 40 {
            checked(&points[..=number], arrays(&mesh));
        }
    }
    assert_eq!(mesh.points(), points);
    assert_eq!(checked(points, arrays(&mesh)), expected, "bulk {bulk}, let points = vec!{points:?};");
    let mut duplicates = arrays(&mesh).duplicates.clone();
    duplicates.sort_unstable();
    let of_all = triangulate(points).unwrap();
    let mut expected = arrays(&of_all).duplicates.clone();
    expected.sort_unstable();
    assert_eq!(duplicates, expected);
    if arrays(&mesh).triangles().is_empty() {
        assert_eq!(arrays(&mesh).hull, arrays(&of_all).hull);
    }
}

#[test]
fn every_sequence_of_up_to_five_points_follows_the_definition() {
    for length in 0..=5 {
        for sequence in 0..9usize.pow(length) {
            let places = (0..length).map(|k| sequence / 9usize.pow(k) % 9);
            let points: Vec<[f64; 2]> = places.map(|i| [(i % 3) as f64, (i / 3) as f64]).collect();
            let mut firsts: Vec<u32> = Vec::new();
            for (index, point) in (0..).zip(&points) {
                if points.iter().position(|other| other == point) == Some(index as usize) {
                    firsts.push(index);
                }
            }
            let distinct: Vec<[f64; 2]> = firsts.iter().map(|&v| points[v as usize]).collect();
            let of_distinct = exhaustive::triangles(&distinct);
            let expected = as_set(of_distinct.into_iter().map(|t| t.map(|v| firsts[v as usize])));
            check(&points, sequence % (length as usize + 1), &expected);
        }
    }
}

#[test]
fn every_order_of_a_small_lattice_is_one_triangulation() {
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let [width, height] = [0; 2].map(|_| random.integer(1, 6));
        let lattice = (0..width * height).map(|i| [i % width, i / width]).collect();
        let points = sets::distinct(&mut random, lattice);
        let bulk = random.integer(0, points.len() as i64) as usize;
        check(&sets::as_floats(&points), bulk, &incremental::triangles(&points));
    }
}

#[test]
fn random_and_degenerate_sets_agree_with_the_reference() {
    for seed in 0..120 {
        let mut random = Random::new(seed + 1000);
        let count = random.integer(3, 300) as usize;
        let family = seed as usize % (sets::DEGENERATE_FAMILIES + 1);
        let points = if family == sets::DEGENERATE_FAMILIES {
            let side = random.integer(20, 1 << 29);
            sets::uniform(&mut random, count, side)
        } else {
            sets::degenerate(&mut random, family, count)
        };
        let bulk = random.integer(0, points.len() as i64) as usize;
        check(&sets::as_floats(&points), bulk, &incremental::triangles(&points));
    }
}

#[test]
fn huge_and_tiny_coordinates_follow_the_definition() {
    for seed in 0..300 {
        let mut random = Random::new(seed + 2000);
        let mut points = sets::as_floats(&sets::uniform(&mut random, 9, [3, 50][seed as usize % 2]));
        let scale = |exponent: i64| 2f64.powi(exponent as i32);
        match seed % 3 {
            0 => points.iter_mut().flatten().for_each(|c| *c = (*c - 1.0) * scale(1015)),
            1 => points.iter_mut().flatten().for_each(|c| *c *= f64::from_bits(1)),
            _ => points.iter_mut().flatten().for_each(|c| *c *= scale(random.integer(-1060, 1000))),
        }
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points.dedup();
        random.shuffle(&mut points);
        check(&points, seed as usize % (points.len() + 1), &exhaustive::triangles(&points));
    }
}

#[test]
fn many_points_agree_with_the_kernel() {
    let mut random = Random::new(7);
    let points = sets::as_floats(&sets::uniform(&mut random, 20_000, 1 << 40));
    for bulk in [0, 5_000, 19_999] {
        check(&points, bulk, &checked(&points, arrays(&triangulate(&points).unwrap())));
    }
}

#[test]
fn zeros_are_equal_and_bad_points_change_nothing() {
    let mut mesh = Triangulation::default();
    for (index, point) in (0..).zip([[0.0, 0.0], [-0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -0.0]]) {
        assert_eq!(mesh.insert(point), Ok(index));
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(matches!(mesh.insert([1.0, bad]), Err(Error::NotFinite { .. })));
        }
    }
    assert_eq!(mesh.representatives(), [0, 0, 2, 3, 0]);
    assert_eq!(mesh.insert_near([1.0, 1.0], u32::MAX), Ok(5));
    assert_eq!(mesh.simplices().count(), 2);
}
