//! The concave patch under a probe at rest.
//!
//! The layer next to the probe's centre is the part of the probe in the cone towards the centres of the three
//! balls that is nearer to this centre than to that of any other probe at rest. Other probes are nearer only
//! beyond the plane of the three centres. So the layer is convex: planes through the apex bound it, the
//! sphere of the probe, and flat faces half-way to other probes. As for cells of balls, area and volume
//! follow from the areas and solid angles of these faces.

use super::cone::Cone;
use super::probe::{Neighbours, Probe};
use crate::balls::face::{Face, Pair, Side};
use crate::balls::shares::Measure;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{cross, difference, dot};

/// Distance of probes, in radii, below which they are one; and height of a probe over the plane of three
/// centres below which its mirror image leaves nothing of its layer.
const COINCIDENT: f64 = 1e-7;

/// Length of the part of a normal in another plane below which both planes are parallel.
const PARALLEL: f64 = 1e-12;

/// The plane half-way to another probe, as seen from the first.
struct Bisector {
    /// Unit vector to the other probe.
    normal: Point3,
    /// Distance of the plane.
    height: f64,
}

/// The layers next to a probe, and the patches that bound them: one for each of its balls. A point counts for
/// the ball from which it has the least power distance. `centres` are those of the balls.
pub(super) fn layers(
    probe: &Probe,
    centres: [Point3; 3],
    radius: f64,
    neighbours: &Neighbours<'_>,
) -> [Measure; 3] {
    let rays = centres.map(|centre| {
        let to_foot = difference(centre, probe.foot);
        let ray = [0, 1, 2].map(|axis| to_foot[axis] + probe.height * probe.down[axis]);
        let size = dot(ray, ray).sqrt();
        ray.map(|c| c / size)
    });
    let cone = Cone::of(rays);
    // The parts nearer to a ball than to the two others.
    let nearer = [0, 1, 2].map(|i| {
        let towards = |j: usize| difference(centres[i], centres[j % 3]);
        [towards(i + 1), towards(i + 2)]
    });
    let angles = nearer.map(|[first, second]| cone.cut(first).cut(second).solid_angle());
    let Some(bisectors) = bisectors(probe, &cone, radius, neighbours) else { return Default::default() };
    // Solid angle and volume of the cones over the faces.
    let (mut cut_off, mut under) = ([0.0; 3], [0.0; 3]);
    let borders = [0, 1, 2].map(|i| cross(rays[i], rays[(i + 1) % 3]));
    let (mut part, mut spare) = Default::default();
    for (place, bisector) in bisectors.iter().enumerate() {
        let plane = Plane::new(bisector, radius);
        let mut whole = plane.square();
        plane.cut(&mut whole, borders, 0.0, &mut spare);
        for (_, other) in bisectors.iter().enumerate().filter(|(other, _)| *other != place) {
            if whole.is_empty() {
                break;
            }
            plane.cut(&mut whole, [other.normal.map(|c| -c)], -other.height, &mut spare);
        }
        for i in (0..3).filter(|_| !whole.is_empty()) {
            Polygon::copy(&mut part, &whole);
            plane.cut(&mut part, nearer[i], 0.0, &mut spare);
            let mut face = Face::default();
            part.sides().for_each(|side| plane.pair.add(side, true, &mut face));
            cut_off[i] += face.angles[0];
            under[i] += bisector.height * face.area / 3.0;
        }
    }
    [0, 1, 2].map(|i| {
        let area = (angles[i] - cut_off[i]).max(0.0) * radius * radius;
        Measure { area, volume: area * radius / 3.0 + under[i] }
    })
}

/// The planes half-way to all probes that may be nearer to a point of the probe's layer. `None` if the layer
/// is empty.
fn bisectors(probe: &Probe, cone: &Cone, radius: f64, neighbours: &Neighbours<'_>) -> Option<Vec<Bisector>> {
    let mut bisectors: Vec<Bisector> = Vec::new();
    if probe.height >= radius {
        // Nothing of it is beyond the plane of the three centres.
        return Some(bisectors);
    }
    let mut others: Vec<&Probe> = Vec::new();
    neighbours.for_each(probe.at, |other| others.push(other));
    // The mirror image first: its direction is known best.
    others.sort_by_key(|other| !probe.is_mirror_of(other));
    let near = |p: Point3, q: Point3| {
        let between = difference(p, q);
        dot(between, between) < (COINCIDENT * radius).powi(2)
    };
    let mut places: Vec<Point3> = Vec::new();
    for other in others.into_iter().filter(|other| !std::ptr::eq(*other, probe)) {
        if places.iter().any(|&place| near(place, other.at)) {
            continue;
        }
        if probe.is_mirror_of(other) {
            if probe.height < COINCIDENT * radius {
                return None;
            }
            bisectors.push(Bisector { normal: probe.down, height: probe.height });
        } else if near(other.at, probe.at) {
            continue;
        } else {
            let between = difference(other.at, probe.at);
            let distance = dot(between, between).sqrt();
            bisectors.push(Bisector { normal: between.map(|c| c / distance), height: distance / 2.0 });
        }
        places.push(other.at);
    }
    // A plane that misses the probe in the cone leaves the layer as it is; rounding must not lose one.
    bisectors.retain(|bisector| bisector.height < radius * (cone.nearness(bisector.normal) + 1e-9));
    // The nearest cut off most.
    bisectors.sort_by(|p, q| p.height.total_cmp(&q.height));
    Some(bisectors)
}

