//! The signs of determinants of floating-point coordinates that a filter leaves open.
//!
//! Each stage decides what the one before it cannot: residues of two digits, if all products of the coordinates
//! fit them; pairs of `f64`; longer residues; big integers.

use super::forms::Form;
use super::residues::Integers;
use super::{PredicateCounts, Sign, big, pairs};

/// The sign of a form of the differences from one point to others. `is_bounded`: the coordinates are in the
/// domain of [`pairs::sign`].
///
/// Domain: finite coordinates.
#[cold]
pub fn sign<F: Form<N, D>, const N: usize, const D: usize>(
    from: [f64; D],
    to: [[f64; D]; N],
    is_bounded: bool,
    counts: &mut PredicateCounts,
) -> Sign {
    if !F::IS_LIFTED && D < 4 {
        // A product of two or three coordinates often fits two digits, which are faster than pairs.
        if let Some(sign) = Integers::of(from, to).sign_of_small::<F>() {
            counts.residues += 1;
            return sign;
        }
    }
    let bound = match is_bounded.then(|| pairs::sign::<F, N, D>(from, to)) {
        Some(Ok(sign)) => {
            counts.pairs += 1;
            return sign;
        }
        Some(Err(bound)) => Some(bound),
        None => None,
    };
    if let Some(sign) = Integers::of(from, to).sign_below::<F>(bound) {
        counts.residues += 1;
        return sign;
    }
    counts.bigint += 1;
    big::sign::<F, N, D>(from, to)
}
