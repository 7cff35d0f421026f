//! Lines whose points may slide along their edges, so that they become smooth but never cross.
//!
//! A line of level k passes each triangle at most once, and each edge at most once. Its points slide along their
//! edges, within the range of elevations less than half an interval from the level, and never reach the ends of the
//! edge. Then corners are cut within triangles. Two lines cannot meet, nor a line itself:
//!
//! * In a triangle, elevations are linear. So its part within [`REACH`] intervals of a level, a strip, is convex.
//!   Strips of different levels are disjoint, because `REACH` is less than one half.
//! * Both points of a line on the border of a triangle are in the strip of its level, and so is the chord between
//!   them. Cutting a corner replaces a point on an edge by two points on the chords on both sides. The segment
//!   between these crosses the edge within the range of the strip, or else a point of this range is kept between
//!   them. So the pieces in both triangles stay in the strip.
//! * In a triangle, there is one piece for each level, in the strip of that level. So pieces of a triangle do not
//!   meet. Pieces of different triangles could only meet on a common edge, where each level has one point, or at a
//!   vertex, which points never reach.
//!
//! This holds before coordinates are rounded: lines closer than a hundredth of the step of the grid may touch.

use super::places::{Plane, Vertex};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;

/// How far elevations of a line may be from its level. Units: intervals.
const REACH: f64 = 0.45;
/// The part at each end of the range on an edge that points do not use.
const MARGIN: f64 = 0.05;
/// Number of times that all points slide.
const ROUNDS: usize = 12;
/// Where corners are cut, as a part of the chord.
const CUT: f64 = 0.25;

/// A point of a line on an edge.
pub(super) trait Place: Copy {
    /// What [`Place::line`] takes for each point, beside the points.
    const SMOOTHED_BYTES: usize;

    /// The point of a level on an edge; `interval` is the distance between levels.
    fn of(plane: &Plane, edge: [&Vertex; 2], elevation: f64, interval: f64) -> Result<Self>;

    /// The places of a whole line.
    fn line(points: Vec<Self>, is_closed: bool, plane: &Plane) -> Vec<Point2>;
}

/// A point that stays where it is.
impl Place for Point2 {
    const SMOOTHED_BYTES: usize = 0;

    #[inline]
    fn of(plane: &Plane, [p, q]: [&Vertex; 2], elevation: f64, _: f64) -> Result<Point2> {
        plane.place(p, q, elevation)
    }

    fn line(points: Vec<Point2>, _: bool, _: &Plane) -> Vec<Point2> {
        points
    }
}

/// A point that may slide along an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slide {
    at: Point2,
    /// The range on the edge.
    range: [Point2; 2],
}

impl Place for Slide {
    /// The next place of each, and three of the smoothed line, whose room may double from two.
    const SMOOTHED_BYTES: usize = 5 * size_of::<Point2>();

    fn of(plane: &Plane, [p, q]: [&Vertex; 2], elevation: f64, interval: f64) -> Result<Slide> {
        let [low, high] = if p.elevation < q.elevation { [p, q] } else { [q, p] };
        let range = [
            (elevation - REACH * interval).max(low.elevation),
            (elevation + REACH * interval).min(high.elevation),
        ];
        let margin = MARGIN * (range[1] - range[0]);
        let range = [range[0] + margin, range[1] - margin];
        let place = |elevation: f64| plane.unrounded(p, q, elevation);
        let at = place(elevation.max(range[0]).min(range[1]))?;
        Ok(Slide { at, range: [place(range[0])?, place(range[1])?] })
    }

    fn line(mut points: Vec<Slide>, is_closed: bool, plane: &Plane) -> Vec<Point2> {
        for _ in 0..ROUNDS {
            let slid = |i: usize| match neighbors(&points, i, is_closed) {
                Some([before, after]) => points[i].towards(middle(before.at, after.at)),
                None => points[i].at,
            };
            let next: Vec<Point2> = (0..points.len()).map(slid).collect();
            points.iter_mut().zip(next).for_each(|(point, at)| point.at = at);
        }
        let mut line = Vec::with_capacity(2 * points.len());
        for (i, point) in points.iter().enumerate() {
            match neighbors(&points, i, is_closed) {
                Some([before, after]) => point.cut(before.at, after.at, &mut line),
                None => line.push(point.at),
            }
        }
        line.into_iter().map(|at| plane.rounded(at)).collect()
    }
}

/// The points before and after a point; `None` at the ends of a line.
fn neighbors(points: &[Slide], i: usize, is_closed: bool) -> Option<[&Slide; 2]> {
    let last = points.len() - 1;
    match i {
        0 if is_closed => Some([&points[last], points.get(1)?]),
        _ if i == last && is_closed => Some([&points[last - 1], &points[0]]),
        _ => Some([points.get(i.checked_sub(1)?)?, points.get(i + 1)?]),
    }
}

impl Slide {
    /// Halfway from here to the place of the range that is nearest to a target.
    fn towards(&self, target: Point2) -> Point2 {
        let [from, to] = self.range;
        let along = difference(from, to);
        let share = dot(difference(from, target), along) / dot(along, along);
        // NaN if the range is a point.
        if share.is_nan() { self.at } else { middle(self.at, at(self.range, share.clamp(0.0, 1.0))) }
    }

    /// Cuts the corner between two neighbours.
    fn cut(&self, before: Point2, after: Point2, line: &mut Vec<Point2>) {
        let [first, last] = [before, after].map(|neighbor| at([self.at, neighbor], CUT));
        line.push(first);
        let along = difference(self.range[0], self.range[1]);
        let across = difference(first, last);
        let share = cross(difference(self.range[0], first), across) / cross(along, across);
        // The segment misses the range, or is parallel to it.
        if !(0.0..=1.0).contains(&share) {
            line.push(if share.is_finite() { at(self.range, share.clamp(0.0, 1.0)) } else { self.at });
        }
        line.push(last);
    }
}

fn middle(p: Point2, q: Point2) -> Point2 {
    at([p, q], 0.5)
}

/// The place at a share of the way between two places.
fn at([from, to]: [Point2; 2], share: f64) -> Point2 {
    [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
}

fn difference(from: Point2, to: Point2) -> Point2 {
    [to[0] - from[0], to[1] - from[1]]
}

fn dot(u: Point2, v: Point2) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

fn cross(u: Point2, v: Point2) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}