/// The plane of a bisector, with axes around its point next to the probe.
struct Plane {
    pair: Pair,
    normal: Point3,
    height: f64,
    axes: [Point3; 2],
    radius: f64,
}

impl Plane {
    fn new(bisector: &Bisector, radius: f64) -> Plane {
        let Bisector { normal, height } = *bisector;
        let other = normal.map(|c| 2.0 * height * c);
        let aside = if normal[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let first = cross(normal, aside);
        let size = dot(first, first).sqrt();
        let first = first.map(|c| c / size);
        Plane {
            pair: Pair::new([[0.0; 3], other], [radius; 2]),
            normal,
            height,
            axes: [first, cross(normal, first)],
            radius,
        }
    }

    /// A square around the disk of the probe.
    fn square(&self) -> Polygon {
        Polygon::square(2.0 * self.radius)
    }

    /// Cuts off a polygon what has a product with a normal below `least`.
    fn cut(
        &self,
        polygon: &mut Polygon,
        normals: impl IntoIterator<Item = Point3>,
        least: f64,
        spare: &mut Polygon,
    ) {
        for normal in normals {
            let inward = self.axes.map(|axis| dot(axis, normal));
            let depth = self.height * dot(self.normal, normal) - least;
            let size = inward[0].hypot(inward[1]);
            if size > PARALLEL * dot(normal, normal).sqrt() {
                let outward = inward.map(|c| -c / size);
                polygon.cut(HalfPlane { outward, offset: depth / size }, spare);
            } else if depth < 0.0 {
                *polygon = Polygon::default();
            }
        }
    }
}

/// A half-plane: the product with its outward normal, of length 1, is at most `offset`.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfPlane {
    pub(super) outward: [f64; 2],
    pub(super) offset: f64,
}

/// A convex polygon.
#[derive(Debug, Clone, Default)]
pub(super) struct Polygon {
    /// Counterclockwise.
    corners: Vec<[f64; 2]>,
}

impl Polygon {
    /// The square between -`half` and `half` on both axes.
    pub(super) fn square(half: f64) -> Polygon {
        Polygon { corners: vec![[-half, -half], [half, -half], [half, half], [-half, half]] }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Cuts off what is outside of a half-plane. `spare` is a buffer.
    pub(super) fn cut(&mut self, half: HalfPlane, spare: &mut Polygon) {
        let depth = |[x, y]: [f64; 2]| half.offset - (half.outward[0] * x + half.outward[1] * y);
        if self.corners.iter().all(|&corner| depth(corner) >= 0.0) {
            return;
        }
        spare.corners.clear();
        for (i, &corner) in self.corners.iter().enumerate() {
            let next = self.corners[(i + 1) % self.corners.len()];
            let [own, other] = [corner, next].map(depth);
            if own >= 0.0 {
                spare.corners.push(corner);
            }
            if (own >= 0.0) != (other >= 0.0) {
                let share = own / (own - other);
                spare.corners.push([0, 1].map(|axis| corner[axis] + share * (next[axis] - corner[axis])));
            }
        }
        std::mem::swap(&mut self.corners, &mut spare.corners);
    }

    /// Becomes a copy of another.
    pub(super) fn copy(&mut self, other: &Polygon) {
        self.corners.clone_from(&other.corners);
    }

    /// The sides, on lines through the corners. They are not those of the half-planes: only so the sides of
    /// polygons without area, where several half-planes begin at one line, cancel.
    pub(super) fn sides(&self) -> impl Iterator<Item = Side> {
        self.corners.iter().enumerate().filter_map(|(i, &[x, y])| {
            let [u, v] = self.corners[(i + 1) % self.corners.len()];
            let size = (u - x).hypot(v - y);
            let [p, q] = [(u - x) / size, (v - y) / size];
            // Directions in space are not wanted here.
            let frame = [[0.0; 3]; 2];
            let side = Side { offset: x * q - y * p, from: x * p + y * q, to: u * p + v * q, frame };
            (size > 0.0).then_some(side)
        })
    }
}
