//! Other lifts than x² + y²: projective configurations (thesis 7.3).

use super::knots::Knots;
use num_bigint::BigInt;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{Sign, exact_integers};

/// The function that replaces x² + y² in the in-circle determinant.
#[derive(Debug, Clone, PartialEq)]
pub enum Lift {
    /// Values of a strictly convex function at the knots.
    Heights(Vec<f64>),
    /// x² + y² - w, for a weight w of each knot: power circles.
    Weights(Vec<f64>),
}

/// Relative error bound, larger than twelve roundings of each term.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// If the sum of magnitudes is in this range, no term overflows, and underflow is negligible.
const TRUSTED: std::ops::Range<f64> = 1e-150..1e250;

impl Lift {
    fn values(&self) -> &[f64] {
        match self {
            Lift::Heights(values) | Lift::Weights(values) => values,
        }
    }

    /// Checks that there is one finite value per knot, and that knots are distinct: the limit of copies is
    /// undefined under a function of which only values are known.
    pub(super) fn check(&self, knots: &Knots) -> Result<()> {
        let (found, expected) = (self.values().len(), knots.len());
        if found != expected {
            return Err(Error::usage(format!("{found} values to lift {expected} knots: one each is needed")));
        }
        if let Some(bad) = self.values().iter().position(|value| !value.is_finite()) {
            return Err(Error::malformed("value to lift is not finite").at(format!("knot {bad}")));
        }
        if knots.has_copies() {
            return Err(Error::usage(
                "a lift does not tell knots at one place apart: use the rule `delaunay`",
            ));
        }
        Ok(())
    }

    /// Positive if the last of four lifted knots is below the plane of the others, which are
    /// counterclockwise; without perturbation.
    pub(super) fn sign(&self, knots: &Knots, ids: [u32; 4]) -> Sign {
        let d = knots.at(ids[3]);
        let value = |id: u32| self.values()[id as usize];
        let rows = [ids[0], ids[1], ids[2]].map(|id| {
            let p = knots.at(id);
            let at = [p[0] - d[0], p[1] - d[1]];
            let raised = value(id) - value(ids[3]);
            match self {
                Lift::Heights(_) => (at, raised, raised.abs()),
                Lift::Weights(_) => {
                    let square = at[0] * at[0] + at[1] * at[1];
                    (at, square - raised, square + value(id).abs() + value(ids[3]).abs())
                }
            }
        });
        let (mut sum, mut magnitude) = (0.0, 0.0);
        for i in 0..3 {
            let ([px, py], [qx, qy]) = (rows[(i + 1) % 3].0, rows[(i + 2) % 3].0);
            sum += rows[i].1 * (px * qy - py * qx);
            magnitude += rows[i].2 * ((px * qy).abs() + (py * qx).abs());
        }
        if TRUSTED.contains(&magnitude) && f64::abs(sum) > ROUNDING * magnitude {
            return Sign::of(sum);
        }
        self.exact_sign(ids.map(|id| knots.at(id)), ids.map(value))
    }

    /// [`Lift::sign`] in big integers.
    #[cold]
    fn exact_sign(&self, points: [[f64; 2]; 4], values: [f64; 4]) -> Sign {
        let mut numbers: Vec<[f64; 3]> = (0..4).map(|i| [points[i][0], points[i][1], values[i]]).collect();
        numbers.push([1.0, 0.0, 0.0]);
        let numbers = exact_integers::integers_of(&numbers);
        let one = &numbers[4][0];
        let [a, b, c, d] = std::array::from_fn(|i| {
            let [x, y, value] = &numbers[i];
            let lift = match self {
                Lift::Heights(_) => value.clone(),
                Lift::Weights(_) => x * x + y * y - value * one,
            };
            [x.clone(), y.clone(), lift]
        });
        let [a, b, c] = [a, b, c].map(|p: [BigInt; 3]| [&p[0] - &d[0], &p[1] - &d[1], &p[2] - &d[2]]);
        let cross = |p: &[BigInt; 3], q: &[BigInt; 3]| &p[0] * &q[1] - &p[1] * &q[0];
        Sign::of(&a[2] * cross(&b, &c) + &b[2] * cross(&c, &a) + &c[2] * cross(&a, &b))
    }
}
