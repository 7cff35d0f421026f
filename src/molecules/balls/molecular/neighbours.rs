//! Which probes are near to a place.

use super::probe::Probe;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{difference, dot};

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
