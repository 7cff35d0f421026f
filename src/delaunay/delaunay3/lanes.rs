//! Vectors of four `f64`, one per lane, which the vector units of processors compute with at once.
//!
//! The search of a cavity tests the three neighbours of a tetrahedron at once. Each has a lane; the fourth
//! lane is unused.

use std::ops::{Add, Mul, Sub};

/// Three numbers, and a fourth that is ignored.
///
/// Every vector is made from a token or from other vectors, so that a vector exists only where the processor
/// has its instructions.
pub(super) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// Proves that the processor has the instructions.
    type Token: Copy;

    fn new(token: Self::Token, values: [f64; 4]) -> Self;
    fn array(self) -> [f64; 4];

    #[inline(always)]
    fn splat(token: Self::Token, value: f64) -> Self {
        Self::new(token, [value; 4])
    }

    /// `self * factor + summand`, rounded once or twice.
    fn times_plus(self, factor: Self, summand: Self) -> Self;

    /// `self * factor - subtrahend`, rounded once or twice.
    fn times_minus(self, factor: Self, subtrahend: Self) -> Self;

    /// Moves to each lane the value of the next lane, cyclically among the first three.
    fn next(self) -> Self;

    /// Moves to each lane the value of the previous lane, cyclically among the first three.
    fn previous(self) -> Self;

    /// The greater number of each lane.
    fn greater(self, other: Self) -> Self;

    /// The first three lanes, a bit for each, whose squares are above `bound`: those that are positive, and
    /// those that are not.
    fn signs(self, bound: Self) -> [u32; 2];

    /// The columns of a matrix of three rows.
    fn columns(token: Self::Token, rows: [&[f64; 4]; 3]) -> [Self; 4];
}

/// For every processor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable([f64; 4]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Portable {
            type Output = Portable;
            #[inline(always)]
            fn $method(self, other: Portable) -> Portable {
                let (p, q) = (self.0, other.0);
                Portable([p[0] $op q[0], p[1] $op q[1], p[2] $op q[2], 0.0])
            }
        }
    };
}

lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);

impl Lanes for Portable {
    type Token = ();

    #[inline(always)]
    fn new((): (), values: [f64; 4]) -> Portable {
        Portable(values)
    }

    #[inline(always)]
    fn array(self) -> [f64; 4] {
        self.0
    }

    #[inline(always)]
    fn times_plus(self, factor: Portable, summand: Portable) -> Portable {
        self * factor + summand
    }

    #[inline(always)]
    fn times_minus(self, factor: Portable, subtrahend: Portable) -> Portable {
        self * factor - subtrahend
    }

    #[inline(always)]
    fn next(self) -> Portable {
        let [a, b, c, d] = self.0;
        Portable([b, c, a, d])
    }

    #[inline(always)]
    fn previous(self) -> Portable {
        let [a, b, c, d] = self.0;
        Portable([c, a, b, d])
    }

    #[inline(always)]
    fn greater(self, other: Portable) -> Portable {
        let (p, q) = (self.0, other.0);
        Portable([0, 1, 2, 3].map(|i| if p[i] > q[i] { p[i] } else { q[i] }))
    }

    #[inline(always)]
    fn signs(self, bound: Portable) -> [u32; 2] {
        let square = self * self;
        let bits = |is_set: [bool; 3]| (0..3).fold(0, |bits, i| bits | u32::from(is_set[i]) << i);
        let certain = bits([0, 1, 2].map(|i| square.0[i] > bound.0[i]));
        let positive = bits([0, 1, 2].map(|i| self.0[i] > 0.0));
        [certain & positive, certain & !positive]
    }

    #[inline(always)]
    fn columns((): (), rows: [&[f64; 4]; 3]) -> [Portable; 4] {
        [0, 1, 2, 3].map(|i| Portable([rows[0][i], rows[1][i], rows[2][i], 0.0]))
    }
}
