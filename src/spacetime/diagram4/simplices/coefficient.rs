//! Number types for the coefficients of spheres.

use std::fmt::Debug;

/// A coefficient of a sphere, as narrow as the coordinates allow: insertion is bound by memory.
pub(in crate::diagram4) trait Coefficient:
    Copy + Debug + Default + PartialOrd + Sync
{
    /// Replaces the determinant in the sphere of a dead simplex.
    const DEAD: Self;

    /// Converts a coefficient.
    fn of(value: f64) -> Self;

    /// Converts the determinant of a simplex: positive, or zero if the simplex is infinite.
    fn determinant(value: f64, is_infinite: bool) -> Self;

    /// The coefficient as an f64, for in-sphere tests.
    fn value(self) -> f64;
}

impl Coefficient for f64 {
    const DEAD: f64 = -1.0;

    #[inline(always)]
    fn of(value: f64) -> f64 {
        value
    }

    /// Rounding can make the determinant of an almost flat simplex zero or negative: clamp it.
    #[inline(always)]
    fn determinant(value: f64, is_infinite: bool) -> f64 {
        if is_infinite { 0.0 } else { value.max(f64::MIN_POSITIVE) }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
}

/// Exact for [`Exactness::Small`](crate::diagram4::exact::Exactness::Small).
impl Coefficient for i32 {
    const DEAD: i32 = -1;

    #[inline(always)]
    fn of(value: f64) -> i32 {
        debug_assert!(value as i32 as f64 == value);
        // SAFETY: coefficients of small integers fit 32 bits; see `SMALL_MAX`.
        unsafe { value.to_int_unchecked() }
    }

    #[inline(always)]
    fn determinant(value: f64, _: bool) -> i32 {
        i32::of(value)
    }

    #[inline(always)]
    fn value(self) -> f64 {
        f64::from(self)
    }
}

#[cfg(test)]
mod tests {
    use crate::diagram4::determinant::{difference, dot, lift, sphere};
    use crate::diagram4::exact::SMALL_MAX;
    use spmesh_base::random::Random;
    use spmesh_stream::model::cells4::Point4;

    /// Coefficients are greatest for simplices at the corners of the box.
    #[test]
    fn coefficients_of_small_integers_have_32_bits() {
        let mut random = Random::new(1);
        let half = SMALL_MAX / 2.0;
        let mut greatest = 0f64;
        for _ in 0..200_000 {
            let corner: [Point4; 5] = std::array::from_fn(|_| {
                std::array::from_fn(|_| [-half, half, half - 1.0, 0.0][random.below(4) as usize])
            });
            let [o, a, b, c, d] = corner;
            let (n, m) = sphere([a, b, c, d].map(|p| difference(p, &o)));
            let shifted: Point4 = std::array::from_fn(|axis| n[axis] - 2.0 * m * o[axis]);
            let s = m * lift(&o) - dot(&n, &o);
            greatest = [s, m].into_iter().chain(shifted).fold(greatest, |most, x| most.max(x.abs()));
        }
        assert!((1e8..f64::from(i32::MAX)).contains(&greatest), "{greatest}");
    }
}
