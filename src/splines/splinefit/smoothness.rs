//! Where splines are less smooth than their degree allows, and how far value and gradient jump there.
//!
//! A function of degree k is a sum of simplex splines of k + 3 knots each. A simplex spline has k + 1 - m
//! continuous derivatives across a line through m of its knots: k - 1 across most lines, fewer where knots
//! are repeated or more than two are on the line. A sum may be smoother, as box splines are, and tents of
//! knots that are pulled apart. So segments between such knots are only *candidates*; for degree 2,
//! derivatives on both sides of each candidate are compared.
//!
//! Source: Micchelli 1979; thesis 6.1.
//!
//! Where knots exclude a jump, there is none, and that is exact: the smoothness of a simplex spline across a
//! line follows from the number of its knots on the line, and exact predicates count them. Elsewhere a sum of
//! simplex splines may still be smooth, so both sides are evaluated, and the greatest difference is stated.

use super::layout::Layout;
use crate::bases::{Jet, Scratch};
use spmesh_base::error::Result;
use spmesh_configurations::{self as configurations, Rule};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};

/// Parts of a segment at which derivatives are compared. They are not simple fractions, at which other lines
/// may cross.
pub(super) const PARTS: [f64; 3] = [0.216_541, 0.487_312, 0.809_733];
/// Distance of the places of comparison from the segment, relative to its length: functions are one
/// polynomial from there to the segment, unless another knot line is closer.
pub(super) const BESIDE: f64 = 1e-5;
/// Smaller changes of a derivative, relative to the magnitude of functions there, are rounding errors.
const CHANGE_MIN: f64 = 1e-4;

/// A segment across which derivatives may jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Its ends, in stored coordinates.
    pub ends: [Point2; 2],
    /// Number of derivatives that are certainly continuous; -1 if values may jump.
    pub order: i32,
}

/// How smooth the functions of a layout are.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothness {
    /// Number of continuous derivatives across all lines that have no candidate.
    pub order: i32,
    /// Segments with possibly fewer.
    pub candidates: Vec<Candidate>,
    /// For degree 2, the candidates across which the value or gradient of some function jumps.
    pub folds: Option<Vec<Candidate>>,
    /// The jumps of the spline; `None` without coefficients.
    pub jumps: Option<Jumps>,
}

impl Smoothness {
    /// Examines all functions inside their domain, and the spline if there are coefficients.
    ///
    /// # Errors
    /// As [`configurations::link_triangulate`].
    pub fn of(layout: &Layout, coefficients: Option<&[f64]>) -> Result<Smoothness> {
        let degree = layout.basis.degree();
        // Gradients of splines of degree 1 jump across all lines through two knots.
        let mut candidates = candidates(layout, if degree == 1 { 2 } else { 3 })?;
        let jumps = coefficients.map(|coefficients| Jumps::of(layout, coefficients, &candidates));
        candidates.retain(|candidate| candidate.order < degree as i32 - 1);
        candidates.retain(|candidate| is_inside(layout, candidate));
        let folds = (degree == 2).then(|| {
            let mut scratch = Scratch::default();
            let mut is_fold = |candidate: &&Candidate| folds_at(layout, candidate, &mut scratch);
            candidates.iter().filter(&mut is_fold).copied().collect()
        });
        Ok(Smoothness { order: degree as i32 - 1, candidates, folds, jumps })
    }
}

/// Segments between knots on lines through at least `least` knots of a simplex spline, each with its least
/// order.
fn candidates(layout: &Layout, least: usize) -> Result<Vec<Candidate>> {
    let knots = &layout.knots;
    let next = configurations::link_triangulate(knots, &layout.configurations, &Rule::Delaunay)?;
    let (mut found, mut predicates) = (Vec::new(), FiniteFloatPredicates::default());
    for (boundary, interior) in next.iter() {
        let [a, b, c] = boundary.map(|id| knots.at(id));
        // Configurations without area have no part in functions.
        if predicates.orient2d(a, b, c) == Sign::Zero {
            continue;
        }
        let all: Vec<Point2> = boundary.iter().chain(interior).map(|&id| knots.at(id)).collect();
        lines(&all, least, &mut predicates, &mut found);
    }
    found.sort_by(|p: &Candidate, q| {
        let ends = |at: usize| lexicographic(p.ends[at], q.ends[at]);
        ends(0).then_with(|| ends(1)).then(p.order.cmp(&q.order))
    });
    found.dedup_by(|later, first| later.ends == first.ends);
    Ok(found)
}

