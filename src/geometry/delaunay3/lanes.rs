//! Four numbers side by side: what the vector units of processors compute at once.
//!
//! The search of a cavity tests the three tetrahedra beyond the facets of one; each has a lane, the fourth is idle.

use std::ops::{Add, Mul, Sub};

/// Three numbers, and one that nobody looks at.
pub(super) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    fn new(values: [f64; 4]) -> Self;
    fn array(self) -> [f64; 4];

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::new([value; 4])
    }

    /// `self * factor + summand`, rounded once or twice.
    fn times_plus(self, factor: Self, summand: Self) -> Self;

    /// `self * factor - subtrahend`, rounded once or twice.
    fn times_minus(self, factor: Self, subtrahend: Self) -> Self;

    /// To each lane what the next one has, in a circle of three.
    fn next(self) -> Self;

    /// To each lane what the one before has, in a circle of three.
    fn previous(self) -> Self;

    /// The greater ones.
    fn greater(self, other: Self) -> Self;

    /// The numbers themselves where `left` is greater than `right`, NaN elsewhere.
    fn where_greater(self, left: Self, right: Self) -> Self;

    /// The columns of three rows.
    fn columns(rows: [Self; 3]) -> [Self; 4];
}

/// In the instructions that every processor has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable([f64; 4]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt, $avx2:ident) => {
        impl $trait for Portable {
            type Output = Portable;
            #[inline(always)]
            fn $method(self, other: Portable) -> Portable {
                let (p, q) = (self.0, other.0);
                Portable([p[0] $op q[0], p[1] $op q[1], p[2] $op q[2], 0.0])
            }
        }

        #[cfg(target_arch = "x86_64")]
        impl $trait for avx2::Avx2 {
            type Output = avx2::Avx2;
            #[inline(always)]
            fn $method(self, other: avx2::Avx2) -> avx2::Avx2 {
                self.$avx2(other)
            }
        }
    };
}

lanewise!(Add, add, +, plus);
lanewise!(Sub, sub, -, minus);
lanewise!(Mul, mul, *, times);

impl Lanes for Portable {
    #[inline(always)]
    fn new(values: [f64; 4]) -> Portable {
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
    fn where_greater(self, left: Portable, right: Portable) -> Portable {
        Portable([0, 1, 2, 3].map(|i| if left.0[i] > right.0[i] { self.0[i] } else { f64::NAN }))
    }

    #[inline(always)]
    fn columns(rows: [Portable; 3]) -> [Portable; 4] {
        let [a, b, c] = rows.map(|row| row.0);
        [0, 1, 2, 3].map(|i| Portable([a[i], b[i], c[i], 0.0]))
    }
}

/// In AVX2.
#[cfg(target_arch = "x86_64")]
pub(super) mod avx2 {
    use super::Lanes;
    use std::arch::x86_64::{
        __m256d, _CMP_GT_OQ, _mm256_add_pd, _mm256_blendv_pd, _mm256_cmp_pd, _mm256_fmadd_pd,
        _mm256_fmsub_pd, _mm256_max_pd, _mm256_mul_pd, _mm256_permute2f128_pd, _mm256_permute4x64_pd,
        _mm256_set1_pd, _mm256_setr_pd, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    };

    /// A register of AVX2.
    ///
    /// Safety of all that follows: values of this type exist only where [`super::super::dispatch`] has found that the processor
    /// has AVX2, and the instructions have no other condition.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Avx2(__m256d);

    impl Avx2 {
        #[inline(always)]
        pub(super) fn plus(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_add_pd(self.0, other.0)) }
        }

        #[inline(always)]
        pub(super) fn minus(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_sub_pd(self.0, other.0)) }
        }

        #[inline(always)]
        pub(super) fn times(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_mul_pd(self.0, other.0)) }
        }
    }

    impl Lanes for Avx2 {
        #[inline(always)]
        fn new(values: [f64; 4]) -> Avx2 {
            let [a, b, c, d] = values;
            unsafe { Avx2(_mm256_setr_pd(a, b, c, d)) }
        }

        #[inline(always)]
        fn splat(value: f64) -> Avx2 {
            unsafe { Avx2(_mm256_set1_pd(value)) }
        }

        #[inline(always)]
        fn array(self) -> [f64; 4] {
            unsafe { std::mem::transmute(self.0) }
        }

        #[inline(always)]
        fn times_plus(self, factor: Avx2, summand: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_fmadd_pd(self.0, factor.0, summand.0)) }
        }

        #[inline(always)]
        fn times_minus(self, factor: Avx2, subtrahend: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_fmsub_pd(self.0, factor.0, subtrahend.0)) }
        }

        #[inline(always)]
        fn next(self) -> Avx2 {
            unsafe { Avx2(_mm256_permute4x64_pd::<0b11_00_10_01>(self.0)) }
        }

        #[inline(always)]
        fn previous(self) -> Avx2 {
            unsafe { Avx2(_mm256_permute4x64_pd::<0b11_01_00_10>(self.0)) }
        }

        #[inline(always)]
        fn greater(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_max_pd(self.0, other.0)) }
        }

        #[inline(always)]
        fn where_greater(self, left: Avx2, right: Avx2) -> Avx2 {
            unsafe {
                let mask = _mm256_cmp_pd::<_CMP_GT_OQ>(left.0, right.0);
                Avx2(_mm256_blendv_pd(_mm256_set1_pd(f64::NAN), self.0, mask))
            }
        }

        #[inline(always)]
        fn columns(rows: [Avx2; 3]) -> [Avx2; 4] {
            let [a, b, c] = [rows[0].0, rows[1].0, rows[2].0];
            unsafe {
                let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
                let (even_c, odd_c) = (_mm256_unpacklo_pd(c, c), _mm256_unpackhi_pd(c, c));
                [
                    Avx2(_mm256_permute2f128_pd::<0x20>(even, even_c)),
                    Avx2(_mm256_permute2f128_pd::<0x20>(odd, odd_c)),
                    Avx2(_mm256_permute2f128_pd::<0x31>(even, even_c)),
                    Avx2(_mm256_permute2f128_pd::<0x31>(odd, odd_c)),
                ]
            }
        }
    }
}
