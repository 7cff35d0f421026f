//! Functions whose knots are on one line except for rounding.
//!
//! If a straight border is rotated, rounding moves its knots off the line. Functions of these knots then have
//! supports as wide as rounding errors. They are needed there for functions to sum to one, but no observation
//! determines them.

use super::basis::Basis;
use spmesh_delaunay::predicates::{Point2, area};

/// The greatest width of a support on a line, as a part of its length...
const WIDTH: f64 = 1e-9;
/// ...and of the greatest coordinate.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Basis {
    /// The numbers of the functions whose knots are on one line except for rounding, in order.
    ///
    /// Cost: a pass over all elements.
    pub(crate) fn narrow(&self) -> Vec<usize> {
        let mut knots = vec![Vec::new(); self.len()];
        for element in 0..self.elements.len() {
            for share in self.elements.shares(element) {
                knots[share.function as usize].extend_from_slice(self.elements.knots(element));
            }
        }
        let at = |ids: &[u32]| ids.iter().map(|&id| self.points[id as usize]).collect::<Vec<Point2>>();
        (0..self.len()).filter(|&function| is_narrow(&at(&knots[function]))).collect()
    }
}

fn is_narrow(points: &[Point2]) -> bool {
    let Some(&first) = points.first() else { return false };
    let distance = |p: Point2, q: Point2| (p[0] - q[0]).hypot(p[1] - q[1]);
    let last = points.iter().copied().max_by(|&p, &q| distance(first, p).total_cmp(&distance(first, q)));
    let last = last.unwrap_or(first);
    let length = distance(first, last);
    let width = points.iter().map(|&p| 2.0 * area(first, last, p).abs() / length).fold(0.0, f64::max);
    let size = points.iter().flatten().fold(0.0, |size: f64, c| size.max(c.abs()));
    width <= WIDTH * length + ROUNDING * size
}
