//! How far the value and the gradient of a spline jump.
//!
//! Where knots exclude a jump, there is none, and that is exact: the smoothness of a simplex spline across a
//! line follows from the number of its knots on the line, and exact predicates count them. Elsewhere a sum of
//! simplex splines may still be smooth, so both sides are evaluated, and the greatest difference is stated.

use super::layout::Layout;
use super::smoothness::{BESIDE, Candidate, PARTS, is_certainly_outside, places};
use crate::bases::{Jet, Scratch};
use spmesh_delaunay::predicates::Point2;

/// The jumps of a quantity across lines through knots.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Jump {
    /// Segments across which knots allow a jump. If there are none, that there is no jump is exact.
    pub segments: usize,
    /// The greatest jump that was found there; beside other jumps, this can be a rounding error.
    pub greatest: f64,
    /// Where it was found, in world coordinates; `None` if all differences are zero.
    pub at: Option<Point2>,
}

/// The jumps of a spline.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Jumps {
    /// Of the value. Units: those of elevations.
    pub value: Jump,
    /// Of the gradient: the magnitude of the difference. Units: those of elevations over those of
    /// coordinates.
    pub gradient: Jump,
}

impl Jumps {
    /// Compares both sides of all `candidates` at which a jump of value or gradient is possible.
    pub(super) fn of(layout: &Layout, coefficients: &[f64], candidates: &[Candidate]) -> Jumps {
        let (mut jumps, mut scratch) = (Jumps::default(), Scratch::default());
        let corners = layout.basis.domain_corners();
        for candidate in candidates.iter().filter(|candidate| candidate.order < 1) {
            let places = places_inside(layout, candidate);
            if places.is_empty() && is_certainly_outside(candidate, &corners) {
                continue;
            }
            jumps.gradient.segments += 1;
            jumps.value.segments += usize::from(candidate.order < 0);
            for (at, sides) in places {
                let [left, right] = sides
                    .map(|beside| moved(layout.basis.jet(coefficients, beside, &mut scratch), beside, at));
                let step = layout.frame.step();
                let [dx, dy] = [0, 1].map(|axis| left.gradient[axis] - right.gradient[axis]);
                let world = layout.frame.to_decimal(at);
                jumps.gradient.take(dx.hypot(dy) / step, world);
                if candidate.order < 0 {
                    jumps.value.take((left.value - right.value).abs(), world);
                }
            }
        }
        jumps
    }
}

impl Jump {
    fn take(&mut self, found: f64, at: Point2) {
        if found > self.greatest {
            (self.greatest, self.at) = (found, Some(at));
        }
    }
}

/// Places on a segment, each with the places on both sides of it, all in the domain.
fn places_inside(layout: &Layout, candidate: &Candidate) -> Vec<(Point2, [Point2; 2])> {
    let of = |part: f64| {
        let at = |beside: f64| places(candidate.ends, part, beside);
        (at(0.0), [at(BESIDE), at(-BESIDE)])
    };
    let is_inside = |found: &(Point2, [Point2; 2])| found.1.iter().all(|&at| layout.basis.is_in_domain(at));
    PARTS.iter().map(|&part| of(part)).filter(is_inside).collect()
}

/// The jet at `to` of the polynomial of degree 2 that has a jet at `from`.
fn moved(jet: Jet, from: Point2, to: Point2) -> Jet {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let ([p, q], [r, s, t]) = (jet.gradient, jet.hessian);
    Jet {
        value: jet.value + p * x + q * y + 0.5 * (r * x * x + 2.0 * s * x * y + t * y * y),
        gradient: [p + r * x + s * y, q + s * x + t * y],
        ..jet
    }
}
