//! The face between two cells: a convex polygon of the power diagram, cut by the disk that both balls share
//! with its plane.
//!
//! The foot of the centres in the plane is the middle of the disk. Seen from it, the face is divided at the
//! corners of the polygon, and where its border crosses the circle: into triangles at the foot, where the
//! border runs in the disk, and sectors, where it runs outside. Areas and solid angles of both have closed
//! forms; parts outside of the polygon have the opposite sign and cancel.

use super::shares::heights;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{cross, difference, dot};

/// Two balls whose spheres meet, and the plane of equal power.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    /// From the centre of the first to that of the second, of length 1.
    normal: Point3,
    /// Signed distances of the plane from the centres, positive if it lies towards the other centre.
    pub(crate) heights: [f64; 2],
    /// Square of the radius of the disk; not positive if there is none.
    square: f64,
    radius: f64,
    radii: [f64; 2],
}

/// A face, measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Face {
    pub(super) area: f64,
    /// As the centres see it; negative where they see it from behind.
    pub(super) angles: [f64; 2],
    /// Angle of the circle's arcs in the polygon: of the circle where the spheres meet, what no third ball
    /// covers. Zero without angles.
    pub(super) arc: f64,
}

impl Pair {
    /// Domain: different centres.
    #[inline(always)]
    pub(crate) fn new([p, q]: [Point3; 2], radii: [f64; 2]) -> Pair {
        let between = difference(q, p);
        let distance = dot(between, between).sqrt();
        let heights = heights(distance, radii);
        let square = (radii[0] - heights[0]) * (radii[0] + heights[0]);
        let normal = between.map(|c| c / distance);
        Pair { normal, heights, square, radius: square.max(0.0).sqrt(), radii }
    }

    /// The balls share a disk with the plane.
    #[inline(always)]
    pub(super) fn has_disk(&self) -> bool {
        self.square > 0.0
    }

    /// Square of the radius of the disk.
    #[inline(always)]
    pub(super) fn disk(&self) -> f64 {
        self.square
    }

    /// The normal of the plane, from the first centre to the second, and the radius of the disk.
    pub(super) fn circle(&self) -> (Point3, f64) {
        (self.normal, self.radius)
    }

    /// Whether the middle of the disk is on the inner side of a side of the polygon.
    pub(super) fn is_inner(side: Side) -> bool {
        side.offset > 0.0
    }

    /// Whether a side of the polygon has a point in the disk: also where the polygon is nothing but that
    /// side.
    #[inline(always)]
    pub(super) fn touches(&self, side: Side) -> bool {
        let square = (self.radius - side.offset) * (self.radius + side.offset);
        let half_chord = square.max(0.0).sqrt();
        square >= 0.0 && side.from <= half_chord && side.to >= -half_chord
    }

    /// Adds the part of the face under one side of the polygon.
    #[inline(always)]
    pub(super) fn add(&self, side: Side, with_angles: bool, face: &mut Face) {
        let Side { offset, from, to, .. } = side;
        if !with_angles {
            // The whole polygon is in the disk.
            face.area += 0.5 * offset * (to - from);
            return;
        }
        let half_chord = ((self.radius - offset) * (self.radius + offset)).max(0.0).sqrt();
        if to <= -half_chord || from >= half_chord {
            self.add_sector(offset, [from, to], face);
            return;
        }
        let [enter, leave] = [from, to].map(|at| at.max(-half_chord).min(half_chord));
        if from < enter {
            self.add_sector(offset, [from, enter], face);
        }
        if to > leave {
            self.add_sector(offset, [leave, to], face);
        }
        self.add_triangle(offset, [enter, leave], face);
    }

    /// A sector of the disk, between the directions of two points of a line.
    #[inline(always)]
    fn add_sector(&self, offset: f64, [from, to]: [f64; 2], face: &mut Face) {
        let angle = (offset * (to - from)).atan2(offset * offset + from * to);
        face.area += 0.5 * self.square * angle;
        face.arc += angle;
        for (end, &height) in self.heights.iter().enumerate() {
            face.angles[end] += signed(height) * angle * (1.0 - height.abs() / self.radii[end]);
        }
    }

    /// A triangle of the foot and two points of a line in the disk. Solid angle: Van Oosterom and Strackee,
    /// 1983.
    #[inline(always)]
    fn add_triangle(&self, offset: f64, [from, to]: [f64; 2], face: &mut Face) {
        let twice = offset * (to - from);
        face.area += 0.5 * twice;
        let product = offset * offset + from * to;
        let squares = [from, to].map(|at| offset * offset + at * at);
        for (end, &height) in self.heights.iter().enumerate() {
            let (h, square) = (height.abs(), height * height);
            let [k, l] = squares.map(|s| (s + square).sqrt());
            let denominator = k * l + h * (k + l) + product + square;
            face.angles[end] += signed(height) * 2.0 * twice.atan2(denominator);
        }
    }
}

/// -1 for negative numbers, else 1.
#[inline(always)]
fn signed(height: f64) -> f64 {
    if height < 0.0 { -1.0 } else { 1.0 }
}

/// A side of the polygon, on the line where the power distances of the two balls and of a third one are
/// equal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    /// Signed distance of the line from the foot: positive if the third ball is beyond it.
    pub(crate) offset: f64,
    /// Ends, measured along the line, counterclockwise as the second centre sees the face.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Directions of length 1: from the foot away to the line, and along it.
    pub(crate) frame: [Point3; 2],
}

impl Pair {
    /// The side towards a third ball, whose centre and difference of weight are relative to the first; from
    /// and to are vertices of the power diagram, relative to the first centre, too. `None` if the three
    /// centres are on a line.
    #[inline(always)]
    pub(crate) fn side(&self, third: Point3, heavier: f64, ends: [Point3; 2]) -> Option<Side> {
        let along = dot(third, self.normal);
        let lateral = [0, 1, 2].map(|axis| third[axis] - along * self.normal[axis]);
        let square = dot(lateral, lateral);
        if square <= 0.0 {
            return None;
        }
        let length = square.sqrt();
        let offset = (0.5 * (dot(third, third) - heavier) - self.heights[0] * along) / length;
        let direction = cross(self.normal, lateral).map(|c| c / length);
        // Far corners are as good as infinite; products of larger numbers would overflow.
        let far = 1e15 * (self.radius + offset.abs());
        let [from, to] = ends.map(|end| dot(end, direction).max(-far).min(far));
        Some(Side { offset, from, to, frame: [lateral.map(|c| c / length), direction] })
    }
}
