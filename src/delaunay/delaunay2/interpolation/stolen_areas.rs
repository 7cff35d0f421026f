//! Areas that the Voronoi cell of a target takes from those of its neighbours, in plain arithmetic, with a
//! bound of their errors.

use super::cavity::Cavity;
use crate::predicates::{Centre2, Point2};

const U: f64 = f64::EPSILON / 2.0;

/// Sums of areas, and bounds of sums, have one rounding for each number and few others; each bound is made
/// larger by this, which covers them for up to 10^6 numbers, and terms of order u^2.
const SLACK: f64 = 1.0 + 1e-9;

/// Greatest error of a weight that plain arithmetic may leave.
pub(super) const GREATEST_ERROR: f64 = 1e-12;

/// Areas, with buffers that are reused.
#[derive(Debug, Default)]
pub(super) struct StolenAreas {
    /// Centres of the circles of the triangles.
    old: Vec<Placed>,
    /// Centres of the circles through the target and the ends of an edge of the border.
    new: Vec<Placed>,
}

/// A centre relative to the target.
#[derive(Debug, Clone, Copy)]
struct Placed {
    at: [f64; 2],
    /// Bound of the length of its error.
    error: f64,
}

/// An area, doubled, with a bound of its error.
#[derive(Debug, Clone, Copy)]
struct Area {
    doubled: f64,
    error: f64,
}

impl StolenAreas {
    /// Writes the weights of the second ends of the edges of the border. Returns whether they are certainly
    /// off by less than [`GREATEST_ERROR`]; if not, they mean nothing.
    ///
    /// A weight w = A / T, with the area A and the sum T of all, is off by at most (e + w E) / T, where e is
    /// the error of the area and E the sum of these: by at most 2 E / T.
    ///
    /// Domain: the target, inside of the hull and no vertex, and the vertices are in the range of
    /// [`crate::predicates::BoundedFloatPredicates`].
    pub(super) fn write(
        &mut self,
        points: &[Point2],
        cavity: &Cavity,
        target: Point2,
        weights: &mut Vec<(u32, f64)>,
    ) -> bool {
        let at = |v: u32| points[v as usize];
        self.old.clear();
        let old = cavity.triangles.iter().map(|&[a, b, c]| Placed::new(at(a), at(b), at(c), target));
        self.old.extend(old);
        self.new.clear();
        let new = cavity.border.iter().map(|edge| {
            let [a, b] = edge.ends.map(at);
            Placed::new(target, a, b, target)
        });
        self.new.extend(new);
        weights.clear();
        let (mut total, mut error) = (0.0, 0.0);
        for (place, edge) in cavity.border.iter().enumerate() {
            let fan = cavity.fan(edge).iter().map(|&triangle| self.old[triangle as usize]);
            let ends = [self.new[place], self.new[cavity.next(place)]];
            let area = area(ends[0], fan.chain([ends[1]]));
            weights.push((edge.ends[1], area.doubled.max(0.0)));
            total += area.doubled.max(0.0);
            error += area.error;
        }
        error += weights.len() as f64 * U * total;
        weights.iter_mut().for_each(|(_, weight)| *weight /= total);
        // False for NaN, too, which overflow makes.
        2.0 * SLACK * error <= GREATEST_ERROR * total
    }
}

impl Placed {
    /// The centre of the circle through three points. The way from the target to the origin of the centre is
    /// rounded once, and so is its sum with that from there to the centre. The sum of the magnitudes of
    /// coordinates is at least the length.
    fn new(a: Point2, b: Point2, c: Point2, target: Point2) -> Placed {
        let Centre2 { origin, offset, error } = Centre2::of(a, b, c);
        let to_origin = [origin[0] - target[0], origin[1] - target[1]];
        let at = [to_origin[0] + offset[0], to_origin[1] + offset[1]];
        Placed { at, error: error + U * (length(to_origin) + length(at)) }
    }
}

/// At least the length.
fn length([x, y]: [f64; 2]) -> f64 {
    x.abs() + y.abs()
}

/// The area of a clockwise polygon: a fan of triangles about its first corner, so that polygons far from the
/// target do not lose digits.
///
/// A side of length l with an error e, and the next with l' and e', make a triangle whose doubled area is off
/// by at most l e' + l' e + e e', and by two roundings of the sum of its products, which is at most l l'.
fn area(first: Placed, others: impl Iterator<Item = Placed>) -> Area {
    let (mut doubled, mut error, mut magnitude, mut count) = (0.0, 0.0, 0.0, 2.0);
    let mut last = ([0.0; 2], 0.0, 0.0);
    for other in others {
        let side = [other.at[0] - first.at[0], other.at[1] - first.at[1]];
        let long = length(side);
        let side_error = other.error + first.error + U * long;
        let (last_side, last_long, last_error) = last;
        let product = last_side[1] * side[0] - last_side[0] * side[1];
        doubled += product;
        error += last_long * side_error + (long + side_error) * last_error;
        magnitude += last_long * long;
        count += 1.0;
        last = (side, long, side_error);
    }
    // For each triangle two roundings; for the sum of all, one for each.
    Area { doubled, error: error + count * U * magnitude }
}
