//! Exact predicates of knots by id: copies are displaced symbolically, ties are broken canonically, and the
//! faraway point is handled.

use super::knots::Knots;
use super::lift::Lift;
use super::symbolic;
use spmesh_delaunay::predicates::{Predicates2, Sign};
use spmesh_stream::model::configurations::FARAWAY;

/// The knots, and the predicates for them.
pub(super) struct Plane<'a, P> {
    pub(super) knots: &'a Knots,
    /// The convex function that replaces x² + y², if any.
    pub(super) lift: Option<&'a Lift>,
    predicates: &'a mut P,
}

impl<'a, P: Predicates2> Plane<'a, P> {
    /// `predicates` must be exact for all knots.
    pub(super) fn new(knots: &'a Knots, lift: Option<&'a Lift>, predicates: &'a mut P) -> Self {
        Plane { knots, lift, predicates }
    }

    fn is_moved(&self, ids: &[u32]) -> bool {
        self.knots.has_copies() && ids.iter().any(|&id| self.knots.rank(id) > 0)
    }

    /// Orientation of three knots of P(e); zero if they are collinear there.
    #[inline]
    pub(super) fn orient(&mut self, a: u32, b: u32, c: u32) -> Sign {
        if self.knots.are_copies(&[a, b, c]) {
            return symbolic::orient_copies(self.knots, [a, b, c]);
        }
        let sign = self.predicates.orient2d(self.knots.at(a), self.knots.at(b), self.knots.at(c));
        if sign == Sign::Zero && self.is_moved(&[a, b, c]) {
            return symbolic::orient(self.knots, [a, b, c]);
        }
        sign
    }

    /// Whether three knots are on one line at their given positions, not at the perturbed ones.
    pub(super) fn is_flat(&mut self, a: u32, b: u32, c: u32) -> bool {
        self.predicates.orient2d(self.knots.at(a), self.knots.at(b), self.knots.at(c)) == Sign::Zero
    }

    #[inline]
    pub(super) fn is_left(&mut self, a: u32, b: u32, c: u32) -> bool {
        self.orient(a, b, c) == Sign::Positive
    }

    /// Whether `d` is inside the circle of `abc`, with ties broken; with a lift, whether it is below their
    /// plane.
    ///
    /// Domain: four distinct knots, abc counterclockwise in P(e).
    #[inline]
    pub(super) fn is_inside(&mut self, [a, b, c]: [u32; 3], d: u32) -> bool {
        if self.lift.is_none() && !self.knots.has_copies() {
            let [a, b, c, d] = [a, b, c, d].map(|id| self.knots.at(id));
            return self.predicates.incircle_perturbed(a, b, c, d) == Sign::Positive;
        }
        self.is_beyond([a, b, c], d)
    }

    /// [`Plane::is_inside`] for any four distinct knots: whether the lifted `d` is on the side of the plane
    /// of the others that is below for a counterclockwise abc. For a clockwise abc this side is above; for
    /// abc on a line the plane is vertical. False for four knots on a line.
    pub(super) fn is_beyond(&mut self, [a, b, c]: [u32; 3], d: u32) -> bool {
        let ids = [a, b, c, d];
        let sign = match self.lift {
            Some(lift) => lift.sign(self.knots, ids),
            None => self.sign_of_circle(ids),
        };
        let sign = if sign == Sign::Zero { self.tie(ids) } else { sign };
        sign == Sign::Positive
    }

    fn sign_of_circle(&mut self, ids: [u32; 4]) -> Sign {
        if self.knots.has_copies()
            && let Some(sign) = symbolic::in_circle_of_copies(self.knots, ids)
        {
            return sign;
        }
        let [a, b, c, d] = ids.map(|id| self.knots.at(id));
        match self.predicates.incircle(a, b, c, d) {
            Sign::Zero if self.is_moved(&ids) => symbolic::in_circle(self.knots, ids),
            sign => sign,
        }
    }

    /// The sign of the derivative of the determinant with respect to the lift of a knot: the
    /// lexicographically largest knot for which the derivative is not zero.
    fn tie(&mut self, [a, b, c, d]: [u32; 4]) -> Sign {
        let mut ranked = [(a, [d, b, c]), (b, [a, d, c]), (c, [a, b, d]), (d, [a, c, b])];
        ranked.sort_unstable_by(|p, q| self.knots.order(q.0, p.0));
        let mut signs = ranked.into_iter().map(|(_, [p, q, r])| self.orient(p, q, r));
        signs.find(|&sign| sign != Sign::Zero).unwrap_or(Sign::Negative)
    }

    /// Whether `d` is in conflict with a counterclockwise triangle, which may be infinite.
    ///
    /// The disk of an infinite triangle is the open half-plane to the left of its finite edge, together with
    /// the open edge, as the limit of disks. So all knots on the border of the hull become vertices of it.
    pub(super) fn is_in_conflict(&mut self, triangle: [u32; 3], d: u32) -> bool {
        match triangle.iter().position(|&v| v == FARAWAY) {
            None => self.is_inside(triangle, d),
            Some(at) => {
                let (p, q) = (triangle[(at + 1) % 3], triangle[(at + 2) % 3]);
                match self.orient(p, q, d) {
                    Sign::Zero => self.is_between(p, q, d),
                    sign => sign == Sign::Positive,
                }
            }
        }
    }

    /// Whether `d` is strictly between `p` and `q`, given that it is on their line.
    pub(super) fn is_between(&self, p: u32, q: u32, d: u32) -> bool {
        self.knots.order(d, p) != self.knots.order(d, q)
    }

    /// Whether the closed segments `ab` and `cd`, of four distinct knots, have a point in common.
    pub(super) fn do_meet(&mut self, [a, b]: [u32; 2], [c, d]: [u32; 2]) -> bool {
        let (left, right) = (self.orient(a, b, c), self.orient(a, b, d));
        if left != Sign::Zero && left == right {
            return false;
        }
        let (start, end) = (self.orient(c, d, a), self.orient(c, d, b));
        if start != Sign::Zero && start == end {
            return false;
        }
        if left == right.opposite() && left != Sign::Zero && start == end.opposite() && start != Sign::Zero {
            return true;
        }
        (left == Sign::Zero && self.is_between(a, b, c))
            || (right == Sign::Zero && self.is_between(a, b, d))
            || (start == Sign::Zero && self.is_between(c, d, a))
            || (end == Sign::Zero && self.is_between(c, d, b))
    }
}
