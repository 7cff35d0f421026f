//! Probes at rest: corners of the surface that the centre of the probe can reach, and which of them are near
//! to a place.

use crate::balls::dual::Dual;
use crate::balls::shares::{Foot, length};
use crate::balls::tile::Tile;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{difference, dot};

/// A probe that touches three balls, and overlaps none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    /// The balls, clockwise as the probe sees them: right-handed about the way down.
    pub(super) balls: [u32; 3],
    /// Its centre.
    pub(super) at: Point3,
    /// The foot of its centre in the plane of the balls' centres.
    pub(super) foot: Point3,
    /// Unit vector towards this plane.
    pub(super) down: Point3,
    /// Distance from it.
    pub(super) height: f64,
}

impl Probe {
    /// Whether both touch the same balls, from the two sides of the plane of their centres.
    pub(super) fn is_mirror_of(&self, other: &Probe) -> bool {
        self.balls.iter().all(|ball| other.balls.contains(ball))
    }
}

/// All probes at rest whose least ball is in the core of a tile. The radii of the tile include that of the
/// probe.
///
/// The diagram's edge across a facet leads from the orthocentre of one tetrahedron to that of the other. The
/// probe rests where the power along this edge is zero. Which edges have such points follows from the powers
/// at their ends alone, so that edges which meet agree about their end.
pub(super) fn probes(tile: &Tile<'_>) -> Vec<Probe> {
    let mut probes = Vec::new();
    let dual = Dual::new(tile);
    for (t, tetrahedron) in tile.tetrahedra().iter().enumerate() {
        for (corner, facet) in TETRAHEDRON_FACETS.into_iter().enumerate() {
            let Some((other, _)) = dual.across(t, corner) else { continue };
            let ends = [t, other].map(|t| dual.is_empty(t));
            if other > t && ends != [false, false] {
                let facet = facet.map(|i| tetrahedron.vertices[i]);
                add(tile, facet, [t, other], ends, &mut probes);
            }
        }
    }
    probes
}

/// Adds the probes at a facet, which is counterclockwise as seen from the second tetrahedron.
fn add(tile: &Tile<'_>, facet: [u32; 3], tetrahedra: [usize; 2], ends: [bool; 2], probes: &mut Vec<Probe>) {
    let [Some(a), Some(b), Some(c)] = facet.map(|v| tile.ball(v)) else { return };
    let least = (0..3).min_by_key(|&i| [a, b, c][i]).expect("three balls");
    if tile.place_in_core(facet[least]).is_none() {
        return;
    }
    let centres = facet.map(|v| tile.point(v));
    let Some(foot) = Foot::of(centres, facet.map(|v| tile.radius(v))) else { return };
    let at = |direction: Point3, t: f64| [0, 1, 2].map(|axis| direction[axis] + t * foot.normal[axis]);
    let base = at([0, 1, 2].map(|axis| centres[0][axis] + foot.at[axis]), 0.0);
    if ends == [true, true] {
        let [before, behind] = tetrahedra.map(|t| dot(difference(tile.centre(t), base), foot.normal));
        if foot.power >= 0.0 || before >= 0.0 || behind <= 0.0 {
            return;
        }
    }
    let height = (-foot.power).max(0.0).sqrt();
    let size = length(foot.normal);
    let up = foot.normal.map(|c| c / size);
    if ends[0] {
        let at = [0, 1, 2].map(|axis| base[axis] - height * up[axis]);
        probes.push(Probe { balls: [a, b, c], at, foot: base, down: up, height });
    }
    if ends[1] {
        let at = [0, 1, 2].map(|axis| base[axis] + height * up[axis]);
        probes.push(Probe { balls: [a, c, b], at, foot: base, down: up.map(|c| -c), height });
    }
}

/// Probes in cubes, sorted by these.
pub(super) struct Neighbours<'p> {
    probes: &'p [Probe],
    side: f64,
    /// The cube of each probe and its number, in order.
    cubes: Vec<(Point3, u32)>,
}

impl<'p> Neighbours<'p> {
    /// `side` is positive.
    pub(super) fn new(probes: &'p [Probe], side: f64) -> Self {
        let mut cubes: Vec<(Point3, u32)> =
            (0..).zip(probes).map(|(number, probe)| (cube(probe.at, side), number)).collect();
        cubes.sort_unstable_by(|(p, i), (q, j)| order(p, q).then(i.cmp(j)));
        Neighbours { probes, side, cubes }
    }

    /// Calls `visit` with each probe whose centre is less than one side from `at`, in a fixed order.
    pub(super) fn for_each(&self, at: Point3, mut visit: impl FnMut(&'p Probe)) {
        let [x, y, z] = cube(at, self.side);
        for x in [x - 1.0, x, x + 1.0] {
            for y in [y - 1.0, y, y + 1.0] {
                let first = self.cubes.partition_point(|(cube, _)| order(cube, &[x, y, z - 1.0]).is_lt());
                let column = self.cubes[first..].iter();
                for (_, number) in column.take_while(|(cube, _)| order(cube, &[x, y, z + 1.0]).is_le()) {
                    let probe = &self.probes[*number as usize];
                    let between = difference(probe.at, at);
                    if dot(between, between) < self.side * self.side {
                        visit(probe);
                    }
                }
            }
        }
    }
}

fn order(p: &Point3, q: &Point3) -> std::cmp::Ordering {
    p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])).then(p[2].total_cmp(&q[2]))
}

/// The cube of a point. Adding zero makes negative zeros positive, as the order tells them apart.
fn cube(at: Point3, side: f64) -> Point3 {
    at.map(|c| (c / side).floor() + 0.0)
}
