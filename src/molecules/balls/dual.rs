//! The power diagram against the union of the balls: which of its vertices the balls cover, and where its
//! edges cross the surface.
//!
//! All decisions go by one power for each tetrahedron and one test for each facet. So what is made of them on
//! different balls fits together, however they are rounded.

use super::shares::Foot;
use super::tile::Tile;
use num_bigint::BigInt;
use num_traits::Signed;
use spmesh_delaunay::predicates::exact_integers::{integers_in, unit_with_weights, weight_in};
use spmesh_delaunay::predicates::{Point3, forms};
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{cross, difference, dot};

/// A tile, with the power of each orthocentre.
pub(super) struct Dual<'t> {
    pub(super) tile: &'t Tile<'t>,
    powers: Vec<f64>,
}

impl<'t> Dual<'t> {
    pub(super) fn new(tile: &'t Tile<'t>) -> Self {
        Dual { tile, powers: (0..tile.tetrahedra().len()).map(|t| tile.power(t)).collect() }
    }

    /// Whether no ball covers the orthocentre of a tetrahedron.
    pub(super) fn is_empty(&self, t: usize) -> bool {
        self.powers[t] > 0.0
    }

    /// The tetrahedron across a facet, and its corner opposite to it.
    pub(super) fn across(&self, t: usize, corner: usize) -> Option<(usize, usize)> {
        let other = self.tile.tetrahedra()[t].neighbour(corner)?;
        Some((other.tetrahedron as usize, other.corner as usize))
    }

    /// Whether the facet opposite to a corner separates a tetrahedron from its orthocentre.
    pub(super) fn flows(&self, t: usize, corner: usize) -> bool {
        let vertices = self.tile.tetrahedra()[t].vertices;
        let [a, b, c] = TETRAHEDRON_FACETS[corner].map(|i| self.tile.point(vertices[i]));
        let normal = cross(difference(b, a), difference(c, a));
        let apex = dot(normal, difference(self.tile.point(vertices[corner]), a));
        let centre = dot(normal, difference(self.tile.centre(t), a));
        (if apex < 0.0 { -centre } else { centre }) < 0.0
    }

    /// Whether the balls cover the facet's place in the dual: some point of the line of equal power between
    /// the two orthocentres.
    pub(super) fn is_closed(&self, t: usize, corner: usize) -> bool {
        let Some((other, across)) = self.across(t, corner) else { return false };
        let least = self.powers[t].min(self.powers[other]);
        if least <= 0.0 || self.flows(t, corner) || self.flows(other, across) {
            return least <= 0.0;
        }
        // The orthocentre of the facet lies between.
        self.foot(t, corner).is_some_and(|(foot, _)| foot.power <= 0.0)
    }

    /// Whether the line of equal power crosses the surface twice between two orthocentres that are both
    /// outside.
    pub(super) fn dips(&self, t: usize, corner: usize) -> bool {
        let Some((other, across)) = self.across(t, corner) else { return false };
        self.is_empty(t)
            && self.is_empty(other)
            && !self.flows(t, corner)
            && !self.flows(other, across)
            && self.foot(t, corner).is_some_and(|(foot, _)| foot.power < 0.0)
    }

    /// Where the line of equal power of a facet crosses the surface on its way to the orthocentre of `t`,
    /// which is outside.
    pub(super) fn crossing(&self, t: usize, corner: usize) -> Point3 {
        let apex = self.tile.point(self.tile.tetrahedra()[t].vertices[corner]);
        match self.foot(t, corner) {
            Some((foot, first)) => foot.meeting(first, apex),
            None => self.tile.centre(t),
        }
    }

    /// The foot of a facet and the point that it is relative to: the same from both sides.
    fn foot(&self, t: usize, corner: usize) -> Option<(Foot, Point3)> {
        let vertices = self.tile.tetrahedra()[t].vertices;
        let mut facet = TETRAHEDRON_FACETS[corner].map(|i| vertices[i]);
        facet.sort_unstable();
        let points = facet.map(|v| self.tile.point(v));
        Some((Foot::of(points, facet.map(|v| self.tile.radius(v)))?, points[0]))
    }
}

/// A determinant below this share of the product of the lengths of its rows has lost too many digits.
const THIN: f64 = 1e-7;

/// The point that has the same power distance from four balls, relative to the first, and its power distance.
/// `weights` are squares of radii.
///
/// Domain: the centres are not in a plane. Accurate to about nine digits of the distance from the first
/// centre, however thin the tetrahedron is.
pub(crate) fn orthocentre(points: [Point3; 4], weights: [f64; 4]) -> (Point3, f64) {
    let [b, c, d] = [1, 2, 3].map(|i| difference(points[i], points[0]));
    let [over_b, over_c, over_d] =
        [(b, 1), (c, 2), (d, 3)].map(|(p, i)| dot(p, p) - (weights[i] - weights[0]));
    let (bc, cd, db) = (cross(b, c), cross(c, d), cross(d, b));
    let volume = dot(b, cd);
    let lengths = dot(b, b) * dot(c, c) * dot(d, d);
    let centre = if volume * volume > THIN * THIN * lengths {
        let half = 0.5 / volume;
        [0, 1, 2].map(|axis| (over_b * cd[axis] + over_c * db[axis] + over_d * bc[axis]) * half)
    } else {
        exactly(points, weights)
    };
    (centre, dot(centre, centre) - weights[0])
}

/// The same in arbitrary precision.
#[cold]
#[inline(never)]
fn exactly(points: [Point3; 4], weights: [f64; 4]) -> Point3 {
    let unit = unit_with_weights(&points, &weights);
    let [a, b, c, d] = points.map(|point| integers_in(point, unit));
    let weights = weights.map(|weight| weight_in(weight, unit));
    let from_a = |p: [BigInt; 3]| -> [BigInt; 3] { std::array::from_fn(|axis| &p[axis] - &a[axis]) };
    let (b, c, d) = (from_a(b), from_a(c), from_a(d));
    let lift = |p: &[BigInt; 3], i: usize| forms::lift(p) - (&weights[i] - &weights[0]);
    let (over_b, over_c, over_d) = (lift(&b, 1), lift(&c, 2), lift(&d, 3));
    let (bc, cd, db) = (forms::cross(&b, &c), forms::cross(&c, &d), forms::cross(&d, &b));
    let divisor = forms::dot(&b, &cd) * 2;
    let numerators: [BigInt; 3] =
        std::array::from_fn(|axis| &over_b * &cd[axis] + &over_c * &db[axis] + &over_d * &bc[axis]);
    numerators.map(|numerator| quotient(&numerator, &divisor) * 2f64.powi(unit))
}

/// The quotient of two integers, rounded; infinite if it is out of range or the divisor is zero.
fn quotient(dividend: &BigInt, divisor: &BigInt) -> f64 {
    if divisor == &BigInt::ZERO {
        return f64::INFINITY;
    }
    // 64 bits of the quotient.
    let shift = 64 - (dividend.bits() as i64 - divisor.bits() as i64);
    let digits = match usize::try_from(shift) {
        Ok(shift) => (dividend.abs() << shift) / divisor.abs(),
        Err(_) => dividend.abs() / (divisor.abs() << shift.unsigned_abs() as usize),
    };
    let magnitude = u128::try_from(digits).expect("about 64 bits") as f64;
    let value = magnitude * 2f64.powi((-shift).clamp(-1100, 1100) as i32);
    if dividend.is_negative() == divisor.is_negative() { value } else { -value }
}
