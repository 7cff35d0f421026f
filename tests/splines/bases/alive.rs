//! The functions that are alive at a point, against all functions evaluated one by one by their definition as
//! sums.

use super::sets::{Case, cases};
use spmesh_configurations::{self as configurations, FARAWAY};
use spmesh_delaunay::predicates::area;
use spmesh_splines::bases::{Basis, Scratch, simplex_spline};
use std::collections::HashMap;

/// The value of the B-spline of a set of knots, and whether x is in the support of one of its terms.
fn b_spline(case: &Case, link: configurations::Link<'_>, x: [f64; 2]) -> (f64, bool) {
    let at = case.basis.limit_at(x);
    let (mut sum, mut is_alive) = (0.0, false);
    for [a, b] in link.edges().filter(|edge| !edge.contains(&FARAWAY)) {
        let knots: Vec<[f64; 2]> = link.set.iter().chain(&[a, b]).map(|&id| case.knots.at(id)).collect();
        let value = simplex_spline(&at, &knots);
        sum += area(x, case.knots.at(a), case.knots.at(b)) * value;
        is_alive |= value > 0.0 && case.knots.at(a) != case.knots.at(b);
    }
    (sum, is_alive)
}

fn check(degree: usize, count: usize) {
    for case in cases(degree) {
        let links = configurations::links(&case.knots, &case.configurations).expect("links");
        let numbers: HashMap<&[u32], u32> =
            (0..case.basis.len()).map(|i| (case.basis.terms(i).next().expect("a set").0, i as u32)).collect();
        let mut scratch = Scratch::default();
        for x in case.points(3, count).into_iter().chain([[1.3, 0.2], [-0.01, 0.5]]) {
            let values = case.basis.at(x, &mut scratch);
            assert!(values.is_sorted_by(|a, b| a.0 < b.0), "{} at {x:?}: {values:?}", case.name);
            let found: HashMap<u32, f64> = values.iter().copied().collect();
            for link in links.iter() {
                let (expected, is_alive) = b_spline(&case, link, x);
                let number = numbers.get(link.set).copied();
                let value = number.and_then(|number| found.get(&number));
                let error = (value.copied().unwrap_or(0.0) - expected).abs();
                assert!(error < 1e-13, "{}, {:?} at {x:?}: {value:?} {expected}", case.name, link.set);
                let of = format!("{}, {:?} at {x:?}", case.name, link.set);
                // At knots and on the border of a support, functions are alive with the value zero.
                assert!(is_alive || value.is_none_or(|value| value.abs() < 1e-14), "{of}");
                // Terms may cancel where knots coincide, and the terms of null links do.
                if !case.knots.has_copies() {
                    assert_eq!(number.is_none(), link.is_null(), "{of}");
                    assert!(value.is_some() || !is_alive || link.is_null(), "{of}");
                }
            }
        }
    }
}

#[test]
fn functions_of_degree_1_are_all_found() {
    check(1, 60);
}

#[test]
fn functions_of_degree_2_are_all_found() {
    check(2, 60);
}

#[test]
fn functions_of_degree_3_are_all_found() {
    check(3, 12);
}

#[test]
fn supports_and_greville_sites_are_where_functions_are() {
    for case in cases(2) {
        let mut scratch = Scratch::default();
        for function in 0..case.basis.len() {
            let [lower, upper] = case.basis.support(function).expect("a function that is not zero");
            let site = case.basis.greville(function);
            let (set, _) = case.basis.terms(function).next().expect("a set");
            let mean = [0, 1].map(|axis| (case.knots.at(set[0])[axis] + case.knots.at(set[1])[axis]) / 2.0);
            assert_eq!(site, mean, "{}", case.name);
            assert!(
                (0..2).all(|axis| lower[axis] <= site[axis] && site[axis] <= upper[axis]),
                "{}",
                case.name
            );
        }
        for x in case.points(8, 100) {
            for &(function, _) in case.basis.at(x, &mut scratch) {
                let [lower, upper] =
                    case.basis.support(function as usize).expect("a function that is not zero");
                assert!(
                    (0..2).all(|axis| lower[axis] <= x[axis] && x[axis] <= upper[axis]),
                    "{} {x:?}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn configurations_that_do_not_fit_are_errors() {
    let case = cases(2).swap_remove(0);
    let refused = |result: spmesh_base::error::Result<Basis>| result.expect_err("an error").to_string();
    let fewer = configurations::Knots::new(case.knots.points()[..20].to_vec()).expect("finite points");
    assert!(refused(Basis::new(&fewer, &case.configurations)).contains("unknown knot"));
    assert!(refused(Basis::of_triangles(&case.knots, &case.configurations)).contains("degree 1"));
    let start = configurations::delaunay(&case.knots).expect("triangles");
    assert!(refused(Basis::of_functions(&case.knots, &start, &[])).contains("degree 0"));
    let function = |set, factor| configurations::special::Function {
        kind: configurations::special::FunctionKind::Edge(set),
        terms: vec![(set, factor)],
    };
    let of = |functions: &[configurations::special::Function]| {
        refused(Basis::of_functions(&case.knots, &case.configurations, functions))
    };
    assert!(of(&[function([0, 2], 1.0)]).contains("function 0: knots 0 and 2 have no link"));
    let (set, _) = case.basis.terms(3).next().expect("a set");
    assert!(of(&[function([set[0], set[1]], f64::NAN)]).contains("function 0: a factor is not finite"));
    let great = configurations::Knots::new(case.knots.points().iter().map(|p| p.map(|c| c * 1e90)).collect())
        .expect("finite points");
    let start = configurations::delaunay(&great).expect("triangles");
    assert!(refused(Basis::new(&great, &start)).contains("scale them"));
}
