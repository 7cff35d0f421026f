//! Simplex splines and their derivatives, by the recurrence of Micchelli (thesis 6.2.1).
//!
//! Normalisation: `M(x | T)` is one over the area of the triangle T inside of it, and the recurrence has no
//! further factor. So the integral of M is one over the binomial coefficient of k + 2 over 2. (The thesis's
//! geometric definition has integral one, and the base case that it prints lacks the area.)
//!
//! The recurrence may choose any three knots. Here they are the corners of the largest triangle that contains
//! x. Then all terms are positive and nothing cancels, so with accurate areas (`area`) the value is accurate,
//! too, however flat sets of knots are.

use std::ops::{Add, AddAssign, Mul};

use super::directional_limit::DirectionalLimit;
use foldhash::{HashMap, HashMapExt};
use spmesh_delaunay::predicates::{Point2, Sign, area};

/// Greatest degree of a simplex spline: sets of knots are held in 32 bits.
pub const MAX_DEGREE: usize = 28;

/// Results for sets of fewer knots than this are computed again rather than looked up.
const REMEMBERED: u32 = 6;

/// The simplex spline of degree `knots.len() - 3` at a point.
///
/// Units: one over an area. Knots may be repeated; if all knots lie on one line, the function is zero.
///
/// Domain: at most [`MAX_DEGREE`] + 3 knots, with coordinates in the domain of [`area`]. Relative error:
/// about 1e-14 times the degree.
///
/// Cost: O(3^k) areas for degrees k up to 2, then at most one evaluation for each subset of the knots.
///
/// Source: Micchelli, "A constructive approach to Kergin interpolation in R^k", 1980; thesis, equation 6.3.
pub fn simplex_spline(at: &DirectionalLimit, knots: &[Point2]) -> f64 {
    Evaluation::new(at, knots, false).of_all().map_or(0.0, |jet| jet.value)
}

/// The simplex spline of degree `knots.len() - 3` with its derivatives at a point: limits where there is a
/// jump.
///
/// Domain and cost: those of [`simplex_spline`]. The derivative in a direction y is k times the sum of `mu_v
/// M(x | X \ v)`, if the `mu_v v` sum to y and the `mu_v` to zero.
pub fn simplex_spline_jet(at: &DirectionalLimit, knots: &[Point2]) -> Jet {
    Evaluation::new(at, knots, true).of_all().unwrap_or_default()
}

/// The value with derivatives, or `None` if the directional limit is not in the convex hull of the knots.
pub(super) fn evaluate(at: &DirectionalLimit, knots: &[Point2], has_derivatives: bool) -> Option<Jet> {
    Evaluation::new(at, knots, has_derivatives).of_all()
}

/// Evaluates simplex splines of subsets of one set of knots, as bits, at one point.
struct Evaluation<'a> {
    at: &'a DirectionalLimit,
    knots: &'a [Point2],
    /// For each knot i, the knots j such that the point is on the left of the line from i to j.
    left: [u32; 32],
    has_derivatives: bool,
    known: HashMap<u32, Option<Jet>>,
}

