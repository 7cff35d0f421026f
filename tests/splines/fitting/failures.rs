//! Fits that are impossible: the error says why and where.

use super::bases::{ONE, cubic, grid, pulled_apart, scattered};
use super::fits::{least_squares, robust};
use super::random_knots::{Border, over};
use spmesh_configurations::special::{Features, features};
use spmesh_configurations::{self as configurations, Knots};
use spmesh_splines::bases::Basis;
use spmesh_splines::fitting::{
    Equations, Interpolation, Loss, Mesh, NormalEquations, Observation, bending, for_each_residual,
    generalised_cross_validation, interpolate, restricted_likelihood, thin_plate,
};

fn message<T>(result: spmesh_base::error::Result<T>) -> String {
    match result {
        Ok(_) => panic!("no error"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn functions_without_observations_are_named() {
    let basis = pulled_apart(&grid(6, 0.2));
    let mut all = scattered(4_000, 5, |[x, y]| x + y);
    all.retain(|one| one.point[0] < 0.5);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    let equations = Equations::new(&basis, &normal, None).expect("equations");
    let found = equations.undetermined(0.0).expect("functions");
    assert!(!found.is_empty() && found.windows(2).all(|pair| pair[0].function < pair[1].function));
    for weak in &found {
        assert_eq!(weak.site, basis.greville(weak.function));
        assert!(weak.site[0] > 0.4, "{weak:?}");
    }
    let far = (0..basis.len()).filter(|&i| basis.greville(i)[0] > 0.8);
    assert!(far.clone().count() > 0 && far.into_iter().all(|i| found.iter().any(|weak| weak.function == i)));
    let said = message(equations.solve(0.0));
    let [x, y] = found[0].site;
    assert!(said.contains(&format!("{} of {}", found.len(), basis.len())), "{said}");
    assert!(said.contains(&format!("{x} {y}")) && said.contains("lambda"), "{said}");
}

#[test]
fn too_few_observations_are_not_enough() {
    let basis = pulled_apart(&grid(3, 0.2));
    let one = vec![Observation::new([0.5, 0.5], 1.0)];
    assert!(message(least_squares(&basis, &one, 0.0, ONE)).contains("not determined"));
    assert!(message(least_squares(&basis, &one, 1.0, ONE)).contains("on one line"), "a plane has three");
    let three: Vec<Observation> =
        [[0.1, 0.1], [0.9, 0.2], [0.3, 0.8]].map(|x| Observation::new(x, x[0])).to_vec();
    let coefficients = least_squares(&basis, &three, 1e-5, ONE).expect("a plane");
    for (function, c) in coefficients.iter().enumerate() {
        assert!((c - basis.greville(function)[0]).abs() < 1e-6);
    }
}

/// Splines over a grid with clamped corners, or with the border pulled apart, of degrees 1 to 3.
fn over_grids() -> [Basis; 3] {
    let points = grid(2, 0.0);
    [over(&points, 1, Border::Clamped), pulled_apart(&grid(6, 0.2)), cubic(&points)]
}

#[test]
fn observations_on_a_line_are_refused_whatever_lambda() {
    let at = |i: i32| 0.02 * f64::from(i);
    for basis in over_grids() {
        let energy = bending(&basis).expect("an energy");
        for place in [|x| [x, x], |x| [x, 0.5], |x| [0.3 * x + 0.1, 0.7 - 0.6 * x], |_| [0.3, 0.6]]
            as [fn(f64) -> [f64; 2]; 4]
        {
            let line: Vec<_> = (0..50).map(|i| Observation::new(place(at(i)), 1.0 + at(i))).collect();
            let normal = NormalEquations::of(&basis, &line, ONE).expect("equations");
            let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
            for lambda in [0.0, 1e-15, 1e-6, 1e-3, 1.0, 1e9] {
                let said = message(equations.solve(lambda));
                assert!(said.contains("50 observations in the domain are on one line"), "{lambda}: {said}");
            }
            assert!(message(restricted_likelihood(&equations, None)).contains("on one line"));
            assert!(message(generalised_cross_validation(&equations, None)).contains("on one line"));
        }
        // A thousandth of the domain aside is enough.
        let mut near: Vec<_> = (0..50).map(|i| Observation::new([at(i), 0.5], at(i))).collect();
        near.push(Observation::new([0.5, 0.501], 0.501));
        let normal = NormalEquations::of(&basis, &near, ONE).expect("equations");
        let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
        let found = equations.solve(normal.default_lambda(&basis)).expect("coefficients");
        for (function, c) in found.iter().enumerate() {
            let [x, y] = basis.greville(function);
            assert!((c - x - (y - 0.5)).abs() < 1e-3, "{c} at {x} {y}");
        }
    }
}

#[test]
fn observations_elsewhere_are_counted() {
    let basis = pulled_apart(&grid(3, 0.2));
    let mut all = scattered(500, 5, |[x, y]| x - y);
    all.iter_mut().take(100).for_each(|one| one.point[0] += 2.0);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    assert_eq!((normal.count, normal.outside), (400, 100));
    all.iter_mut().for_each(|one| one.point[1] += 7.0);
    let said = message(least_squares(&basis, &all, 0.0, ONE));
    assert!(said.contains("none of 500 observations"), "{said}");
    let nothing: Vec<Observation> = Vec::new();
    assert!(message(least_squares(&basis, &nothing, 0.0, ONE)).contains("no observations"));
    assert!(message(robust(&basis, &nothing, Loss::Huber, None, 0.0, ONE)).contains("no observations"));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let basis = pulled_apart(&grid(2, 0.2));
    let good = scattered(100, 5, |[x, y]| x - y);
    for (bad, part) in [
        (Observation { weight: f64::NAN, ..good[0] }, "weight NaN"),
        (Observation { weight: -1.0, ..good[0] }, "weight -1"),
        (Observation { weight: f64::INFINITY, ..good[0] }, "weight inf"),
        (Observation { value: f64::NAN, ..good[0] }, "value is not finite"),
        (Observation { point: [0.5, f64::INFINITY], ..good[0] }, "coordinate is not finite"),
    ] {
        let mut all = good.clone();
        all[63] = bad;
        let said = message(least_squares(&basis, &all, 0.0, ONE));
        assert!(said.contains("observation 63") && said.contains(part), "{said}");
    }
    let normal = NormalEquations::of(&basis, &good, ONE).expect("equations");
    let energy = thin_plate(&basis).expect("an energy");
    let equations = Equations::new(&basis, &normal, Some(&energy)).expect("equations");
    assert!(message(equations.solve(-1.0)).contains("lambda -1"));
    assert!(message(equations.solve(f64::NAN)).contains("lambda NaN"));
    let plain = Equations::new(&basis, &normal, None).expect("equations");
    assert!(message(plain.solve(1.0)).contains("no energy"));
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let (basis, other) = (pulled_apart(&grid(2, 0.2)), pulled_apart(&grid(3, 0.2)));
    let all = scattered(100, 5, |[x, y]| x - y);
    let normal = NormalEquations::of(&basis, &all, ONE).expect("equations");
    assert!(message(Equations::new(&other, &normal, None)).contains("other functions"));
    assert!(message(for_each_residual(&basis, &[1.0], &all, ONE, |_| ())).contains("1 coefficients"));
    let interpolation = Interpolation::new(&basis).expect("sites");
    assert!(message(interpolation.of_values(&[1.0])).contains("1 values"));
    assert!(message(interpolate(&basis, |[x, _]| if x > 0.7 { f64::NAN } else { x })).contains("site"));
    assert!(message(Mesh::of(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])).contains("line"));
}

#[test]
fn degrees_that_cannot_be_smoothed_are_refused() {
    let knots = Knots::new(grid(3, 0.2)).expect("finite points");
    let start = configurations::delaunay(&knots).expect("triangles");
    let linear = Basis::new(&knots, &start).expect("a basis");
    assert!(message(thin_plate(&linear)).contains("degree 1"));
    assert!(thin_plate(&cubic(&grid(2, 0.2))).is_ok());
}

#[test]
fn sites_that_depend_on_each_other_are_named() {
    // One function is listed twice.
    let knots = Knots::new(grid(3, 0.2)).expect("finite points");
    let special =
        features(&knots, &Features { corners: (0..16).collect(), ..Features::default() }).expect("knots");
    let all = special.generate(&configurations::Rule::Delaunay, 1).expect("configurations");
    let mut functions = special
        .functions(&configurations::links(&special.knots, &all[1]).expect("links"))
        .expect("functions");
    functions.push(functions[0].clone());
    let basis = Basis::of_functions(&special.knots, &all[1], &functions).expect("a basis");
    let said = message(Interpolation::new(&basis));
    assert!(said.contains("site") && said.contains("one Greville site"), "{said}");
}
