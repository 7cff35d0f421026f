//! Polygon rules: which of the triangulations of a link is taken.

use super::knots::Knots;
use super::lift::Lift;
use spmesh_core::error::{Error, Result};

/// What coordinates and values are multiplied by, so that sums of differences of the greatest are finite;
/// exact but for numbers next to zero.
const SCALE: f64 = 1.0 / (1u64 << 40) as f64;
/// More than any difference of scaled numbers, and little enough for long sums.
const WEIGHT_MAX: f64 = f64::MAX * SCALE;

/// How links are triangulated.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// The constrained Delaunay triangulation; with the Delaunay triangulation as the start, this gives
    /// exactly the Delaunay configurations.
    Delaunay,
    /// The same for another lift; with [`super::Start::lifted`], projective configurations (thesis 7.3).
    Lifted(Lift),
    /// The least sum of lengths of edges.
    MinWeight,
    /// Ears are cut in order, from the least knot on.
    Ear,
    /// As many diagonals as possible from the least knot.
    Fan,
    /// At random: from a seed and the set, so that the order of links does not matter.
    Random(u64),
    /// The least extent of edges across a direction, in degrees counterclockwise from the x axis.
    Aligned(f64),
    /// Data-dependent: the least sum of differences of values, one per knot, along edges, so that edges
    /// follow level lines.
    Data(Vec<f64>),
    /// The same for a gradient at each knot: the least sum of jumps of slope along edges.
    Gradients(Vec<[f64; 2]>),
}

impl Rule {
    /// Whether the parameters make sense for `knots`.
    ///
    /// # Errors
    /// An angle that is not finite, values that are not as many as knots or not finite.
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

    /// What a diagonal costs, for rules that minimise a sum: finite, and so are sums, whatever coordinates
    /// and values are.
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
        // Of great gradients and coordinates the product may be no number, and is not less than any.
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