impl<'a> Evaluation<'a> {
    fn new(at: &'a DirectionalLimit, knots: &'a [Point2], has_derivatives: bool) -> Evaluation<'a> {
        debug_assert!(knots.len() <= MAX_DEGREE + 3);
        let mut left = [0; 32];
        for i in 0..knots.len() {
            for j in 0..i {
                match at.side(knots[i], knots[j]) {
                    Sign::Positive => left[i] |= 1 << j,
                    Sign::Negative => left[j] |= 1 << i,
                    Sign::Zero => (),
                }
            }
        }
        Evaluation { at, knots, left, has_derivatives, known: HashMap::new() }
    }

    fn of_all(&mut self) -> Option<Jet> {
        self.of(((1u64 << self.knots.len()) - 1) as u32)
    }

    fn of(&mut self, set: u32) -> Option<Jet> {
        if set.count_ones() < REMEMBERED {
            return self.recur(set);
        }
        if let Some(&known) = self.known.get(&set) {
            return known;
        }
        let found = self.recur(set);
        self.known.insert(set, found);
        found
    }

    fn recur(&mut self, set: u32) -> Option<Jet> {
        let (triple, size) = self.largest_around(set)?;
        let degree = set.count_ones() - 3;
        if degree == 0 {
            return Some(Jet::constant(1.0 / size));
        }
        let [a, b, c] = triple.map(|place| self.knots[place]);
        let mut sum = Jet::default();
        for (place, [p, q]) in triple.into_iter().zip([[b, c], [c, a], [a, b]]) {
            let share = area(self.at.x(), p, q) / size;
            if share == 0.0 && !self.has_derivatives {
                continue;
            }
            let Some(part) = self.of(set & !(1 << place)) else { continue };
            let slope = [0.5 * (p[1] - q[1]) / size, 0.5 * (q[0] - p[0]) / size];
            sum += term(f64::from(degree), share, slope, part);
        }
        Some(sum)
    }

    /// The largest triangle, counterclockwise, of knots of a set that contains the point, and its area.
    fn largest_around(&self, set: u32) -> Option<([usize; 3], f64)> {
        let mut best = (0.0, [0; 3]);
        let mut take = |triple: [usize; 3]| {
            let [a, b, c] = triple.map(|place| self.knots[place]);
            let size = area(a, b, c);
            if size > best.0 {
                best = (size, triple);
            }
        };
        for i in places(set) {
            let (left, later) = (self.left[i], set & !((2 << i) - 1));
            // Counterclockwise triples around the point, with i before the others.
            for j in places(left & later) {
                places(self.left[j] & later)
                    .filter(|&k| self.left[k] >> i & 1 == 1)
                    .for_each(|k| take([i, j, k]));
            }
        }
        (best.0 > 0.0).then_some((best.1, best.0))
    }
}

/// The contribution of one knot of the triple to the recurrence and to its derivatives. The derivatives of
/// shares do not appear in it.
fn term(degree: f64, share: f64, slope: [f64; 2], part: Jet) -> Jet {
    let second = |i: usize, j: usize| 0.5 * (slope[i] * part.gradient[j] + slope[j] * part.gradient[i]);
    Jet {
        value: share * part.value,
        gradient: slope.map(|slope| degree * slope * part.value),
        hessian: [second(0, 0), second(0, 1), second(1, 1)].map(|bend| degree * bend),
    }
}

/// The members of a set, in order.
fn places(set: u32) -> impl Iterator<Item = usize> {
    let mut rest = set;
    std::iter::from_fn(move || {
        let next = (rest != 0).then(|| rest.trailing_zeros() as usize)?;
        rest &= rest - 1;
        Some(next)
    })
}

/// Value, gradient and second derivatives of a function at a point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// First derivatives with respect to x and y.
    pub gradient: [f64; 2],
    /// Second derivatives: f_xx, f_xy, f_yy.
    pub hessian: [f64; 3],
}

impl Jet {
    /// A constant.
    pub fn constant(value: f64) -> Jet {
        Jet { value, ..Jet::default() }
    }

    /// The jet of a linear function with this value and gradient.
    pub fn linear(value: f64, gradient: [f64; 2]) -> Jet {
        Jet { value, gradient, hessian: [0.0; 3] }
    }

    /// The jet of a product of functions.
    pub fn product(self, other: Jet) -> Jet {
        let (f, g, df, dg) = (self.value, other.value, self.gradient, other.gradient);
        let second = |i: usize, j: usize| df[i] * dg[j] + df[j] * dg[i];
        let bends = [second(0, 0), second(0, 1), second(1, 1)];
        Jet {
            value: f * g,
            gradient: [0, 1].map(|i| f * dg[i] + df[i] * g),
            hessian: [0, 1, 2].map(|i| f * other.hessian[i] + bends[i] + self.hessian[i] * g),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Jet;

    fn mul(self, factor: f64) -> Jet {
        Jet {
            value: self.value * factor,
            gradient: self.gradient.map(|slope| slope * factor),
            hessian: self.hessian.map(|bend| bend * factor),
        }
    }
}

impl Add for Jet {
    type Output = Jet;

    fn add(self, other: Jet) -> Jet {
        Jet {
            value: self.value + other.value,
            gradient: [0, 1].map(|i| self.gradient[i] + other.gradient[i]),
            hessian: [0, 1, 2].map(|i| self.hessian[i] + other.hessian[i]),
        }
    }
}

impl AddAssign for Jet {
    fn add_assign(&mut self, other: Jet) {
        *self = *self + other;
    }
}
