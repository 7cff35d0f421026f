//! How far a place is from where the centre of the probe can be.

use super::probe::probes;
use crate::balls::Balls;
use crate::balls::shares::length;
use crate::balls::tile::Tile;
use crate::balls::tiles::Members;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{difference, dot};

/// Share of the square of a radius by which rounding may hide a point of the sphere behind a ball.
const ROUNDING: f64 = 1e-9;

/// A circle where two spheres meet, with arcs that no third ball covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    pub(super) balls: [u32; 2],
    pub(super) middle: Point3,
    /// Unit vector of the axis.
    normal: Point3,
    pub(super) radius: f64,
}

/// The parts of the boundary of a union: what is nearest to a point inside lies on a sphere, on an arc, or at
/// a corner.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    /// Balls that are exposed.
    pub(super) exposed: Vec<u32>,
    pub(super) circles: Vec<Circle>,
    /// Where the probe touches three balls.
    pub(super) corners: Vec<Point3>,
}

impl Boundary {
    /// The parts that belong to the core of a tile.
    pub(super) fn of_tile(tile: &Tile<'_>, members: &Members) -> Boundary {
        let mut circles = Vec::new();
        let part = tile.measure(None, |ends, pair, face| {
            let [Some(first), Some(second)] = ends.map(|v| tile.ball(v)) else { return };
            let lesser = usize::from(second < first);
            if face.arc <= 0.0 || tile.place_in_core(ends[lesser]).is_none() {
                return;
            }
            let (normal, radius) = pair.circle();
            let from = tile.point(ends[0]);
            let middle = [0, 1, 2].map(|axis| from[axis] + pair.heights[0] * normal[axis]);
            circles.push(Circle { balls: [first, second], middle, normal, radius });
        });
        let cells = members.core.iter().zip(&part.cells);
        Boundary {
            exposed: cells.filter(|(_, cell)| cell.area > 0.0).map(|(&ball, _)| ball).collect(),
            circles,
            corners: probes(tile).into_iter().map(|probe| probe.at).collect(),
        }
    }

    pub(super) fn extend(&mut self, other: Boundary) {
        self.exposed.extend(other.exposed);
        self.circles.extend(other.circles);
        self.corners.extend(other.corners);
    }
}

/// The parts of a boundary near some place, and the balls there.
#[derive(Debug, Default)]
pub(super) struct Nearby {
    /// Balls, and whether they are exposed.
    pub(super) balls: Vec<(u32, bool)>,
    pub(super) circles: Vec<Circle>,
    pub(super) corners: Vec<Point3>,
}

/// A point of the boundary, and its distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    pub(super) distance: f64,
    /// None: there is none in reach, or the place is outside.
    pub(super) at: Option<Point3>,
}

impl Nearby {
    /// The nearest point of the boundary, if it is less than `reach` away; 0 outside of the union.
    pub(super) fn nearest(&self, balls: Balls<'_>, place: Point3, reach: f64) -> Nearest {
        let mut best = Nearest { distance: 0.0, at: None };
        if !self.covers(balls, place, [u32::MAX; 2], 0.0) {
            return best;
        }
        best.distance = reach;
        for &at in &self.corners {
            let distance = length(difference(at, place));
            if distance < best.distance {
                best = Nearest { distance, at: Some(at) };
            }
        }
        for &(ball, _) in self.balls.iter().filter(|(_, is_exposed)| *is_exposed) {
            let (centre, radius) = (balls.centres[ball as usize], balls.radii[ball as usize]);
            let from = difference(place, centre);
            let size = length(from);
            let distance = (radius - size).abs();
            if distance < best.distance && size > 0.0 {
                let at = [0, 1, 2].map(|axis| centre[axis] + from[axis] * (radius / size));
                if !self.covers(balls, at, [ball; 2], ROUNDING) {
                    best = Nearest { distance, at: Some(at) };
                }
            }
        }
        for circle in &self.circles {
            let (distance, at) = circle.nearest(place);
            if distance < best.distance && !self.covers(balls, at, circle.balls, ROUNDING) {
                best = Nearest { distance, at: Some(at) };
            }
        }
        best
    }

    /// The ball in whose cell a place is.
    pub(super) fn owner(&self, balls: Balls<'_>, place: Point3) -> u32 {
        let power = |ball: u32| {
            let from = difference(place, balls.centres[ball as usize]);
            dot(from, from) - balls.radii[ball as usize].powi(2)
        };
        let all = self.balls.iter().map(|&(ball, _)| (power(ball), ball));
        all.min_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1))).map_or(0, |(_, ball)| ball)
    }

    /// Whether a ball but for two contains a place.
    fn covers(&self, balls: Balls<'_>, place: Point3, but: [u32; 2], slack: f64) -> bool {
        self.balls.iter().any(|&(ball, _)| {
            let (centre, radius) = (balls.centres[ball as usize], balls.radii[ball as usize]);
            let from = difference(place, centre);
            dot(from, from) < radius * radius * (1.0 - slack) && !but.contains(&ball)
        })
    }
}

impl Circle {
    /// The nearest point of the circle, and its distance. Of a place on the axis all points are equally near.
    fn nearest(&self, place: Point3) -> (f64, Point3) {
        let from = difference(place, self.middle);
        let along = dot(from, self.normal);
        let mut across = [0, 1, 2].map(|axis| from[axis] - along * self.normal[axis]);
        let mut size = length(across);
        let distance = along.hypot(size - self.radius);
        if size <= ROUNDING * self.radius {
            across = across_of(self.normal);
            size = length(across);
        }
        let at = [0, 1, 2].map(|axis| self.middle[axis] + across[axis] * (self.radius / size));
        (distance, at)
    }
}

/// A vector at right angles to another.
fn across_of([x, y, z]: Point3) -> Point3 {
    if x.abs() < 0.5 { [0.0, z, -y] } else { [y, -x, 0.0] }
}
