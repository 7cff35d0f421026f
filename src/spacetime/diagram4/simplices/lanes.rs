//! Four f64 in parallel, in plain code or in a register of AVX2.

use crate::diagram4::determinant::Number;
use std::ops::{Add, Mul, Sub};

pub(super) const LANES: usize = 4;

/// Four numbers. Every vector is made from a token or from other vectors, so that a vector exists only where
/// the processor has its instructions.
pub(super) trait Lanes: Number + Copy {
    /// Proves that the processor has the instructions.
    type Token: Copy;

    fn new(token: Self::Token, values: [f64; LANES]) -> Self;
    fn array(self) -> [f64; LANES];

    /// The transposed matrix.
    fn columns(rows: [Self; LANES]) -> [Self; LANES];

    /// The lanes, with `x` in place of NaN.
    fn or(self, x: f64) -> Self;
}

/// For every processor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Portable([f64; LANES]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Portable {
            type Output = Portable;

            #[inline(always)]
            fn $method(self, other: Portable) -> Portable {
                let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
                Portable([a $op e, b $op f, c $op g, d $op h])
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
    fn new((): (), values: [f64; LANES]) -> Portable {
        Portable(values)
    }

    #[inline(always)]
    fn array(self) -> [f64; LANES] {
        self.0
    }

    #[inline(always)]
    fn columns([Portable(a), Portable(b), Portable(c), Portable(d)]: [Portable; LANES]) -> [Portable; LANES] {
        let column = |i: usize| Portable([a[i], b[i], c[i], d[i]]);
        [column(0), column(1), column(2), column(3)]
    }

    #[inline(always)]
    fn or(self, x: f64) -> Portable {
        let or = |lane: f64| if lane.is_nan() { x } else { lane };
        let [a, b, c, d] = self.0;
        Portable([or(a), or(b), or(c), or(d)])
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Add, LANES, Lanes, Mul, Sub};
    use spmesh_delaunay::processor::Avx2Fma;
    use std::arch::x86_64::{
        __m256d, _CMP_UNORD_Q, _mm256_add_pd, _mm256_blendv_pd, _mm256_cmp_pd, _mm256_mul_pd,
        _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_setr_pd, _mm256_storeu_pd, _mm256_sub_pd,
        _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    };

    /// A register of AVX2. It exists only where the processor has AVX2: it is made from an [`Avx2Fma`] or
    /// from others.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Avx2(__m256d);

    /// Evaluates instructions of AVX2 on registers, or with a token.
    macro_rules! instructions {
        ($($code:tt)*) => {
            // SAFETY: the code below uses it only where an `Avx2` or an `Avx2Fma` exists, so the processor
            // has AVX2; the instructions on registers have no other precondition, and the store writes to an
            // array of four numbers.
            unsafe { $($code)* }
        };
    }

    macro_rules! lanewise {
        ($trait:ident, $method:ident, $instruction:ident) => {
            impl $trait for Avx2 {
                type Output = Avx2;
                #[inline(always)]
                fn $method(self, other: Avx2) -> Avx2 {
                    instructions!(Avx2($instruction(self.0, other.0)))
                }
            }
        };
    }

    lanewise!(Add, add, _mm256_add_pd);
    lanewise!(Sub, sub, _mm256_sub_pd);
    lanewise!(Mul, mul, _mm256_mul_pd);

    impl Lanes for Avx2 {
        type Token = Avx2Fma;

        #[inline(always)]
        fn new(_: Avx2Fma, [a, b, c, d]: [f64; LANES]) -> Avx2 {
            instructions!(Avx2(_mm256_setr_pd(a, b, c, d)))
        }

        #[inline(always)]
        fn array(self) -> [f64; LANES] {
            let mut values = [0.0; LANES];
            instructions!(_mm256_storeu_pd(values.as_mut_ptr(), self.0));
            values
        }

        #[inline(always)]
        fn columns([a, b, c, d]: [Avx2; LANES]) -> [Avx2; LANES] {
            instructions! {
                let (even, odd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
                let (even_next, odd_next) = (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Avx2(_mm256_permute2f128_pd::<0x20>(even, even_next)),
                    Avx2(_mm256_permute2f128_pd::<0x20>(odd, odd_next)),
                    Avx2(_mm256_permute2f128_pd::<0x31>(even, even_next)),
                    Avx2(_mm256_permute2f128_pd::<0x31>(odd, odd_next)),
                ]
            }
        }

        #[inline(always)]
        fn or(self, x: f64) -> Avx2 {
            instructions! {
                let is_nan = _mm256_cmp_pd::<_CMP_UNORD_Q>(self.0, self.0);
                Avx2(_mm256_blendv_pd(self.0, _mm256_set1_pd(x), is_nan))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All operations on two matrices.
    fn results<L: Lanes>(token: L::Token) -> Vec<[f64; LANES]> {
        let matrix = |start: i32| -> [L; LANES] {
            let row = |i: i32| std::array::from_fn(|j| f64::from(start + 4 * i) + j as f64);
            [0, 1, 2, 3].map(|i| L::new(token, row(i)))
        };
        let (p, q) = (matrix(1), matrix(-7));
        let holes = L::new(token, [f64::NAN, 2.0, 3.0, f64::NAN]);
        let columns = L::columns(p);
        let all = [p[0] + q[1], p[1] - q[2], p[2] * q[3], holes.or(9.0)];
        all.into_iter().chain(columns).map(L::array).collect()
    }

    #[test]
    fn lanes_are_independent() {
        let expected = [
            [-2.0, 0.0, 2.0, 4.0],
            [4.0; 4],
            [45.0, 60.0, 77.0, 96.0],
            [9.0, 2.0, 3.0, 9.0],
            [1.0, 5.0, 9.0, 13.0],
            [2.0, 6.0, 10.0, 14.0],
            [3.0, 7.0, 11.0, 15.0],
            [4.0, 8.0, 12.0, 16.0],
        ];
        assert_eq!(results::<Portable>(()), expected);
        #[cfg(target_arch = "x86_64")]
        if let Some(token) = spmesh_delaunay::processor::Avx2Fma::detect() {
            assert_eq!(results::<Avx2>(token), expected);
        }
    }
}
