//! Gradients and second derivatives.

use super::sets::{Case, cases};
use spmesh_splines::bases::{Basis, Jet, Scratch};

const STEP: f64 = 1.0 / (1 << 20) as f64;

fn jet(basis: &Basis, function: u32, x: [f64; 2]) -> Jet {
    let mut scratch = Scratch::default();
    let jets = basis.jets_at(x, &mut scratch);
    jets.iter().find(|(other, _)| *other == function).map_or(Jet::default(), |&(_, jet)| jet)
}

/// The unit of errors: the greatest derivative in the jets, at least 1.
fn scale(jets: &[Jet]) -> f64 {
    let of = |jet: &Jet| jet.gradient.iter().chain(&jet.hessian).map(|d| d.abs()).fold(1.0, f64::max);
    jets.iter().map(of).fold(1.0, f64::max)
}

/// Compares the jet at a point with difference quotients along both axes; `None` if a line through knots lies
/// between the points.
fn compare(case: &Case, function: u32, x: [f64; 2]) -> Option<()> {
    let here = jet(&case.basis, function, x);
    let beside = |axis: usize, sign: f64| {
        let mut y = x;
        y[axis] += sign * STEP;
        jet(&case.basis, function, y)
    };
    let around = [0, 1].map(|axis| [beside(axis, -1.0), beside(axis, 1.0)]);
    let all = [here, around[0][0], around[0][1], around[1][0], around[1][1]];
    let scale = scale(&all);
    // Second derivatives are constant in pieces of degree 2, and change little in those of degree 3.
    let (third, tolerance) = if case.basis.degree() > 2 { (1e3 * STEP, 1e3 * STEP) } else { (1e-9, 1e-6) };
    // Over a step, gradients change by second derivatives times its length; across lines through knots they
    // jump.
    let change = if case.basis.degree() > 1 { 4.0 * STEP } else { 1e-9 };
    let is_bent = |jet: &Jet| {
        (0..3).any(|i| (jet.hessian[i] - here.hessian[i]).abs() > third * scale)
            || (0..2).any(|i| (jet.gradient[i] - here.gradient[i]).abs() > change * scale)
    };
    if all.iter().any(is_bent) {
        return None;
    }
    for (axis, [less, more]) in around.into_iter().enumerate() {
        let slope = (more.value - less.value) / (2.0 * STEP);
        let error = (slope - here.gradient[axis]).abs();
        assert!(error < 1e-7 * scale, "{}: function {function} at {x:?}: slope {slope} {here:?}", case.name);
        for other in 0..2 {
            let bend = (more.gradient[other] - less.gradient[other]) / (2.0 * STEP);
            let error = (bend - here.hessian[axis + other]).abs();
            assert!(
                error < tolerance * scale,
                "{}: function {function} at {x:?}: bend {bend} {here:?}",
                case.name
            );
        }
    }
    Some(())
}

#[test]
fn derivatives_are_limits_of_differences() {
    for degree in 1..=3 {
        let (mut compared, mut tried) = (0, 0);
        for case in cases(degree) {
            let mut scratch = Scratch::default();
            for x in case.points(31, 12) {
                let alive: Vec<u32> =
                    case.basis.at(x, &mut scratch).iter().map(|&(function, _)| function).collect();
                for function in alive {
                    tried += 1;
                    compared += usize::from(compare(&case, function, x).is_some());
                }
            }
        }
        // Many of the points are on lines through knots and are not compared.
        assert!(4 * compared > tried, "degree {degree}: {compared} of {tried}");
    }
}

#[test]
fn jets_have_the_values_and_their_derivatives_sum_to_zero() {
    for degree in 0..=3 {
        for case in cases(degree) {
            let (mut of_values, mut of_jets) = (Scratch::default(), Scratch::default());
            for x in case.points(5, 60) {
                let values = case.basis.at(x, &mut of_values);
                let jets = case.basis.jets_at(x, &mut of_jets);
                assert_eq!(values.len(), jets.len(), "{} at {x:?}", case.name);
                let mut sum = Jet::default();
                let mut size: f64 = 1.0;
                for (&(function, value), &(other, jet)) in values.iter().zip(jets) {
                    assert_eq!(function, other);
                    assert!((value - jet.value).abs() < 1e-13, "{} at {x:?}: {value} {jet:?}", case.name);
                    sum += jet;
                    size = size.max(scale(&[jet]));
                }
                let derivatives = sum.gradient.iter().chain(&sum.hessian);
                let error = derivatives.map(|d| d.abs()).fold(0.0, f64::max);
                assert!(error < 1e-12 * size, "{} at {x:?}: {sum:?}", case.name);
            }
        }
    }
}
