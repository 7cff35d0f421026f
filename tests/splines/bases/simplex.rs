//! Single simplex splines.

use super::rational;
use num_traits::Zero;
use spmesh_delaunay::predicates::area;
use spmesh_reference::sets::Random;
use spmesh_splines::bases::{DirectionalLimit, Jet, simplex_spline, simplex_spline_jet};

fn at(x: [f64; 2]) -> DirectionalLimit {
    DirectionalLimit::new(x, [0.123, 0.456])
}

/// Whether an integer point is on no line through two knots.
fn is_general(x: [i64; 2], knots: &[[i64; 2]]) -> bool {
    let pairs = (0..knots.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.into_iter().all(|(i, j)| !rational::doubled_area(knots[i], knots[j], x).is_zero())
}

/// Knots of which all but `apart` are within `width` of a line segment; `length` sets its scale.
fn near_a_line(random: &mut Random, count: usize, apart: usize, length: i64, width: i64) -> Vec<[i64; 2]> {
    let flat = (0..count).map(|place| {
        let along = random.integer(-length, length);
        let off = if place < apart { random.integer(-length, length) } else { random.integer(-width, width) };
        [3 * along, 2 * along + off]
    });
    flat.collect()
}

#[test]
fn knots_near_a_line_have_accurate_values() {
    let mut random = Random::new(11);
    let (mut compared, mut greatest) = (0, 0f64);
    for round in 0..1500 {
        let count = 3 + round % 4;
        let width = [3, 40, 100_000][round / 4 % 3];
        let knots = near_a_line(&mut random, count, round / 12 % 3, 1_000_000_000, width);
        // A point in the hull and near the line.
        let shares: Vec<i64> = knots.iter().map(|_| random.integer(1, 1000)).collect();
        let sum: i64 = shares.iter().sum();
        let mean = |axis: usize| {
            let weighted = knots.iter().zip(&shares).map(|(knot, share)| i128::from(knot[axis] * share));
            (weighted.sum::<i128>() / i128::from(sum)) as i64
        };
        let x = [mean(0), mean(1)];
        if !is_general(x, &knots) {
            continue;
        }
        let expected = rational::simplex_spline(x, &knots).rounded();
        let floats: Vec<[f64; 2]> = knots.iter().map(|knot| knot.map(|c| c as f64)).collect();
        let found = simplex_spline(&at(x.map(|c| c as f64)), &floats);
        if expected == 0.0 {
            assert_eq!(found, 0.0, "let knots = vec!{knots:?}; let x = {x:?};");
            continue;
        }
        let error = (found / expected - 1.0).abs();
        assert!(error < 1e-12, "let knots = vec!{knots:?}; let x = {x:?}; {found:e} {expected:e}");
        (compared, greatest) = (compared + 1, greatest.max(error));
    }
    assert!(compared > 800, "{compared}, greatest error {greatest:e}");
}

#[test]
fn repeated_knots_make_bernstein_polynomials() {
    let [a, b, c] = [[0.0, 0.0], [4.0, 1.0], [1.0, 3.0]];
    let size = area(a, b, c);
    let mut random = Random::new(4);
    let factorial = |n: usize| (1..=n).product::<usize>() as f64;
    for _ in 0..200 {
        let multiplicities = [0; 3].map(|_| random.integer(0, 3) as usize);
        let [i, j, l] = multiplicities;
        let mut shares = [0.0; 3].map(|_| 0.01 + random.unit());
        let sum: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|share| *share /= sum);
        let x = [0, 1].map(|axis| shares[0] * a[axis] + shares[1] * b[axis] + shares[2] * c[axis]);
        let mut knots = [vec![a; i + 1], vec![b; j + 1], vec![c; l + 1]].concat();
        random.shuffle(&mut knots);
        let ways = factorial(i + j + l) / (factorial(i) * factorial(j) * factorial(l));
        let powers: f64 = (0..3).map(|at| shares[at].powi(multiplicities[at] as i32)).product();
        let found = simplex_spline(&at(x), &knots);
        assert!((found * size - ways * powers).abs() < 1e-13, "{multiplicities:?} {x:?}");
    }
}

