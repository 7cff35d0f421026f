//! Values at jumps: the limit along a fixed direction.
//!
//! Simplex splines of degree 0, derivatives, and splines over repeated or collinear knots jump across lines
//! through knots. On such a line closed triangles would count twice. So the value of a function at x is
//! defined as the limit at x + e d + e^2 d' for small e > 0, where d points towards a fixed point and d' is d
//! turned left. No line contains these points for all small e, so all functions take the limit from the same
//! side. If the fixed point is inside a convex domain, d points inward on the border.

use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};

/// A point, and the direction along which functions take their limit there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionalLimit {
    x: Point2,
    from: Point2,
}

impl DirectionalLimit {
    /// The limit at `x` from the direction of `from`; if they are equal, from the right along the x axis.
    pub fn new(x: Point2, from: Point2) -> DirectionalLimit {
        DirectionalLimit { x, from }
    }

    /// The point itself.
    #[inline(always)]
    pub fn x(&self) -> Point2 {
        self.x
    }

    /// The side of the directed line from `a` to `b`: positive on its left; zero only if `a` and `b` are
    /// equal.
    #[inline]
    pub fn side(&self, a: Point2, b: Point2) -> Sign {
        match FiniteFloatPredicates::default().orient2d(a, b, self.x) {
            Sign::Zero => self.side_nearby(a, b),
            sign => sign,
        }
    }

    /// The side of x + e d + e^2 d', for an x on the line.
    #[cold]
    fn side_nearby(&self, a: Point2, b: Point2) -> Sign {
        let ([ax, ay], [bx, by]) = (a, b);
        if self.x == self.from {
            return sign_of(ay, by).then(sign_of(bx, ax));
        }
        // With x on the line, the cross product of b - a with d has the sign of an orientation, which is
        // exact.
        let first = FiniteFloatPredicates::default().orient2d(a, b, self.from);
        if first != Sign::Zero {
            return first;
        }
        // Then d is along the line, and the cross product with d' is the scalar product with d.
        let axis = usize::from(ax == bx);
        let (along, towards) = (sign_of(b[axis], a[axis]), sign_of(self.from[axis], self.x[axis]));
        Sign::of(along as i32 * towards as i32)
    }
}

/// The sign of p - q.
fn sign_of(p: f64, q: f64) -> Sign {
    Sign::of(p.partial_cmp(&q).map_or(0, |order| order as i32))
}

/// The first sign that is not zero.
trait Then {
    fn then(self, other: Sign) -> Sign;
}

impl Then for Sign {
    fn then(self, other: Sign) -> Sign {
        if self == Sign::Zero { other } else { self }
    }
}
