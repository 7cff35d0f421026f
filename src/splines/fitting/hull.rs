//! A convex border around places: their hull, widened, with knots along it.
//!
//! Knots of the border are strictly convex: three of them on a line except for rounding would have functions
//! as narrow as rounding errors. So each side is bent outwards a little, by a part of the angles at its ends.

use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};

/// Directions in which the hull is widened: its corners become regular polygons.
const DIRECTIONS: usize = 16;
/// Corners of the hull that stand out by less than this part of the width are left out.
const FLAT: f64 = 0.25;
/// The same for corners of the widened hull.
const PARALLEL: f64 = 1e-3;
/// The angle of a bent side with its chord, as a part of the angle between sides, at most.
const BENT: f64 = 0.25;
/// Three knots of a side have a height of so many rounding errors, at least.
const STEEP: f64 = 64.0;
/// Knots along a side, at most.
const KNOTS_MAX: usize = 10_000;

/// A convex polygon, counterclockwise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Border {
    corners: Vec<Point2>,
    width: f64,
}

impl Border {
    /// The places that are at most `width` from the convex hull of places that span an area; the distance is
    /// up to a third less at corners, and two hundredths along sides.
    pub(super) fn around(places: &[Point2], width: f64) -> Border {
        let corners = simplified(hull(places.to_vec()), FLAT * width);
        let turns = (0..DIRECTIONS).map(|i| std::f64::consts::TAU * (i as f64 + 0.5) / DIRECTIONS as f64);
        let steps: Vec<Point2> = turns.map(|turn| [width * turn.cos(), width * turn.sin()]).collect();
        let moved = corners
            .iter()
            .flat_map(|corner| steps.iter().map(move |step| [corner[0] + step[0], corner[1] + step[1]]));
        // Sides along directions of these polygons are parallel, except for rounding.
        Border { corners: simplified(hull(moved.collect()), PARALLEL * width), width }
    }

    /// How far inside of all sides a place is; negative outside.
    pub(super) fn depth(&self, place: Point2) -> f64 {
        self.sides().map(|[p, q]| above([p, q], place)).fold(f64::INFINITY, f64::min)
    }

    fn sides(&self) -> impl Iterator<Item = [Point2; 2]> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(&p, &q)| [p, q])
    }

    /// Knots along the border, as far apart as `size` says for each place, or so far that they are strictly
    /// convex whatever the errors of their coordinates, which are at most `rounding`.
    pub(super) fn knots(&self, rounding: f64, size: impl Fn(Point2) -> f64) -> Vec<Point2> {
        let sides: Vec<[Point2; 2]> = self.sides().collect();
        let angles: Vec<f64> = sides.iter().map(|[p, q]| (q[1] - p[1]).atan2(q[0] - p[0])).collect();
        let count = sides.len();
        let turn = |from: usize, to: usize| (angles[to] - angles[from]).rem_euclid(std::f64::consts::TAU);
        let mut knots = Vec::new();
        for (at, &[p, q]) in sides.iter().enumerate() {
            let least = turn((at + count - 1) % count, at).min(turn(at, (at + 1) % count));
            let length = (q[0] - p[0]).hypot(q[1] - p[1]);
            // The middle is farther out by a quarter of the width at most.
            let bent = (BENT * least).min(self.width / length);
            // Knots of a parabola that are h apart have heights of h^2 times this angle over the length.
            let least = (STEEP * rounding * length / bent).sqrt();
            let size = |place: Point2| size(place).max(least);
            knots.extend(parts([p, q], &size).into_iter().map(|part| {
                // A parabola that leaves its chord at this angle.
                let by = bent * part * (1.0 - part);
                [
                    p[0] + part * (q[0] - p[0]) + by * (q[1] - p[1]),
                    p[1] + part * (q[1] - p[1]) - by * (q[0] - p[0]),
                ]
            }));
        }
        knots
    }
}

/// Where knots are on a side, from its start, without its end.
fn parts([p, q]: [Point2; 2], size: &impl Fn(Point2) -> f64) -> Vec<f64> {
    let length = (q[0] - p[0]).hypot(q[1] - p[1]);
    let (mut parts, mut at) = (vec![0.0], 0.0);
    while parts.len() < KNOTS_MAX {
        let part = at / length;
        at += size([p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1])]).max(length / KNOTS_MAX as f64);
        if at >= length {
            break;
        }
        parts.push(at);
    }
    // Stretched so that the last step is about as long as the others.
    let rest = length - parts[parts.len() - 1];
    let step = at - parts[parts.len() - 1];
    if parts.len() > 1 && rest < 0.5 * step {
        parts.pop();
    }
    let whole = length / (parts[parts.len() - 1] + step).max(f64::MIN_POSITIVE);
    parts.iter().map(|at| (at * whole.clamp(0.5, 2.0) / length).min(1.0)).filter(|&part| part < 1.0).collect()
}

