//! The definition of the constrained Delaunay triangulation, of points with small integer coordinates: every
//! triangle is tried against every point that can be seen from it. Cost: O(n^5).

use super::as_set;
use super::exact::{ExactPoint, exact_points, incircle_perturbed};
use std::cmp::Ordering;

type Vector = [i128; 2];

/// Integer points and segments between them.
pub struct Scene {
    points: Vec<Vector>,
    exact: Vec<ExactPoint>,
    /// Indices of points.
    segments: Vec<[usize; 2]>,
}

fn minus(p: Vector, q: Vector) -> Vector {
    [p[0] - q[0], p[1] - q[1]]
}

fn cross(p: Vector, q: Vector) -> i128 {
    p[0] * q[1] - p[1] * q[0]
}

impl Scene {
    /// Distinct points, and segments that have nothing in common but points at their ends or amid them.
    pub fn new(points: &[[i64; 2]], segments: &[[u32; 2]]) -> Scene {
        let floats: Vec<[f64; 2]> = points.iter().map(|point| point.map(|c| c as f64)).collect();
        Scene {
            points: points.iter().map(|point| point.map(i128::from)).collect(),
            exact: exact_points(&floats),
            segments: segments.iter().map(|ends| ends.map(|end| end as usize)).collect(),
        }
    }

    fn turn(&self, a: usize, b: usize, c: usize) -> i128 {
        cross(minus(self.points[b], self.points[a]), minus(self.points[c], self.points[a])).signum()
    }

    /// Whether both points lie on the segment.
    pub fn is_on(&self, segment: [usize; 2], ends: [usize; 2]) -> bool {
        let [p, q] = segment;
        ends.into_iter().all(|end| {
            let [to_p, to_q] = [p, q].map(|x| minus(self.points[x], self.points[end]));
            cross(to_p, to_q) == 0 && to_p[0] * to_q[0] + to_p[1] * to_q[1] <= 0
        })
    }

    /// The triangles of the definition.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let count = self.points.len();
        let mut found = Vec::new();
        for a in 0..count {
            for b in a + 1..count {
                for c in b + 1..count {
                    let triangle = match self.turn(a, b, c) {
                        0 => continue,
                        1 => [a, b, c],
                        _ => [a, c, b],
                    };
                    if self.is_empty(triangle) && self.is_uncrossed(triangle) && self.is_delaunay(triangle) {
                        found.push(triangle.map(|v| v as u32));
                    }
                }
            }
        }
        as_set(found)
    }

    /// Whether no other point lies in the closed triangle.
    fn is_empty(&self, [a, b, c]: [usize; 3]) -> bool {
        (0..self.points.len())
            .filter(|d| ![a, b, c].contains(d))
            .all(|d| [[a, b], [b, c], [c, a]].into_iter().any(|[p, q]| self.turn(p, q, d) < 0))
    }

    /// Whether no segment meets the interior of the triangle.
    fn is_uncrossed(&self, [a, b, c]: [usize; 3]) -> bool {
        self.segments.iter().all(|&[p, q]| {
            // Two convex sets with disjoint interiors have a line between them that is along a side of one.
            let sides = [[a, b], [b, c], [c, a]];
            let is_outside = |[u, v]: [usize; 2]| self.turn(u, v, p) <= 0 && self.turn(u, v, q) <= 0;
            let corners = [a, b, c].map(|v| self.turn(p, q, v));
            sides.into_iter().any(is_outside)
                || corners.iter().all(|&turn| turn <= 0)
                || corners.iter().all(|&turn| turn >= 0)
        })
    }

    /// Whether no point inside of the circle can be seen from the interior of the triangle.
    fn is_delaunay(&self, triangle: [usize; 3]) -> bool {
        let [a, b, c] = triangle;
        (0..self.points.len()).filter(|d| !triangle.contains(d)).all(|d| {
            let circle = [a, b, c, d].map(|v| &self.exact[v]);
            incircle_perturbed(circle) < 0 || !self.can_see(d, triangle)
        })
    }

    /// Whether some open part of the triangle can be seen from a point outside of it.
    fn can_see(&self, from: usize, triangle: [usize; 3]) -> bool {
        let origin = self.points[from];
        let corners = triangle.map(|v| minus(self.points[v], origin));
        // The triangle is seen under less than half a turn, so its corners have a first and a last one.
        let by_turn = |p: &Vector, q: &Vector| 0.cmp(&cross(*p, *q));
        let first = corners.into_iter().min_by(by_turn).expect("three corners");
        let last = corners.into_iter().max_by(by_turn).expect("three corners");
        let mut directions: Vec<Vector> = self.points.iter().map(|&point| minus(point, origin)).collect();
        directions.retain(|&d| cross(first, d) >= 0 && cross(d, last) >= 0 && d != [0, 0]);
        directions.sort_by(by_turn);
        directions.windows(2).filter(|pair| cross(pair[0], pair[1]) > 0).any(|pair| {
            let between = [pair[0][0] + pair[1][0], pair[0][1] + pair[1][1]];
            let sides = [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|i| corners[i]));
            let entry = sides.into_iter().filter_map(|side| distance(between, side)).min_by(compare);
            let entry = entry.expect("the direction is between those of corners");
            let is_before = |at: (i128, i128)| compare(&at, &entry) == Ordering::Less;
            !self.segments.iter().any(|ends| {
                let ends = ends.map(|end| minus(self.points[end], origin));
                distance(between, ends)
                    .is_some_and(|at| is_before(at) || self.is_side(ends, &corners, at, entry))
            })
        })
    }

    /// Whether a segment covers the side of the triangle through which the direction enters.
    fn is_side(
        &self,
        ends: [Vector; 2],
        corners: &[Vector; 3],
        at: (i128, i128),
        entry: (i128, i128),
    ) -> bool {
        let beside =
            corners.iter().filter(|&&c| cross(minus(ends[1], ends[0]), minus(c, ends[0])) == 0).count();
        compare(&at, &entry) == Ordering::Equal && beside == 2
    }
}

/// Where the ray in a direction from the origin crosses the inside of an edge: numerator and positive
/// denominator.
fn distance(direction: Vector, [p, q]: [Vector; 2]) -> Option<(i128, i128)> {
    if cross(direction, p).signum() * cross(direction, q).signum() != -1 {
        return None;
    }
    let along = minus(q, p);
    let (top, bottom) = (cross(p, along), cross(direction, along));
    let (top, bottom) = if bottom < 0 { (-top, -bottom) } else { (top, bottom) };
    (top > 0).then_some((top, bottom))
}

fn compare(a: &(i128, i128), b: &(i128, i128)) -> Ordering {
    (a.0 * b.1).cmp(&(b.0 * a.1))
}
