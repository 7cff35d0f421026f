//! Convex polyhedra, cut by half-spaces one after the other: slow and plain.

use super::vectors::{Point, cross, dot, minus};
use std::collections::BTreeMap;

/// A convex polyhedron around the origin, as its faces.
pub struct Polyhedron {
    /// Each face by the half-space that made it, counterclockwise as seen from outside; `None` for those of
    /// the cube.
    faces: Vec<(Option<usize>, Vec<Point>)>,
}

impl Polyhedron {
    /// The cube from -half to half.
    pub fn cube(half: f64) -> Polyhedron {
        let mut faces = Vec::new();
        for axis in 0..3 {
            for sign in [-half, half] {
                let corner = |u: f64, v: f64| {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, u * half, v * half);
                    p
                };
                let mut face =
                    vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                if sign < 0.0 {
                    face.reverse();
                }
                faces.push((None, face));
            }
        }
        Polyhedron { faces }
    }

    /// Keeps the points x with `normal` x <= `offset`.
    pub fn cut(&mut self, normal: Point, offset: f64, name: usize) {
        let length = dot(normal, normal).sqrt();
        let beyond = |p: Point| (dot(normal, p) - offset) / length;
        if self.faces.iter().flat_map(|(_, face)| face).all(|&p| beyond(p) <= 0.0) {
            return;
        }
        let mut cap: Vec<Point> = Vec::new();
        for (_, face) in &mut self.faces {
            let mut kept = Vec::new();
            for (k, &p) in face.iter().enumerate() {
                let q = face[(k + 1) % face.len()];
                let (of_p, of_q) = (beyond(p), beyond(q));
                if of_p <= 0.0 {
                    kept.push(p);
                }
                if (of_p <= 0.0) != (of_q <= 0.0) {
                    // From the lesser end, so that both faces at an edge get the same point.
                    let (p, q, of_p, of_q) = if p < q { (p, q, of_p, of_q) } else { (q, p, of_q, of_p) };
                    let part = of_p / (of_p - of_q);
                    let crossing = [0, 1, 2].map(|axis| p[axis] + part * (q[axis] - p[axis]));
                    kept.push(crossing);
                    cap.push(crossing);
                }
            }
            *face = kept;
        }
        self.faces.retain(|(_, face)| face.len() > 2);
        if cap.len() > 2 {
            self.faces.push((Some(name), around(normal, cap)));
        }
    }

    pub fn volume(&self) -> f64 {
        self.faces.iter().map(|(_, face)| dot(face[0], twice_area(face)) / 6.0).sum()
    }

    /// The areas of the faces of half-spaces, by these.
    pub fn areas(&self) -> BTreeMap<usize, f64> {
        let area = |face: &[Point]| 0.5 * dot(twice_area(face), twice_area(face)).sqrt();
        self.faces.iter().filter_map(|(name, face)| Some(((*name)?, area(face)))).collect()
    }
}

/// Twice the area of a polygon, as a vector along its normal.
fn twice_area(face: &[Point]) -> Point {
    let mut sum = [0.0; 3];
    for pair in face[1..].windows(2) {
        let part = cross(minus(pair[0], face[0]), minus(pair[1], face[0]));
        (0..3).for_each(|axis| sum[axis] += part[axis]);
    }
    sum
}

/// Points of a plane in order around their middle, counterclockwise as seen from the side of the normal.
fn around(normal: Point, mut points: Vec<Point>) -> Vec<Point> {
    let count = points.len() as f64;
    let middle: Point = std::array::from_fn(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / count);
    let away =
        if normal[0].abs() < 0.6 * dot(normal, normal).sqrt() { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let u = cross(normal, away);
    let v = cross(normal, u);
    let length = |p: Point| dot(p, p).sqrt();
    let angle = |p: &Point| {
        let from = minus(*p, middle);
        (dot(from, v) / length(v)).atan2(dot(from, u) / length(u))
    };
    points.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    points
}
