//! Where a new point is: a remembering stochastic walk (Devillers, Pion & Teillaud 2002; thesis 3.4.2).

use super::check::check;
use super::insertion::State;
use super::mesh::{corner_of, tetrahedron_of};
use spmesh_delaunay::predicates::Point3;

/// Walks to one point, each from a start of its own.
const WALKS_MAX: usize = 4;

/// Tetrahedra looked at to find a finite one at random.
const TRIES_MAX: usize = 100;

/// No corner of a tetrahedron.
const NOWHERE: usize = 4;

/// What a walk knows of a point and the sphere of a tetrahedron.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tested {
    /// Value of the sphere at the point.
    pub(super) value: f64,
    /// Six times the volume of the tetrahedron, zero if it is infinite.
    pub(super) volume: f64,
}

impl Tested {
    /// Whether the point is inside or on the sphere. One on the plane of a facet of the hull is not taken to
    /// be: the tetrahedron on the other side tells.
    #[inline(always)]
    fn is_conflict(&self) -> bool {
        self.value > 0.0 || self.value == 0.0 && self.volume > 0.0
    }
}

/// What a walk does next.
enum Step {
    /// Into this tetrahedron, to which the one before is at this corner.
    Into(u32, usize, Tested),
    /// Nowhere: the sphere of this one has the point inside.
    Conflict(u32),
    /// Nowhere: the point is beyond no facet.
    None,
}

impl State<'_> {
    /// A tetrahedron whose sphere has `p` inside or on it, or else one that `p` is in; none if rounding led
    /// all walks astray.
    pub(super) fn locate(&mut self, p: Point3) -> Option<u32> {
        let mut start = self.start;
        for attempt in 0..WALKS_MAX {
            let from_spheres = self.options.orientation_from_spheres && attempt == 0;
            if let Some(t) = self.walk(start, p, from_spheres) {
                return Some(t);
            }
            self.stats.restarts += 1;
            let count = self.mesh.tetrahedra.len() as u64;
            let mut tries = (0..TRIES_MAX).map(|_| (self.random.bits() % count) as u32);
            start = tries.find(|&t| self.mesh.is_finite(t))?;
        }
        None
    }

    /// Walks to `p` from the finite tetrahedron `t`.
    fn walk(&mut self, mut t: u32, p: Point3, from_spheres: bool) -> Option<u32> {
        let mut here = self.test(t, p);
        if here.is_conflict() {
            return Some(t);
        }
        let mut from = NOWHERE;
        for _ in 0..self.patience.limit(self.mesh.tetrahedra.len()) {
            self.patience.spend(1);
            let mut step = self.step((t, here, from), p, from_spheres);
            if matches!(step, Step::None) && from_spheres {
                // The sides of planes between coincident spheres were guessed, the last one too, perhaps.
                step = self.step((t, here, NOWHERE), p, false);
            }
            match step {
                Step::Into(next, side, tested) => (t, from, here) = (next, side, tested),
                Step::Conflict(next) => return Some(next),
                Step::None => {
                    self.stats.forced += 1;
                    return Some(t);
                }
            }
            self.stats.walk_steps += 1;
        }
        None
    }

    /// Walks from `t` to the tetrahedron that `p` is in, by determinants alone: an infinite one, if it is
    /// outside.
    pub(super) fn containing(&mut self, mut t: u32, p: Point3) -> Option<u32> {
        if !self.mesh.is_finite(t) {
            t = self.mesh.beside_faraway(t);
        }
        let mut from = NOWHERE;
        for _ in 0..self.patience.limit(self.mesh.tetrahedra.len()) {
            self.patience.spend(1);
            let Some(side) = self.sides(from).find(|&side| self.mesh.is_beyond(t, side, p)) else {
                return Some(t);
            };
            let neighbour = self.mesh.neighbour(t, side);
            (t, from) = (tetrahedron_of(neighbour), corner_of(neighbour));
            if !self.mesh.is_finite(t) {
                return Some(t);
            }
        }
        None
    }

    /// The sides of a tetrahedron but one, beginning anywhere.
    #[inline(always)]
    fn sides(&mut self, but: usize) -> impl Iterator<Item = usize> + use<> {
        let first = (self.random.bits() & 3) as usize;
        (first..first + 4).map(|side| side & 3).filter(move |&side| side != but)
    }

    /// Chooses a facet, at random, that `p` is beyond; not the one that the walk came from.
    #[inline(always)]
    fn step(&mut self, (t, here, from): (u32, Tested, usize), p: Point3, from_spheres: bool) -> Step {
        for side in self.sides(from) {
            if !from_spheres && !self.is_beyond(t, side, p) {
                continue;
            }
            let neighbour = self.mesh.neighbour(t, side);
            let there = self.test(tetrahedron_of(neighbour), p);
            if there.is_conflict() {
                return Step::Conflict(tetrahedron_of(neighbour));
            }
            let is_infinite = there.volume == 0.0;
            if !is_infinite && (!from_spheres || self.is_nearer(here, there)) {
                return Step::Into(tetrahedron_of(neighbour), corner_of(neighbour), there);
            }
        }
        Step::None
    }

    /// Whether a point is beyond a facet, by a determinant.
    #[inline(always)]
    fn is_beyond(&mut self, t: u32, side: usize, p: Point3) -> bool {
        self.stats.orientation_tests += 1;
        self.mesh.is_beyond(t, side, p)
    }

    /// Whether a point is on the side of `there` of the plane of a facet, by the values of the spheres on
    /// both sides.
    ///
    /// The weights cancel the coefficients of the lift, which are the volumes: what is left is the equation
    /// of the plane. It is zero if the spheres coincide, or if the point is in the plane.
    #[inline(always)]
    fn is_nearer(&mut self, here: Tested, there: Tested) -> bool {
        self.stats.orientation_tests += 1;
        let value = here.volume * there.value - there.volume * here.value;
        if value == 0.0 {
            self.stats.random_sides += 1;
            return self.random.bits() & 1 == 1;
        }
        value > 0.0
    }

    /// Tests a point against the sphere of a tetrahedron.
    #[inline(always)]
    pub(super) fn test(&mut self, t: u32, p: Point3) -> Tested {
        self.stats.in_sphere_tests += 1;
        let (sphere, origin) = self.mesh.sphere(t);
        let value = sphere.value(origin, p);
        if self.options.check_signs {
            let corners = &self.mesh.tetrahedra[t as usize].vertices;
            check(self.mesh.vertices, corners, p, value, &mut self.stats);
        }
        Tested { value, volume: sphere.volume }
    }
}
