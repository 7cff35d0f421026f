//! Interpolation at Greville sites.

use super::bases::{dense, deviation, grid, pulled_apart, solve_dense, value};
use spmesh_splines::fitting::{Interpolation, Mesh, interpolate};

#[test]
fn polynomials_of_degree_2_are_reproduced() {
    let basis = pulled_apart(&grid(5, 0.2));
    for f in [
        (|_| 1.0) as fn([f64; 2]) -> f64,
        |[x, y]| 3.0 * x - 2.0 * y,
        |[x, y]| x * x - 5.0 * x * y + 0.5 * y * y - 7.0,
    ] {
        let coefficients = interpolate(&basis, f).expect("a spline");
        let error = deviation(&basis, &coefficients, 57, f);
        assert!(error < 1e-12, "{error}");
    }
}

#[test]
fn values_are_taken_at_sites() {
    let basis = pulled_apart(&grid(6, 0.3));
    let f = |[x, y]: [f64; 2]| (9.0 * x).sin() * (7.0 * y).cos();
    let coefficients = interpolate(&basis, f).expect("a spline");
    for site in (0..basis.len()).map(|function| basis.greville(function)) {
        assert!((value(&basis, &coefficients, site) - f(site)).abs() < 1e-12, "{site:?}");
    }
    let sites = (0..basis.len()).map(|function| basis.greville(function));
    let expected = solve_dense(dense(&basis, sites.clone()), sites.map(f).collect());
    let error = coefficients.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-11, "{error}");
}

#[test]
fn conditions_are_those_of_the_inverse() {
    let basis = pulled_apart(&grid(4, 0.25));
    let interpolation = Interpolation::new(&basis).expect("sites");
    let sites = (0..basis.len()).map(|function| basis.greville(function));
    let rows = dense(&basis, sites);
    let count = basis.len();
    let unit = |at: usize| (0..count).map(|i| if i == at { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    let inverse: Vec<Vec<f64>> = (0..count).map(|at| solve_dense(rows.clone(), unit(at))).collect();
    let norm = |column: usize| rows.iter().map(|row| row[column].abs()).sum::<f64>();
    let of_matrix = (0..count).map(norm).fold(0.0, f64::max);
    let of_inverse =
        inverse.iter().map(|column| column.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    let (found, exact) = (interpolation.condition_1(), of_matrix * of_inverse);
    assert!(found <= exact * (1.0 + 1e-12) && found > 0.3 * exact, "{found}, {exact}");
    let of_both = interpolation.condition_2().expect("few functions");
    let frobenius = |m: &[Vec<f64>]| m.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    assert!(of_both >= 1.0 && of_both <= frobenius(&rows) * frobenius(&inverse), "{of_both}");
}

#[test]
fn values_between_points_are_linear() {
    let points = grid(7, 0.3);
    let values: Vec<f64> = points.iter().map(|[x, y]| 2.0 - x + 4.0 * y).collect();
    let mesh = Mesh::of(points.clone()).expect("triangles");
    let mut near = 0;
    for &[x, y] in grid(12, 0.2).iter().chain(&points) {
        let found = mesh.interpolate(&values, [x, y], &mut near).expect("inside");
        assert!((found - (2.0 - x + 4.0 * y)).abs() < 1e-14);
    }
    for outside in [[-1e-9, 0.5], [0.5, 1.1], [3.0, -8.0]] {
        assert_eq!(mesh.interpolate(&values, outside, &mut near), None);
    }
    assert!(
        mesh.interpolate(&values, [0.5, 0.5], &mut near).is_some(),
        "a walk that has left the hull goes on"
    );
}

#[test]
fn values_at_sites_come_from_points() {
    let basis = pulled_apart(&grid(5, 0.2));
    let plane = |[x, y]: [f64; 2]| 3.0 * x - y + 1.0;
    let points = grid(9, 0.3);
    let values: Vec<f64> = points.iter().map(|&point| plane(point)).collect();
    let interpolation = Interpolation::new(&basis).expect("sites");
    let mesh = Mesh::of(points.clone()).expect("triangles");
    let coefficients = interpolation.of_points(&mesh, &values).expect("a spline");
    assert!(deviation(&basis, &coefficients, 31, plane) < 1e-12);
    let inner = Mesh::of(points.iter().map(|x| x.map(|c| 0.1 + 0.8 * c)).collect()).expect("triangles");
    let sites = (0..basis.len()).map(|function| basis.greville(function));
    let outside = sites.filter(|site| site.iter().any(|&c| !(0.1..=0.9).contains(&c))).count();
    let said = interpolation.of_points(&inner, &values).expect_err("sites outside").to_string();
    assert!(said.contains(&format!("{outside} of {}", basis.len())) && said.contains("site 0 0"), "{said}");
    assert!(interpolation.of_points(&mesh, &values[1..]).is_err());
}
