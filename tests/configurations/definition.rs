//! The rule `delaunay` and the definition of Delaunay configurations.

use super::{check_circles, delaunay, knots, listed};
use spmesh_base::error::ErrorKind;
use spmesh_configurations::{self as configurations, Rule};
use spmesh_reference::configurations::{by_definition, lines};
use spmesh_reference::sets::{self, Random};

/// Compares all degrees up to `degree`, infinite configurations included.
fn assert_definition(points: &[[f64; 2]], degree: usize) {
    let all = delaunay(points, degree);
    let expected = by_definition(points, degree);
    for (k, configurations) in all.iter().enumerate() {
        assert_eq!(configurations.degree(), k);
        assert_eq!(listed(configurations), expected[k], "degree {k}; let points = vec!{points:?};");
        check_circles(&knots(points), configurations).expect("circles");
        let infinite = configurations
            .groups()
            .flat_map(|group| group.infinite.iter().map(move |&[p, q, _]| ([p, q], group.interior.to_vec())));
        let mut infinite: Vec<_> = infinite.collect();
        infinite.sort();
        assert_eq!(infinite, lines(points, k), "lines, degree {k}; let points = vec!{points:?};");
    }
}

fn random_points(random: &mut Random, count: usize) -> Vec<[f64; 2]> {
    (0..count).map(|_| [random.unit(), random.unit()]).collect()
}

/// Compares sets of 12 to 40 random knots, for degrees up to 6.
fn random_sets_agree(sets: u64) {
    for seed in 0..sets {
        let mut random = Random::new(seed);
        let count = random.integer(12, 40) as usize;
        assert_definition(&random_points(&mut random, count), 6);
    }
}

#[test]
fn random_sets_agree_by_definition() {
    random_sets_agree(4);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn two_hundred_random_sets_agree() {
    random_sets_agree(200);
}

#[test]
fn grids_with_ties_agree() {
    for [width, height] in [[3, 3], [4, 3], [4, 4], [5, 4]] {
        let points: Vec<[f64; 2]> =
            (0..width * height).map(|i| [(i % width) as f64, (i / width) as f64]).collect();
        assert_definition(&points, 4);
    }
}

#[test]
fn degenerate_sets_agree() {
    for family in 0..sets::DEGENERATE_FAMILIES {
        let mut points = sets::as_floats(&sets::degenerate(&mut Random::new(family as u64), family, 16));
        points.truncate(16);
        let knots = knots(&points);
        if configurations::delaunay(&knots).is_ok() {
            assert_definition(&points, 3);
        }
    }
}

#[test]
fn repeated_knots_agree() {
    for seed in 0..12 {
        let mut random = Random::new(seed);
        let side = random.integer(1, 3);
        let points: Vec<[f64; 2]> =
            (0..14).map(|_| [random.integer(0, side) as f64, random.integer(0, side) as f64]).collect();
        if configurations::delaunay(&knots(&points)).is_ok() {
            assert_definition(&points, 3);
        }
    }
}

#[test]
fn extreme_coordinates_agree() {
    let mut random = Random::new(5);
    let mut points: Vec<[f64; 2]> =
        (0..8).map(|_| [random.unit() * 1e300, (random.unit() - 0.5) * 1e-300]).collect();
    points.extend([[0.0, 0.0], [-0.0, 5e-324], [1.7e308, -1.7e308], [0.0, 0.0]]);
    assert_definition(&points, 2);
}

#[test]
fn degrees_add_up() {
    for seed in 0..4 {
        let mut random = Random::new(100 + seed);
        let count = 13 + seed as usize;
        let points = random_points(&mut random, count);
        let all = delaunay(&points, count - 3);
        for k in 0..=count - 3 {
            assert_eq!(all[k].len() + all[count - 3 - k].len(), 2 * (k + 1) * (count - 2 - k), "degree {k}");
        }
    }
}

#[test]
fn what_cannot_be_is_an_error() {
    let line = knots(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [1.0, 1.0]]);
    let error = configurations::delaunay(&line).expect_err("collinear");
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert!(error.to_string().contains("on one line"), "{error}");
    let four = knots(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    let start = configurations::delaunay(&four).expect("four points");
    assert!(configurations::generate(&four, start.clone(), &Rule::Delaunay, 1).is_ok());
    let error = configurations::generate(&four, start, &Rule::Delaunay, 2).expect_err("too few knots");
    assert!(error.to_string().contains("degree 2 needs at least 5 knots, there are 4"), "{error}");
    let error = configurations::Knots::new(vec![[0.0, f64::NAN]]).expect_err("no number");
    assert_eq!(error.to_string(), "knot 0: coordinate is not finite: [0.0, NaN]");
}
