//! Functions sum to one, and reproduce polynomials by their polar forms (theorem 6.2.1).

use super::sets::{Case, cases, distorted};
use spmesh_splines::bases::Scratch;

/// The polar form of x^i y^j for the given points: the mean of all products of i abscissae and j ordinates of
/// different points.
fn polar(points: &[[f64; 2]], i: usize, j: usize) -> f64 {
    // Sums of products over the points so far, by the numbers of factors.
    let mut sums = vec![vec![0.0; j + 1]; i + 1];
    sums[0][0] = 1.0;
    for [x, y] in points {
        for at in (0..=i).rev() {
            for up in (0..=j).rev() {
                let from_x = if at > 0 { sums[at - 1][up] * x } else { 0.0 };
                let from_y = if up > 0 { sums[at][up - 1] * y } else { 0.0 };
                sums[at][up] += from_x + from_y;
            }
        }
    }
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, m| c * (n - m) as f64 / (m + 1) as f64);
    sums[i][j] / (choose(points.len(), i) * choose(points.len() - i, j))
}

/// The greatest error of all monomials up to the degree, relative to their size, at the points.
fn greatest_error(case: &Case, points: &[[f64; 2]]) -> (f64, String) {
    let degree = case.basis.degree();
    let mut scratch = Scratch::default();
    let mut greatest = (0.0, String::new());
    for &x in points {
        let values = case.basis.at(x, &mut scratch);
        for (i, j) in (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j))) {
            let coefficient = |function: u32| {
                let terms = case.basis.terms(function as usize);
                let at = |set: &[u32]| -> Vec<[f64; 2]> { set.iter().map(|&id| case.knots.at(id)).collect() };
                terms
                    .map(|(set, factor)| if degree == 0 { 1.0 } else { factor * polar(&at(set), i, j) })
                    .sum::<f64>()
            };
            let found: f64 = values.iter().map(|&(function, value)| value * coefficient(function)).sum();
            let scale = (1.0 + x[0].abs()).powi(i as i32) * (1.0 + x[1].abs()).powi(j as i32);
            let error = (found - x[0].powi(i as i32) * x[1].powi(j as i32)).abs() / scale;
            if error > greatest.0 || error.is_nan() {
                greatest = (error, format!("x^{i} y^{j} at {x:?}"));
            }
        }
    }
    greatest
}

fn check(degree: usize, count: usize) {
    for case in cases(degree).into_iter().chain(distorted(degree)) {
        assert_eq!(case.basis.degree(), degree);
        let (error, at) = greatest_error(&case, &case.points(7, count));
        assert!(error < 1e-13, "{}: {error:e} for {at}", case.name);
    }
}

#[test]
fn polar_forms_are_those_of_monomials() {
    let points = [[2.0, 3.0], [5.0, 7.0], [11.0, 13.0]];
    assert_eq!(polar(&points, 0, 0), 1.0);
    assert_eq!(polar(&points, 1, 0), 6.0);
    assert_eq!(polar(&points, 3, 0), 110.0);
    assert_eq!(polar(&points[..2], 1, 1), (2.0 * 7.0 + 5.0 * 3.0) / 2.0);
    assert_eq!(polar(&[[2.0, 3.0]; 3], 1, 2), 18.0);
}

#[test]
fn constants_are_reproduced_in_degree_0() {
    check(0, 1000);
}

#[test]
fn linear_functions_are_reproduced_in_degree_1() {
    check(1, 1000);
}

#[test]
fn polynomials_of_degree_2_are_reproduced() {
    check(2, 1000);
}

#[test]
fn polynomials_of_degree_3_are_reproduced() {
    check(3, 1000);
}
