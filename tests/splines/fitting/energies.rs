//! The thin-plate energy against known integrals, and against sums over many points.

use super::bases::{cubic, grid, pulled_apart};
use super::random_knots::{Border, over, random_points};
use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_reference::sets::Random;
use spmesh_splines::bases::{Basis, Scratch};
use spmesh_splines::fitting::{bending, control_bending, interpolate, thin_plate};

/// The energy of a spline on the unit square, by the midpoint rule.
fn by_midpoints(basis: &Basis, coefficients: &[f64], side: usize) -> f64 {
    let mut scratch = Scratch::default();
    let at = |i: usize| (i as f64 + 0.5) / side as f64;
    let mut sum = 0.0;
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let mut bend = [0.0; 3];
        for (function, jet) in basis.jets_at([at(i), at(j)], &mut scratch) {
            let factor = coefficients[*function as usize];
            (0..3).for_each(|k| bend[k] += factor * jet.hessian[k]);
        }
        sum += bend[0] * bend[0] + 2.0 * bend[1] * bend[1] + bend[2] * bend[2];
    }
    sum / (side * side) as f64
}

/// Knots along a spiral, with the corners of the unit square.
fn sunflower(count: usize) -> Vec<[f64; 2]> {
    let on_spiral = |i: usize| {
        let (radius, angle) = (0.45 * ((i as f64 + 0.5) / count as f64).sqrt(), 2.399_963 * i as f64);
        [0.5 + radius * angle.cos(), 0.5 + radius * angle.sin()]
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    corners.into_iter().chain((0..count).map(on_spiral)).collect()
}

fn check_polynomials(basis: &Basis, tolerance: f64) {
    let energy = thin_plate(basis).expect("an energy");
    for (f, expected) in [
        ((|[x, y]| 2.0 * x - y + 3.0) as fn([f64; 2]) -> f64, 0.0),
        (|[x, _]| x * x, 4.0),
        (|[x, y]| x * y, 2.0),
        (|[x, y]| x * x - 3.0 * x * y + 0.5 * y * y, 4.0 + 18.0 + 1.0),
    ] {
        let coefficients = interpolate(basis, f).expect("a spline");
        let found = energy.form(&coefficients);
        assert!((found - expected).abs() < tolerance, "{found}, {expected}");
    }
}

#[test]
fn energies_of_quadratic_polynomials_are_exact() {
    check_polynomials(&pulled_apart(&grid(5, 0.2)), 1e-8);
    check_polynomials(&pulled_apart(&grid(4, 0.0)), 1e-10);
}

#[test]
fn energies_of_splines_are_those_of_many_points() {
    // Knots on lines, and knots far from lines. If knots are nearly collinear, second derivatives are large
    // on narrow triangles.
    for (basis, tolerance) in [
        (pulled_apart(&grid(4, 0.0)), 0.01),
        (pulled_apart(&sunflower(20)), 0.01),
        (cubic(&grid(3, 0.2)), 0.01),
    ] {
        let energy = thin_plate(&basis).expect("an energy");
        let mut random = Random::new(6);
        for _ in 0..3 {
            let coefficients: Vec<f64> = (0..basis.len()).map(|_| random.unit()).collect();
            let (found, expected) = (energy.form(&coefficients), by_midpoints(&basis, &coefficients, 300));
            assert!((found / expected - 1.0).abs() < tolerance, "{found}, {expected}");
        }
    }
}

/// The energies of all functions, each alone, on the part of the domain in the unit square, by the midpoint
/// rule.
fn each_by_midpoints(basis: &Basis, side: usize) -> Vec<f64> {
    let (mut scratch, mut energies) = (Scratch::default(), vec![0.0; basis.len()]);
    let at = |i: usize| (i as f64 + 0.5) / side as f64;
    let places = (0..side).flat_map(|j| (0..side).map(move |i| [at(i), at(j)]));
    for x in places.filter(|&x| basis.is_in_domain(x)) {
        for (function, jet) in basis.jets_at(x, &mut scratch) {
            let [xx, xy, yy] = jet.hessian;
            energies[*function as usize] += (xx * xx + 2.0 * xy * xy + yy * yy) / (side * side) as f64;
        }
    }
    energies
}

#[test]
fn energies_end_at_the_border_of_the_domain() {
    // The border of the domain of free knots is on lines through knots, along sides of triangles on which
    // second derivatives are constant. Triangles cut there must not lose what is inside.
    for seed in [30, 44, 56] {
        let basis = over(&random_points(50, seed), 2, Border::Free);
        let energy = thin_plate(&basis).expect("an energy");
        for (found, expected) in energy.diagonal().zip(each_by_midpoints(&basis, 1_000)) {
            // The midpoint rule misses what is narrower than its steps.
            let narrow = 0.01 * energy.trace() / basis.len() as f64;
            assert!((found - expected).abs() < 0.2 * expected + narrow, "{seed}: {found}, {expected}");
        }
    }
}

#[test]
fn only_the_domain_counts() {
    // Without copies of knots the domain is smaller than the hull. Outside of it, splines do not reproduce
    // polynomials.
    let knots = Knots::new(grid(6, 0.2)).expect("finite points");
    let start = configurations::delaunay(&knots).expect("triangles");
    let degree_1 = configurations::link_triangulate(&knots, &start, &Rule::Delaunay).expect("links");
    let basis = Basis::new(&knots, &degree_1).expect("a basis");
    let energy = thin_plate(&basis).expect("an energy");
    let plane: Vec<f64> = (0..basis.len()).map(|i| basis.greville(i)).map(|[x, y]| 5.0 * x - y).collect();
    assert!(energy.form(&plane).abs() < 1e-9, "{}", energy.form(&plane));
    assert!(energy.trace() > 1.0);
}

#[test]
fn control_meshes_bend_for_all_but_planes() {
    let knots = Knots::new(grid(3, 0.2)).expect("finite points");
    let linear = Basis::new(&knots, &configurations::delaunay(&knots).expect("triangles")).expect("a basis");
    let quadratic = pulled_apart(&sunflower(30));
    for basis in [&linear, &quadratic, &cubic(&grid(2, 0.2))] {
        let energy = bending(basis).expect("an energy");
        let place = |function: usize| basis.greville(function);
        let plane: Vec<f64> = (0..basis.len()).map(place).map(|[x, y]| 5.0 + 3.0 * x - 2.0 * y).collect();
        // The coefficients of a plane cancel each other, except for rounding.
        let alone: f64 = energy.diagonal().zip(&plane).map(|(entry, c)| entry * c * c).sum();
        assert!(energy.form(&plane).abs() < 1e-15 * alone, "{} of {alone}", energy.form(&plane));
        // The bend of each coefficient alone is larger than rounding errors.
        for function in 0..basis.len() {
            let mut one = vec![0.0; basis.len()];
            one[function] = 1.0;
            assert!(energy.form(&one) > 1e-4, "{function}");
        }
    }
}

#[test]
fn control_meshes_of_flat_triangles_are_not_stiff() {
    // The sites are almost collinear: triangles between them have areas as small as rounding errors.
    let places = [[0.0, 1e-16], [1.0, 0.0], [2.0, 0.0], [3.0, 1e-16], [1.5, 2.0]];
    let knots = Knots::new(places.to_vec()).expect("finite points");
    let linear = Basis::new(&knots, &configurations::delaunay(&knots).expect("triangles")).expect("a basis");
    let energy = control_bending(&linear).expect("an energy");
    assert!(energy.diagonal().all(|entry| entry > 0.0 && entry < 10.0), "{:?}", energy);
    assert!(energy.form(&[1.0, 2.0, 3.0, 4.0, 2.5]) < 1e-9);
    assert!(energy.form(&[0.0, 1.0, 0.0, 0.0, 0.0]) > 0.01);
}

#[test]
fn knots_in_line_but_for_rounding_are_not_stiff() {
    // A turned grid: rounding moves knots off its lines.
    let turned = |[x, y]: [f64; 2]| [0.8 * x - 0.6 * y + 100.0, 0.6 * x + 0.8 * y + 300.0];
    let basis = pulled_apart(&grid(6, 0.0).into_iter().map(turned).collect::<Vec<_>>());
    let energy = bending(&basis).expect("an energy");
    let greatest = energy.diagonal().fold(0.0, f64::max);
    let least = energy.diagonal().fold(f64::INFINITY, f64::min);
    assert!(least > 0.0 && greatest < 1e6 * least, "{least}, {greatest}");
    let places = (0..basis.len()).map(|function| basis.greville(function));
    let plane: Vec<f64> = places.map(|[x, y]| 2.0 * x - y).collect();
    assert!(energy.form(&plane).abs() < 1e-6 * greatest);
}
