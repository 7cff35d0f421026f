//! Points with weights: the in-sphere determinant with lifts that are less by the weights.

use std::cmp::Ordering;

use num_bigint::BigInt;

use super::dyadic::Dyadic;
use super::space::{
    LIFT_OF_FILTER, UNDERFLOW_OF_SPHERE, Xyz, estimated_lifted, in_raised_sphere, in_sphere, lifted_volumes,
    square,
};
use super::{Decided, ROUNDING, decide, decided};

/// A position with its weight.
pub(crate) type Weighted = (Xyz, f64);

/// Whether the power distance of `e` from the orthocentre of the positive tetrahedron `a`, `b`, `c`, `d` is
/// less (`Greater`: in conflict), greater (`Less`) or the same as that of its corners. With equal weights
/// this is [`in_sphere`].
pub(crate) fn in_orthosphere([a, b, c, d]: [Weighted; 4], e: Weighted) -> Decided {
    if [a, b, c, d].iter().all(|(_, weight)| *weight == e.1) {
        return in_sphere(a.0, b.0, c.0, d.0, e.0);
    }
    decided(filtered([a, b, c, d], e), || exact([a, b, c, d], e))
}

/// How ties are decided, which weights do not change: as [`in_raised_sphere`].
pub(crate) fn in_raised_orthosphere([a, b, c, d]: [Weighted; 4], e: Weighted) -> Ordering {
    in_raised_sphere(a.0, b.0, c.0, d.0, e.0)
}

/// As the filter of spheres, with two roundings more in a lift, those of the difference of two weights and of
/// its sum with the square: 18.1 `ROUNDING` in all, and 20 cover it and the sum of the magnitudes.
/// Differences of weights are below 2^400, as their magnitudes count as lifts.
fn filtered(abcd: [Weighted; 4], e: Weighted) -> Option<Ordering> {
    let heavier = abcd.map(|(_, weight)| weight - e.1);
    let (determinant, magnitude, lifts) = estimated_lifted(abcd.map(|(at, _)| at), e.0, heavier);
    decide(determinant, 20.0 * ROUNDING * magnitude + UNDERFLOW_OF_SPHERE).filter(|_| lifts < LIFT_OF_FILTER)
}

fn exact(abcd: [Weighted; 4], e: Weighted) -> Ordering {
    let five = [abcd[0], abcd[1], abcd[2], abcd[3], e];
    let unit = unit_of(&five);
    let [others @ .., last] = five.map(|(at, weight)| {
        // Weights are squares of lengths.
        (at.map(|value| whole(value, unit)), whole(weight, 2 * unit))
    });
    let vectors = others
        .each_ref()
        .map(|(at, _)| -> [BigInt; 3] { std::array::from_fn(|axis| &at[axis] - &last.0[axis]) });
    let lifts = std::array::from_fn(|i| square(&vectors[i]) - (&others[i].1 - &last.1));
    lifted_volumes(vectors, lifts).cmp(&BigInt::ZERO)
}

/// An exponent such that all coordinates are multiples of that power of two, and all weights of its square.
fn unit_of(points: &[Weighted; 5]) -> i32 {
    let exponent = |value: f64| {
        let Dyadic { mantissa, exponent } = Dyadic::of(value);
        if mantissa == 0 { i32::MAX } else { exponent }
    };
    let units = points.iter().map(|(at, weight)| {
        let of_weight = exponent(*weight);
        at.iter().map(|&value| exponent(value)).fold(of_weight.div_euclid(2), i32::min)
    });
    // Half of `i32::MAX` stands for five zeros.
    units.fold(0, i32::min)
}

/// The value as a multiple of 2^unit, which it must be.
fn whole(value: f64, unit: i32) -> BigInt {
    let Dyadic { mantissa, exponent } = Dyadic::of(value);
    if mantissa == 0 { BigInt::ZERO } else { BigInt::from(mantissa) << (exponent - unit) }
}

#[cfg(test)]
mod tests {
    use super::super::random;
    use super::*;

    const CORNER: [Xyz; 4] = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];

    /// The orthocentre of four corners of weight w is (1, 1, 1), with the power 3 - w. A fifth point at
    /// distance d is on it if its weight is d² - 3 + w.
    #[test]
    fn orthogonal_points_are_found_at_every_size() {
        for scale in [1.0, 3.0, 1e7, 1e9 / 7.0, 2f64.powi(40), 2f64.powi(300), 2f64.powi(-400)] {
            let weighed = |at: Xyz, weight: f64| (at.map(|c| c * scale), weight * scale * scale);
            for w in [0.0, 1.0, -5.0, 64.0] {
                let corners = CORNER.map(|at| weighed(at, w));
                let place = |e: Weighted| in_orthosphere(corners, e).sign;
                for (at, square) in [([1.0, 1.0, 1.0], 0.0), ([5.0, 1.0, 1.0], 16.0), ([1.0, 1.0, 0.5], 0.25)]
                {
                    let e = weighed(at, square - 3.0 + w);
                    // The scale may be no power of two, so that squares of it are rounded.
                    if scale.log2().fract() == 0.0 {
                        assert_eq!(place(e), Ordering::Equal, "{scale} {w} {at:?}");
                    }
                    let apart = 1e-9 * scale * scale * (w.abs() + 1.0);
                    assert_eq!(place((e.0, e.1 + apart)), Ordering::Greater, "{scale} {w} {at:?}");
                    assert_eq!(place((e.0, e.1 - apart)), Ordering::Less, "{scale} {w} {at:?}");
                }
            }
        }
    }

    #[test]
    fn the_last_bit_of_a_weight_decides() {
        let corners = CORNER.map(|at| (at, 0.75));
        let place = |weight: f64| in_orthosphere(corners, ([3.0, 1.0, 1.0], weight)).sign;
        assert_eq!(place(1.75), Ordering::Equal);
        assert_eq!(place(1.75f64.next_up()), Ordering::Greater);
        assert_eq!(place(1.75f64.next_down()), Ordering::Less);
    }

    /// A filter with a wrong bound would disagree with the integers near zero.
    #[test]
    fn filter_and_integers_agree() {
        let mut random = random(0x9e37_79b9_7f4a_7c15);
        let mut decided = 0;
        for round in 0..20_000 {
            let centre = [random(1e3), random(1e3), random(1e3)];
            let power = random(8.0);
            let mut point = |error: f64| {
                let offset = [random(4.0), random(4.0), random(4.0)];
                let at: Xyz = std::array::from_fn(|axis| centre[axis] + offset[axis]);
                (at, offset.iter().map(|c| c * c).sum::<f64>() - power + random(error))
            };
            let corners = [(); 4].map(|()| point(0.0));
            let e = point([1e-10, 1e-12, 1e-14][round % 3]);
            if let Some(sign) = filtered(corners, e) {
                decided += 1;
                assert_eq!(sign, exact(corners, e), "{corners:?} {e:?}");
            }
        }
        assert!((100..20_000).contains(&decided), "{decided} reached the filter");
    }
}
