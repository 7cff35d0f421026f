//! Attributes of surfaces, and words for the smoothing.

use spmesh_splines::bases::Jet;
use spmesh_splines::splinefit::{Attribute, Smoothing};

fn plane(p: f64, q: f64) -> Jet {
    Jet { value: 1.0, gradient: [p, q], hessian: [0.0; 3] }
}

#[test]
fn slopes_face_where_water_flows() {
    for (p, q, aspect) in [(0.0, -1.0, 0.0), (-1.0, 0.0, 90.0), (0.0, 1.0, 180.0), (1.0, 0.0, 270.0)] {
        assert!((Attribute::Slope.of(&plane(p, q)) - 45.0).abs() < 1e-12);
        assert!((Attribute::Aspect.of(&plane(p, q)) - aspect).abs() < 1e-12, "{p} {q}");
    }
    assert!(Attribute::Aspect.of(&plane(0.0, 0.0)).is_nan());
    assert_eq!(Attribute::Slope.of(&plane(0.0, 0.0)), 0.0);
}

#[test]
fn spheres_have_the_curvature_of_their_radius() {
    // The upper half of a sphere of radius 5, at a place off its axes.
    let (radius, x, y) = (5f64, 1.0, -2.5);
    let z = (radius * radius - x * x - y * y).sqrt();
    let second = |a: f64, b: f64, same: f64| -same / z - a * b / (z * z * z);
    let hessian = [second(x, x, 1.0), second(x, y, 0.0), second(y, y, 1.0)];
    let jet = Jet { value: z, gradient: [-x / z, -y / z], hessian };
    for attribute in [Attribute::ProfileCurvature, Attribute::TangentialCurvature] {
        assert!((attribute.of(&jet) - 1.0 / radius).abs() < 1e-14, "{attribute:?}");
        assert!(attribute.of(&plane(0.0, 0.0)).is_nan());
    }
}

#[test]
fn cylinders_bend_in_one_direction() {
    // z = -x^2 / 2 at x = 1: steepest along x, where it bends by 1 / (1 + 1)^1.5.
    let jet = Jet { value: -0.5, gradient: [-1.0, 0.0], hessian: [-1.0, 0.0, 0.0] };
    assert!((Attribute::ProfileCurvature.of(&jet) - 0.125f64.sqrt()).abs() < 1e-15);
    assert_eq!(Attribute::TangentialCurvature.of(&jet), 0.0);
    // z = x - y^2 / 2 at y = 0: across the slope it bends by 1 / sqrt(2).
    let jet = Jet { value: 0.0, gradient: [1.0, 0.0], hessian: [0.0, 0.0, -1.0] };
    assert_eq!(Attribute::ProfileCurvature.of(&jet), 0.0);
    assert!((Attribute::TangentialCurvature.of(&jet) - 0.5f64.sqrt()).abs() < 1e-15);
    assert_eq!(Vec::from_iter(Attribute::Gradient.all(&jet)), [1.0, 0.0]);
}

#[test]
fn smoothing_is_a_number_or_a_method() {
    for (text, expected) in [
        ("0", Smoothing::Lambda(0.0)),
        ("2.5e-3", Smoothing::Lambda(0.0025)),
        ("reml", Smoothing::Likelihood),
        ("gcv", Smoothing::Generalised),
        ("cv", Smoothing::Folds(5)),
        ("cv:10", Smoothing::Folds(10)),
    ] {
        assert_eq!(text.parse(), Ok(expected));
    }
    for text in ["", "-1", "nan", "inf", "cv:", "cv:1", "gcv:3", "ml"] {
        assert!(text.parse::<Smoothing>().is_err(), "{text}");
    }
}