/// The distance of a place from a line, positive to the left.
fn above([p, q]: [Point2; 2], place: Point2) -> f64 {
    let [x, y] = [q[0] - p[0], q[1] - p[1]];
    (x * (place[1] - p[1]) - y * (place[0] - p[0])) / x.hypot(y)
}

/// Some corners of a convex polygon; all others are at most so far outside of it. At least three are left.
///
/// Cost: proportional to the number of corners, because the farthest one from a chord moves along with its
/// end.
fn simplified(corners: Vec<Point2>, far: f64) -> Vec<Point2> {
    let count = corners.len();
    if count <= 3 {
        return corners;
    }
    let (mut kept, mut farthest) = (vec![0], 1);
    for end in 2..=count {
        let chord = [corners[kept[kept.len() - 1]], corners[end % count]];
        let out = |at: usize| -above(chord, corners[at]);
        while farthest + 1 < end && out(farthest + 1) >= out(farthest) {
            farthest += 1;
        }
        if out(farthest) > far {
            kept.push(end - 1);
            farthest = end;
        }
    }
    match kept.len() {
        3.. => kept.into_iter().map(|at| corners[at]).collect(),
        _ => simplified(corners, 0.5 * far),
    }
}

/// The strict corners of the convex hull, counterclockwise (Andrew 1979).
fn hull(mut places: Vec<Point2>) -> Vec<Point2> {
    places.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    places.dedup();
    let mut predicates = FiniteFloatPredicates::default();
    let mut half = |places: &mut dyn Iterator<Item = &Point2>| {
        let mut chain: Vec<Point2> = Vec::new();
        for &place in places {
            while let [.., p, q] = chain[..]
                && predicates.orient2d(p, q, place) != Sign::Positive
            {
                chain.pop();
            }
            chain.push(place);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut places.iter());
    let upper = half(&mut places.iter().rev());
    [lower, upper].concat()
}

/// The corners of the hull of some places, which may be on a line.
pub fn hull_corners(places: &[Point2]) -> Vec<Point2> {
    hull(places.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    fn is_strictly_convex(polygon: &[Point2]) -> bool {
        let count = polygon.len();
        let mut predicates = FiniteFloatPredicates::default();
        (0..count).all(|at| {
            let [p, q, r] = [0, 1, 2].map(|by| polygon[(at + by) % count]);
            predicates.orient2d(p, q, r) == Sign::Positive
        })
    }

    #[test]
    fn borders_are_strictly_convex_and_hold_all_places() {
        let mut random = Random::new(3);
        let square: Vec<Point2> = (0..500).map(|_| [5e6 + random.unit(), 1e6 + random.unit()]).collect();
        let strip: Vec<Point2> = square.iter().map(|[x, y]| [x * 0.9, 0.43 * x + 1e-3 * y]).collect();
        let disc: Vec<Point2> = (0..2000).map(|i| [f64::from(i).cos(), f64::from(i).sin()]).collect();
        let lattice: Vec<Point2> = (0..100).map(|i| [f64::from(i % 10), f64::from(i / 10)]).collect();
        for (places, width) in [(square, 0.05), (strip, 0.02), (disc, 0.1), (lattice, 1.0)] {
            let border = Border::around(&places, width);
            let rounding = f64::EPSILON * places.as_flattened().iter().fold(0.0, |most, x| x.abs().max(most));
            assert!(is_strictly_convex(&border.corners));
            for size in [width, 0.1 * width, 100.0 * width] {
                let knots = border.knots(rounding, |_| size);
                assert!(is_strictly_convex(&knots), "{size}: {knots:?}");
                assert!(places.iter().all(|&place| border.depth(place) > 0.6 * width));
                // Knots are outside of the polygon, or on it, by a small part of the width.
                assert!(knots.iter().all(|&knot| (-0.5 * width..1e-9).contains(&border.depth(knot))));
            }
            let steps = border.knots(rounding, |_| 0.1 * width);
            let longest = (1..steps.len())
                .map(|i| (steps[i][0] - steps[i - 1][0]).hypot(steps[i][1] - steps[i - 1][1]));
            let longest = longest.fold(0.0, f64::max);
            assert!((0.05 * width..0.21 * width).contains(&longest), "{longest}");
        }
    }
}
