//! The least and the greatest value of a spline.
//!
//! Values are compared at all Greville sites and knots in the domain. From each of the best, a search goes to
//! better neighbours (Hooke and Jeeves 1961): the best one alone may be below a higher peak beside others.

use super::layout::Spline;
use crate::bases::Scratch;
use spmesh_delaunay::predicates::Point2;

/// Places from which an extreme is searched.
const STARTS: usize = 16;
/// Halvings of the step of the search for an extreme.
const HALVINGS: usize = 12;
/// Steps of the same length.
const STEPS_MAX: usize = 64;
/// Splines that leave the range of elevations by more than this share of it get a warning.
pub const EXCESS_MAX: f64 = 0.25;
/// Values that leave the range by less than this part of the greatest magnitude do so by rounding.
const ROUNDING: f64 = 1e-9;

/// The least and the greatest value of a spline, each with its place in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// The least value.
    pub least: (f64, Point2),
    /// The greatest value.
    pub greatest: (f64, Point2),
}

/// How far a spline leaves the range of elevations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// The value that is farthest outside.
    pub value: f64,
    /// Its place, in world coordinates.
    pub place: Point2,
    /// Its distance from the range, divided by the range; infinite if all elevations are equal.
    pub share: f64,
}

impl Extent {
    /// The extent of a spline; `None` if it has no domain.
    ///
    /// Cost: an evaluation at each Greville site and knot. Accuracy: rounding errors for the places, and
    /// local extremes there; a narrow peak between all sites may be higher.
    pub fn of(spline: &Spline) -> Option<Extent> {
        let basis = &spline.layout.basis;
        let mut scratch = Scratch::default();
        let mut value = |x: Point2| -> Option<f64> {
            let alive = basis.is_in_domain(x).then(|| basis.at(x, &mut scratch))?;
            Some(alive.iter().map(|&(function, value)| spline.coefficients[function as usize] * value).sum())
        };
        let sites = (0..basis.len()).map(|function| basis.greville(function));
        let knots = spline.layout.knots.points().iter().copied();
        let mut all: Vec<_> = sites.chain(knots).filter_map(|x| Some((value(x)?, x))).collect();
        all.retain(|(value, _)| value.is_finite());
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let step = step(basis.domain_corners(), basis.len());
        let order = |a: &(f64, Point2), b: &(f64, Point2)| a.0.total_cmp(&b.0);
        let lowest = all.iter().take(STARTS).map(|&(value, x)| (-value, x));
        let least =
            lowest.map(|start| climbed(start, step, &mut |x| value(x).map(|value| -value))).max_by(order)?;
        let highest = all.iter().rev().take(STARTS);
        let greatest = highest.map(|&start| climbed(start, step, &mut value)).max_by(order)?;
        let to_world = |x| spline.layout.frame.to_decimal(x);
        Some(Extent { least: (-least.0, to_world(least.1)), greatest: (greatest.0, to_world(greatest.1)) })
    }

    /// How far it leaves a range; `None` if it does not.
    pub fn excess(&self, [low, high]: [f64; 2]) -> Option<Excess> {
        let (below, above) = (low - self.least.0, self.greatest.0 - high);
        let ((value, place), by) = if below > above { (self.least, below) } else { (self.greatest, above) };
        let rounding = ROUNDING * low.abs().max(high.abs());
        (by > rounding).then_some(Excess { value, place, share: by / (high - low) })
    }
}

/// About the distance of Greville sites.
fn step(corners: Vec<Point2>, functions: usize) -> f64 {
    let side = |axis: usize| {
        let all = || corners.iter().map(move |corner| corner[axis]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    (side(0) * side(1) / functions as f64).sqrt()
}

/// A local maximum near a place.
fn climbed(
    mut best: (f64, Point2),
    mut step: f64,
    value: &mut impl FnMut(Point2) -> Option<f64>,
) -> (f64, Point2) {
    for _ in 0..HALVINGS {
        for _ in 0..STEPS_MAX {
            let [x, y] = best.1;
            let around = [[x + step, y], [x - step, y], [x, y + step], [x, y - step]];
            let values = around.into_iter().filter_map(|x| Some((value(x)?, x)));
            match values.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|found| found.0 > best.0) {
                Some(found) => best = found,
                None => break,
            }
        }
        step *= 0.5;
    }
    best
}