/// The lines through at least `least` of the knots of one simplex spline.
fn lines(all: &[Point2], least: usize, predicates: &mut impl Predicates2, found: &mut Vec<Candidate>) {
    for (place, &p) in all.iter().enumerate() {
        for &q in all[place + 1..].iter().filter(|&&q| q != p) {
            let on: Vec<Point2> =
                all.iter().copied().filter(|&r| predicates.orient2d(p, q, r) == Sign::Zero).collect();
            if on.len() >= least {
                let first = |a: Point2, b: Point2| if lexicographic(a, b).is_le() { a } else { b };
                let last = |a: Point2, b: Point2| if lexicographic(a, b).is_gt() { a } else { b };
                let ends = [on.iter().copied().fold(p, first), on.iter().copied().fold(p, last)];
                found.push(Candidate { ends, order: all.len() as i32 - 2 - on.len() as i32 });
            }
        }
    }
}

/// The place at a part of a segment, moved to its left by `beside` times its length.
pub(super) fn places([p, q]: [Point2; 2], part: f64, beside: f64) -> Point2 {
    let along = [q[0] - p[0], q[1] - p[1]];
    [p[0] + part * along[0] - beside * along[1], p[1] + part * along[1] + beside * along[0]]
}

/// Whether there are places inside the domain on both sides of a segment.
fn is_inside(layout: &Layout, candidate: &Candidate) -> bool {
    let is_in = |part: f64, beside: f64| layout.basis.is_in_domain(places(candidate.ends, part, beside));
    PARTS.iter().any(|&part| is_in(part, 2.0 * BESIDE) && is_in(part, -2.0 * BESIDE))
}

/// Whether a segment lies on the border of the domain, a convex polygon with these corners in
/// counterclockwise order, or outside of it. This is exact for the given corners.
pub(super) fn is_certainly_outside(candidate: &Candidate, corners: &[Point2]) -> bool {
    let mut predicates = FiniteFloatPredicates::default();
    (0..corners.len()).any(|from| {
        let (a, b) = (corners[from], corners[(from + 1) % corners.len()]);
        a != b && candidate.ends.iter().all(|&end| predicates.orient2d(a, b, end) != Sign::Positive)
    })
}

/// Whether the value or the gradient of a function changes across a segment.
///
/// Functions are polynomials of degree 2 next to the segment unless another knot line is close. So their
/// gradients are linear, and two places on one side give the limit at the segment by extrapolation.
fn folds_at(layout: &Layout, candidate: &Candidate, scratch: &mut Scratch) -> bool {
    let basis = &layout.basis;
    let [p, q] = candidate.ends;
    let length = ((q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)).sqrt();
    PARTS.iter().any(|&part| {
        let at = |beside: f64| places(candidate.ends, part, beside);
        if ![-2.0 * BESIDE, 2.0 * BESIDE].iter().all(|&beside| basis.is_in_domain(at(beside))) {
            return false;
        }
        let mut side = |side: f64| Side {
            near: basis.jets_at(at(side * BESIDE), scratch).to_vec(),
            far: basis.jets_at(at(2.0 * side * BESIDE), scratch).to_vec(),
        };
        let (left, right) = (side(1.0), side(-1.0));
        let mut functions: Vec<u32> = left.near.iter().chain(&right.near).map(|jet| jet.0).collect();
        functions.sort_unstable();
        functions.dedup();
        functions.iter().any(|&function| {
            let (a, b) = (left.gradient(function), right.gradient(function));
            // Functions are at most about one, so a gradient of one over the length is large.
            let change = ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt() * length;
            let step = (left.value(function) - right.value(function)).abs();
            change > CHANGE_MIN || step > CHANGE_MIN
        })
    })
}

/// The functions alive at two places on one side of a segment, `far` at twice the distance of `near`.
struct Side {
    near: Vec<(u32, Jet)>,
    far: Vec<(u32, Jet)>,
}

impl Side {
    fn value(&self, function: u32) -> f64 {
        jet_of(&self.near, function).value
    }

    /// The gradient of a function, extrapolated to the segment.
    fn gradient(&self, function: u32) -> [f64; 2] {
        let (near, far) = (jet_of(&self.near, function).gradient, jet_of(&self.far, function).gradient);
        [0, 1].map(|axis| 2.0 * near[axis] - far[axis])
    }
}

fn jet_of(jets: &[(u32, Jet)], function: u32) -> Jet {
    jets.iter().find(|jet| jet.0 == function).map_or(Jet::default(), |jet| jet.1)
}

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