#[test]
fn flat_sets_are_zero() {
    let x = at([1.0, 1.0]);
    assert_eq!(simplex_spline(&x, &[]), 0.0);
    assert_eq!(simplex_spline(&x, &[[1.0, 1.0]; 6]), 0.0);
    assert_eq!(simplex_spline(&x, &[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [1.0, 1.0]]), 0.0);
    assert_eq!(simplex_spline_jet(&x, &[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), Jet::default());
}

#[test]
fn on_a_line_through_knots_one_side_counts() {
    let [a, b, c, d] = [[0.0, 0.0], [4.0, 0.0], [2.0, 3.0], [1.0, -1.0]];
    let (upper, lower) = (1.0 / 6.0, 1.0 / 2.0);
    for (from, expected) in [([2.0, 9.0], [upper, 0.0]), ([3.0, -1e-9], [0.0, lower])] {
        let at = DirectionalLimit::new([1.5, 0.0], from);
        assert_eq!([simplex_spline(&at, &[a, b, c]), simplex_spline(&at, &[b, d, a])], expected);
        // Towards `from`, the spline of degree 1 has no jump and agrees with the jet of that side; its
        // gradient jumps across the line.
        let all = [a, b, c, d];
        let jet = simplex_spline_jet(&at, &all);
        let near = [0, 1].map(|axis| at.x()[axis] + 1e-6 * (from[axis] - at.x()[axis]));
        let slope = (simplex_spline(&DirectionalLimit::new(near, from), &all) - jet.value) / 1e-6;
        let expected: f64 = (0..2).map(|axis| jet.gradient[axis] * (from[axis] - at.x()[axis])).sum();
        assert!((slope - expected).abs() < 1e-8, "{slope} {expected}");
    }
}

#[test]
fn sums_over_a_fan_of_triangles_count_every_point_once() {
    // Exactly one triangle around a knot contains the knot, or a point of an edge, in the limit from a
    // direction.
    let around: Vec<[f64; 2]> =
        [[3, 0], [2, 2], [0, 3], [-3, 1], [-2, -2], [1, -3]].iter().map(|p| p.map(f64::from)).collect();
    let mut random = Random::new(9);
    for _ in 0..300 {
        let from = [random.integer(-4, 4) as f64, random.integer(-4, 4) as f64];
        let tip = around[random.integer(0, 5) as usize];
        for x in [[0.0, 0.0], tip.map(|c| 0.5 * c)] {
            let at = DirectionalLimit::new(x, from);
            let count = (0..6)
                .filter(|&i| simplex_spline(&at, &[[0.0, 0.0], around[i], around[(i + 1) % 6]]) > 0.0)
                .count();
            assert_eq!(count, 1, "{x:?} from {from:?}");
        }
    }
}

/// The integral over a convex polygon of a function that is a polynomial of degree at most 3 between the
/// lines.
fn integral(polygon: Vec<[f64; 2]>, lines: &[[[f64; 2]; 2]], f: &dyn Fn([f64; 2]) -> f64) -> f64 {
    if polygon.len() < 3 {
        return 0.0;
    }
    if let Some((&[p, q], rest)) = lines.split_first() {
        let half = |p, q| {
            let mut kept = Vec::new();
            for (&a, &b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
                let (u, v) = (area(p, q, a), area(p, q, b));
                if u >= 0.0 {
                    kept.push(a);
                }
                if u * v < 0.0 {
                    kept.push([0, 1].map(|axis| a[axis] + u / (u - v) * (b[axis] - a[axis])));
                }
            }
            kept
        };
        return integral(half(p, q), rest, f) + integral(half(q, p), rest, f);
    }
    let of_triangle = |t: [[f64; 2]; 3]| {
        let at = |shares: [f64; 3]| f([0, 1].map(|axis| (0..3).map(|i| shares[i] * t[i][axis]).sum()));
        let inner = at([0.6, 0.2, 0.2]) + at([0.2, 0.6, 0.2]) + at([0.2, 0.2, 0.6]);
        area(t[0], t[1], t[2]) / 48.0 * (25.0 * inner - 27.0 * at([1.0 / 3.0; 3]))
    };
    (2..polygon.len()).map(|i| of_triangle([polygon[0], polygon[i - 1], polygon[i]])).sum()
}

#[test]
fn integrals_are_one_over_a_binomial_coefficient() {
    let mut random = Random::new(21);
    for round in 0..24 {
        let degree = round % 4;
        let mut knots: Vec<[f64; 2]> = (0..degree + 3).map(|_| [random.unit(), random.unit()]).collect();
        if round >= 16 && degree > 0 {
            knots[0] = knots[2];
        }
        let pairs = (0..knots.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let lines = pairs.map(|(i, j)| [knots[i], knots[j]]).filter(|[p, q]| p != q);
        let lines: Vec<[[f64; 2]; 2]> = lines.collect();
        let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let found = integral(square, &lines, &|x| simplex_spline(&at(x), &knots));
        let expected = 2.0 / ((degree + 1) * (degree + 2)) as f64;
        assert!(
            (found - expected).abs() < 1e-10,
            "degree {degree}: {found} {expected}; let knots = vec!{knots:?};"
        );
    }
}
