//! Projective configurations, and convex sets of points in space.

use super::{check_facets, knots, listed};
use spmesh_configurations::{self as configurations, Lift, Rule, Start};
use spmesh_reference::configurations::Configuration;
use spmesh_reference::normalised;
use spmesh_reference::sets::Random;

type Point = [i64; 3];

/// The side of the plane of a, b, c where d lies: positive if a, b, c are clockwise seen from d.
fn side([a, b, c, d]: [Point; 4]) -> i128 {
    let [p, q, r] = [a, b, c].map(|v| [0, 1, 2].map(|axis| i128::from(v[axis] - d[axis])));
    p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
        + p[2] * (q[0] * r[1] - q[1] * r[0])
}

/// All boundary-interior configurations of degree k (thesis 7.1): planes through three points with k points
/// on one side. Seen from that side, the triple is clockwise. Returns the configurations whose side is below,
/// and the number of the others.
fn by_definition(points: &[Point], k: usize) -> (Vec<Configuration>, usize) {
    let count = points.len() as u32;
    let at = |id: u32| points[id as usize];
    let (mut below, mut above) = (Vec::new(), 0);
    for a in 0..count {
        for b in (0..count).filter(|&b| b > a) {
            for c in (0..count).filter(|&c| c > a && c != b) {
                let mut interior = Vec::new();
                for d in (0..count).filter(|d| ![a, b, c].contains(d)) {
                    let side = side([at(a), at(b), at(c), at(d)]);
                    assert_ne!(side, 0, "general position");
                    if side > 0 {
                        interior.push(d);
                    }
                }
                if interior.len() == k {
                    let [p, q, r] = [a, b, c].map(at);
                    let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                    if area > 0 {
                        below.push((normalised([a, b, c]), interior));
                    } else {
                        above += 1;
                    }
                }
            }
        }
    }
    below.sort_by(|p, q| (&p.1, p.0).cmp(&(&q.1, q.0)));
    (below, above)
}

fn random_points(random: &mut Random, count: usize) -> Vec<[i64; 2]> {
    (0..count).map(|_| [random.integer(-500, 500), random.integer(-500, 500)]).collect()
}

/// Compares projective configurations with the definition, and the number of all configurations of the convex
/// set with the formula.
fn assert_projective(points: &[[i64; 2]], heights: &[i64], lift: Lift) {
    let knots = knots(&points.iter().map(|p| p.map(|c| c as f64)).collect::<Vec<_>>());
    let lifted: Vec<Point> = points.iter().zip(heights).map(|(p, &h)| [p[0], p[1], h]).collect();
    let count = points.len();
    let start = Start::lifted(&knots, &lift).expect("a convex lift");
    let all = configurations::generate(&knots, start.configurations(), &Rule::Lifted(lift), count - 3)
        .expect("degrees");
    for (k, configurations) in all.iter().enumerate() {
        let (below, above) = by_definition(&lifted, k);
        assert_eq!(listed(configurations), below, "degree {k}");
        assert_eq!(below.len() + above, 2 * (k + 1) * (count - 2 - k), "f_k, degree {k}");
        if k > 0 {
            check_facets(&all[k - 1], configurations).expect("facets");
        }
    }
}

#[test]
fn heights_of_a_convex_function() {
    for seed in 0..4 {
        let mut random = Random::new(seed);
        let points = random_points(&mut random, 14);
        let heights: Vec<i64> =
            points.iter().map(|[x, y]| x.pow(4) + 3000 * y * y + (x + y).pow(2)).collect();
        let lift = Lift::Heights(heights.iter().map(|&h| h as f64).collect());
        assert_projective(&points, &heights, lift);
    }
}

#[test]
fn weights() {
    for seed in 0..4 {
        let mut random = Random::new(20 + seed);
        let points = random_points(&mut random, 13);
        let weights: Vec<i64> = points.iter().map(|_| random.integer(-200, 200)).collect();
        let heights: Vec<i64> = points.iter().zip(&weights).map(|([x, y], w)| x * x + y * y - w).collect();
        assert_projective(&points, &heights, Lift::Weights(weights.iter().map(|&w| w as f64).collect()));
    }
}

#[test]
fn equal_weights_change_nothing() {
    let points: Vec<[f64; 2]> = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5)]).collect();
    let knots = knots(&points);
    let lift = Lift::Weights(vec![0.1; 25]);
    let start = Start::lifted(&knots, &lift).expect("convex");
    let lifted =
        configurations::generate(&knots, start.configurations(), &Rule::Lifted(lift), 3).expect("degrees");
    for (ours, theirs) in lifted.iter().zip(super::delaunay(&points, 3)) {
        assert_eq!(listed(ours), listed(&theirs));
    }
}

#[test]
fn lifts_that_hide_knots_are_errors() {
    let square = knots(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 2.0]]);
    let error = Start::lifted(&square, &Lift::Heights(vec![0.0, 0.0, 0.0, 0.0, 1.0])).expect_err("hidden");
    assert!(error.to_string().starts_with("knot 4: the lift is not convex there"), "{error}");
    let error = Start::lifted(&square, &Lift::Weights(vec![0.0; 3])).expect_err("three values");
    assert_eq!(error.to_string(), "3 values to lift 5 knots: one each is needed");
    assert!(Start::lifted(&square, &Lift::Weights(vec![f64::NAN; 5])).is_err());
    let twice = knots(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 0.0]]);
    assert!(Start::lifted(&twice, &Lift::Weights(vec![0.0; 4])).is_err());
}
