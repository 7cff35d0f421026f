//! [`Lanes`] in a register of AVX2.

use super::lanes::Lanes;
use crate::processor::Avx2Fma;
use std::arch::x86_64::{
    __m256d, _CMP_GT_OQ, _mm_loadu_pd, _mm256_add_pd, _mm256_castpd128_pd256, _mm256_cmp_pd, _mm256_fmadd_pd,
    _mm256_fmsub_pd, _mm256_insertf128_pd, _mm256_max_pd, _mm256_movemask_pd, _mm256_mul_pd,
    _mm256_permute4x64_pd, _mm256_set1_pd, _mm256_setr_pd, _mm256_storeu_pd, _mm256_sub_pd,
    _mm256_unpackhi_pd, _mm256_unpacklo_pd,
};
use std::ops::{Add, Mul, Sub};

/// A register of AVX2. It exists only where the processor has AVX2 and FMA: it is made from an [`Avx2Fma`] or
/// from others.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx2(__m256d);

/// Evaluates instructions of AVX2 and FMA on registers, or with a token.
macro_rules! instructions {
    ($($code:tt)*) => {
        // SAFETY: the code below uses it only where an `Avx2` or an `Avx2Fma` exists, so the processor has
        // AVX2 and FMA; the instructions on registers have no other precondition, and the store writes to an
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
    fn new(_: Avx2Fma, values: [f64; 4]) -> Avx2 {
        let [a, b, c, d] = values;
        instructions!(Avx2(_mm256_setr_pd(a, b, c, d)))
    }

    #[inline(always)]
    fn splat(_: Avx2Fma, value: f64) -> Avx2 {
        instructions!(Avx2(_mm256_set1_pd(value)))
    }

    #[inline(always)]
    fn array(self) -> [f64; 4] {
        let mut values = [0.0; 4];
        instructions!(_mm256_storeu_pd(values.as_mut_ptr(), self.0));
        values
    }

    #[inline(always)]
    fn times_plus(self, factor: Avx2, summand: Avx2) -> Avx2 {
        instructions!(Avx2(_mm256_fmadd_pd(self.0, factor.0, summand.0)))
    }

    #[inline(always)]
    fn times_minus(self, factor: Avx2, subtrahend: Avx2) -> Avx2 {
        instructions!(Avx2(_mm256_fmsub_pd(self.0, factor.0, subtrahend.0)))
    }

    #[inline(always)]
    fn next(self) -> Avx2 {
        instructions!(Avx2(_mm256_permute4x64_pd::<0b11_00_10_01>(self.0)))
    }

    #[inline(always)]
    fn previous(self) -> Avx2 {
        instructions!(Avx2(_mm256_permute4x64_pd::<0b11_01_00_10>(self.0)))
    }

    #[inline(always)]
    fn greater(self, other: Avx2) -> Avx2 {
        instructions!(Avx2(_mm256_max_pd(self.0, other.0)))
    }

    #[inline(always)]
    fn signs(self, bound: Avx2) -> [u32; 2] {
        instructions! {
            let certain = _mm256_cmp_pd::<_CMP_GT_OQ>(_mm256_mul_pd(self.0, self.0), bound.0);
            let certain = _mm256_movemask_pd(certain) as u32 & 7;
            let negative = _mm256_movemask_pd(self.0) as u32;
            [certain & !negative, certain & negative]
        }
    }

    /// Loads of halves of rows, of which two go into one register, save half of the shuffles.
    #[inline(always)]
    fn columns(_: Avx2Fma, rows: [&[f64; 4]; 3]) -> [Avx2; 4] {
        let [a, b, c] = rows.map(|row| row.as_ptr());
        instructions! {
            let half = |row: *const f64, third: *const f64| {
                _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(_mm_loadu_pd(row)), _mm_loadu_pd(third))
            };
            let (a_low, b_low) = (half(a, c), half(b, c));
            let (a_high, b_high) = (half(a.add(2), c.add(2)), half(b.add(2), c.add(2)));
            [
                Avx2(_mm256_unpacklo_pd(a_low, b_low)),
                Avx2(_mm256_unpackhi_pd(a_low, b_low)),
                Avx2(_mm256_unpacklo_pd(a_high, b_high)),
                Avx2(_mm256_unpackhi_pd(a_high, b_high)),
            ]
        }
    }
}
