//! The vertices on circles, which all that meets there shares.

use super::super::dual::Dual;
use super::super::face::Pair;
use super::super::pockets::root;
use super::super::shares::length;
use super::faces::{Crossing, Step, outline};
use spmesh_delaunay::delaunay3::Ring;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{cross, difference, dot};
use std::f64::consts::TAU;

/// Crossings become one vertex if they are nearer than this part of the greatest radius: between points that
/// are nearer, rounding decides how a circle bends.
const SHORT: f64 = 1e-6;

const NONE: u32 = u32::MAX;

/// Vertices on circles: where three spheres meet, and between.
pub(super) struct Nodes<'d> {
    pub(super) dual: &'d Dual<'d>,
    /// Greatest distance of neighbours on a circle.
    step: f64,
    pub(super) points: Vec<Point3>,
    /// The vertex of each crossing, four places for each tetrahedron.
    crossings: Vec<u32>,
    /// The vertices among these that are crossings.
    meetings: Vec<u32>,
    /// Crossings nearer than this are one vertex.
    short: f64,
    steps: Vec<Step>,
}

impl<'d> Nodes<'d> {
    pub(super) fn new(dual: &'d Dual<'d>, step: f64) -> Self {
        let tile = dual.tile;
        let crossings = vec![NONE; 4 * tile.tetrahedra().len()];
        let short = SHORT * (0..tile.vertices()).map(|v| tile.radius(v)).fold(0.0, f64::max);
        let (points, meetings, steps) = Default::default();
        Nodes { dual, step, points, crossings, meetings, short, steps }
    }

    /// Calls `visit` with each arc of the outline of a face: its vertices in the order of the outline. A
    /// whole circle ends with its first vertex.
    pub(super) fn for_each_arc(&mut self, ring: &Ring, pair: &Pair, mut visit: impl FnMut(&[u32])) {
        if !pair.has_disk() {
            return;
        }
        let mut steps = std::mem::take(&mut self.steps);
        outline(self.dual, ring, &mut steps);
        if steps.is_empty() && self.is_whole(ring, pair) {
            visit(&self.whole_circle(ring, pair));
        }
        let count = steps.len();
        for (at, step) in steps.iter().enumerate() {
            let Step::Leave(from) = *step else { continue };
            // A corner inside comes after an entry only.
            if let Step::Enter(to) = steps[(at + 1) % count] {
                visit(&self.arc(ring, pair, [from, to]));
            }
        }
        self.steps = steps;
    }

    /// For each vertex the one that stands for it, when all arcs are known.
    pub(super) fn merged(&mut self) -> Vec<u32> {
        let mut same: Vec<usize> = (0..self.points.len()).collect();
        let place = |node: u32| self.points[node as usize];
        self.meetings.sort_unstable_by(|&p, &q| place(p)[0].total_cmp(&place(q)[0]).then(p.cmp(&q)));
        for (at, &node) in self.meetings.iter().enumerate() {
            let is_next = |&&other: &&u32| place(other)[0] - place(node)[0] < self.short;
            for &other in self.meetings[at + 1..].iter().take_while(is_next) {
                if length(difference(place(other), place(node))) < self.short {
                    let [p, q] = [node, other].map(|node| root(&mut same, node as usize));
                    same[p.max(q)] = p.min(q);
                }
            }
        }
        (0..same.len()).map(|node| root(&mut same, node) as u32).collect()
    }

    /// Whether the disk lies in the polygon, if their borders do not cross.
    pub(super) fn is_whole(&self, ring: &Ring, pair: &Pair) -> bool {
        let mut is_inner = true;
        let tile = self.dual.tile;
        tile.face(ring, pair, |side| is_inner &= Pair::is_inner(side));
        ring.tetrahedra.iter().all(|&t| self.dual.is_empty(t as usize)) && is_inner
    }

    pub(super) fn whole_circle(&mut self, ring: &Ring, pair: &Pair) -> Vec<u32> {
        let circle = self.circle(ring, pair);
        let count = self.parts(TAU * circle.radius, circle.radius);
        let first = self.points.len() as u32;
        for part in 0..count {
            let at = circle.at(TAU * part as f64 / count as f64);
            self.push(at);
        }
        (first..first + count as u32).chain([first]).collect()
    }

    /// The vertices of an arc; one alone if it is too short.
    pub(super) fn arc(&mut self, ring: &Ring, pair: &Pair, ends: [Crossing; 2]) -> Vec<u32> {
        let [from, to] = ends.map(|crossing| self.node(crossing));
        let circle = self.circle(ring, pair);
        let [start, end] = [from, to].map(|node| circle.angle(self.points[node as usize]));
        let mut sweep = (end - start).rem_euclid(TAU);
        if sweep.min(TAU - sweep) * circle.radius < self.short {
            // Nothing or all of the circle.
            sweep = if self.is_free(ring, circle.at(start + 0.5 * TAU)) { TAU } else { 0.0 };
        }
        if sweep * circle.radius < self.short {
            // Nearer still, so that they become one.
            return vec![from];
        }
        // Two arcs may have the same ends: a vertex between tells them apart.
        let count = self.parts(sweep * circle.radius, circle.radius).max(2);
        let mut nodes = vec![from];
        for part in 1..count {
            nodes.push(self.points.len() as u32);
            self.push(circle.at(start + sweep * part as f64 / count as f64));
        }
        nodes.push(to);
        nodes
    }

    /// The vertex of a crossing.
    pub(super) fn node(&mut self, Crossing { tetrahedron, corner }: Crossing) -> u32 {
        let place = 4 * tetrahedron + corner;
        if self.crossings[place] == NONE {
            self.crossings[place] = self.points.len() as u32;
            self.meetings.push(self.crossings[place]);
            self.push(self.dual.crossing(tetrahedron, corner));
        }
        self.crossings[place]
    }

    /// Whether a point is in no ball that cuts the face.
    fn is_free(&self, ring: &Ring, at: Point3) -> bool {
        ring.link.iter().all(|&v| {
            let from = difference(at, self.dual.tile.point(v));
            dot(from, from) > self.dual.tile.radius(v).powi(2)
        })
    }

    pub(super) fn push(&mut self, at: Point3) {
        self.points.push(at);
    }

    /// Number of parts of an arc.
    fn parts(&self, length: f64, radius: f64) -> usize {
        (length / self.step.min(radius)).ceil() as usize
    }

    fn circle(&self, ring: &Ring, pair: &Pair) -> Circle {
        let (normal, radius) = pair.circle();
        let first = self.dual.tile.point(ring.ends[0]);
        let centre = [0, 1, 2].map(|axis| first[axis] + pair.heights[0] * normal[axis]);
        let across = perpendicular(normal);
        Circle { centre, radius, across, up: cross(normal, across) }
    }
}

/// A circle, with two directions in its plane.
struct Circle {
    centre: Point3,
    radius: f64,
    across: Point3,
    up: Point3,
}

impl Circle {
    fn at(&self, angle: f64) -> Point3 {
        let (y, x) = angle.sin_cos();
        [0, 1, 2].map(|axis| self.centre[axis] + self.radius * (x * self.across[axis] + y * self.up[axis]))
    }

    fn angle(&self, at: Point3) -> f64 {
        let from = difference(at, self.centre);
        dot(from, self.up).atan2(dot(from, self.across))
    }
}

/// A direction at a right angle to another.
fn perpendicular(direction: Point3) -> Point3 {
    let least =
        (1..3).fold(0, |least, i| if direction[i].abs() < direction[least].abs() { i } else { least });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let across = cross(direction, axis);
    across.map(|c| c / length(across))
}
