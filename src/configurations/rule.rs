//! Polygon rules: they select one of the triangulations of a link.

use super::knots::Knots;
use super::lift::Lift;
use spmesh_base::error::{Error, Result};

/// Scale of coordinates and values, so that sums of differences stay finite even for the largest f64. Scaling
/// is exact except for numbers near zero.
const SCALE: f64 = 1.0 / (1u64 << 40) as f64;
/// Greater than any difference of scaled numbers, and small enough for long sums.
const WEIGHT_MAX: f64 = f64::MAX * SCALE;

/// How links are triangulated.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// The constrained Delaunay triangulation; with the Delaunay triangulation as the start, this gives
    /// exactly the Delaunay configurations.
    Delaunay,
    /// The constrained triangulation by another lift; with [`super::Start::lifted`], projective
    /// configurations (thesis 7.3).
    Lifted(Lift),
    /// The least sum of edge lengths.
    MinWeight,
    /// Cuts ears in order, starting from the least knot.
    Ear,
    /// As many diagonals as possible from the least knot.
    Fan,
    /// At random, by a seed and the set, so that the result does not depend on the order of links.
    Random(u64),
    /// The least extent of edges perpendicular to a direction, in degrees counterclockwise from the x axis.
    Aligned(f64),
    /// Data-dependent, with one value per knot: the least sum of differences of values along edges, so that
    /// edges follow level lines.
    Data(Vec<f64>),
    /// Data-dependent, with one gradient per knot: the least sum of jumps of slope along edges.
    Gradients(Vec<[f64; 2]>),
}

impl Rule {
    /// Checks that the parameters fit `knots`.
    ///
    /// # Errors
    /// An angle that is not finite; a number of values other than the number of knots; values that are not
    /// finite.
    pub fn check(&self, knots: &Knots) -> Result<()> {
        match self {
            Rule::Lifted(lift) => lift.check(knots),
            Rule::Aligned(degrees) if !degrees.is_finite() => {
                Err(Error::usage(format!("the angle must be a finite number of degrees, not {degrees}")))
            }
            Rule::Data(values) => check_values(knots, values.iter().map(|&value| [value, 0.0])),
            Rule::Gradients(gradients) => check_values(knots, gradients.iter().copied()),
            _ => Ok(()),
        }
    }

    /// The weight of a diagonal, for rules that minimise a sum. Weights and their sums are finite for all
    /// coordinates and values.
    pub(super) fn weight(&self, knots: &Knots, a: u32, b: u32) -> f64 {
        let (p, q) = (knots.at(a), knots.at(b));
        let less = |from: f64, to: f64| SCALE * to - SCALE * from;
        let [x, y] = [less(p[0], q[0]), less(p[1], q[1])];
        let weight = match self {
            Rule::Aligned(degrees) => {
                let (sin, cos) = degrees.to_radians().sin_cos();
                (x * sin - y * cos).abs()
            }
            Rule::Data(values) => less(values[a as usize], values[b as usize]).abs(),
            Rule::Gradients(gradients) => {
                let (g, h) = (gradients[a as usize], gradients[b as usize]);
                (less(g[0], h[0]) * x + less(g[1], h[1]) * y).abs()
            }
            _ => x.hypot(y),
        };
        // The product of large gradients and coordinates may be infinite or NaN, which compares false.
        if weight < WEIGHT_MAX { weight } else { WEIGHT_MAX }
    }
}

fn check_values(knots: &Knots, values: impl ExactSizeIterator<Item = [f64; 2]>) -> Result<()> {
    if values.len() != knots.len() {
        let message = format!("{} values for {} knots: one each is needed", values.len(), knots.len());
        return Err(Error::usage(message));
    }
    match values.enumerate().find(|(_, value)| !value.iter().all(|number| number.is_finite())) {
        Some((bad, value)) => {
            Err(Error::malformed(format!("value is not finite: {value:?}")).at(format!("knot {bad}")))
        }
        None => Ok(()),
    }
}
