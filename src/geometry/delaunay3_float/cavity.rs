//! The cavity of a new point: tetrahedra whose spheres have it inside, changed until it sees all facets around.

use super::insertion::Insertion;
use super::mesh::{FACETS, Facet, faraway_corner, sphere_of, tetrahedron_of};
use super::phase_timer::Part;
use super::sphere::Sphere;
use crate::predicates::Point3;

/// Searches for one cavity, each with more decided.
const SEARCHES_MAX: usize = 20;

/// Searches that are told apart.
const SEARCH_MAX: u32 = u32::MAX / 2;

/// Decisions against the values of spheres that are made for one cavity.
const DECIDED_MAX: usize = 1000;

/// A facet around a cavity, as the new tetrahedron on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wall {
    /// The tetrahedron in the cavity.
    inside: u32,
    /// The facet, from outside of the cavity.
    pub(super) outside: Facet,
    /// The new point, and the corners of the facet.
    pub(super) vertices: [u32; 4],
    pub(super) sphere: Sphere,
}

impl Wall {
    /// Whether the new point sees the inner side of the facet.
    #[inline(always)]
    fn is_seen(&self) -> bool {
        self.sphere.volume > 0.0 || faraway_corner(&self.vertices).is_some()
    }
}

/// The cavity of one point at a time.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    /// Tetrahedra to be replaced.
    pub(super) cells: Vec<u32>,
    pub(super) walls: Vec<Wall>,
    /// Tetrahedra that are in the cavity, or not, whatever the values of their spheres; the last entry of one counts.
    decided: Vec<(u32, bool)>,
    /// No others are in the cavity.
    is_narrow: bool,
    /// For each tetrahedron, the last search that met it, times two, plus one if it is in the cavity.
    met: Vec<u32>,
    search: u32,
}

impl Cavity {
    /// Begins a search: nothing but `seed` is in the cavity.
    fn begin(&mut self, seed: u32, tetrahedra: usize) {
        if self.search == SEARCH_MAX {
            self.met.fill(0);
            self.search = 0;
        }
        self.search += 1;
        self.met.resize(tetrahedra, 0);
        self.cells.clear();
        self.walls.clear();
        self.add(seed, true);
    }

    /// Whether a tetrahedron is in the cavity, if the search has met it.
    #[inline(always)]
    fn known(&self, t: u32) -> Option<bool> {
        let met = self.met[t as usize];
        (met / 2 == self.search).then_some(met & 1 == 1)
    }

    /// Takes down what a tetrahedron is.
    #[inline(always)]
    fn add(&mut self, t: u32, is_inside: bool) {
        self.met[t as usize] = self.search * 2 + u32::from(is_inside);
        if is_inside {
            self.cells.push(t);
        }
    }

    fn decision(&self, t: u32) -> Option<bool> {
        self.decided.iter().rev().find(|decided| decided.0 == t).map(|decided| decided.1)
    }

    /// Decides what to change where the point does not see a facet: the tetrahedron behind it is left out, but if that
    /// is the seed, or the cavity is narrow, the one in front of it is taken in. False if nothing is left to be changed.
    fn decide(&mut self, seed: u32) -> bool {
        let before = self.decided.len();
        for i in 0..self.walls.len() {
            let wall = self.walls[i];
            if wall.is_seen() {
                continue;
            }
            let in_front = tetrahedron_of(wall.outside);
            let is_kept = self.is_narrow || wall.inside == seed;
            if is_kept && self.decision(in_front) == Some(false) || self.decided.len() == DECIDED_MAX {
                return false;
            }
            self.decided.push(if is_kept { (in_front, true) } else { (wall.inside, false) });
        }
        self.decided.len() > before
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * (self.met.capacity() + self.cells.capacity())
            + size_of::<Wall>() * self.walls.capacity()
    }
}

impl Insertion<'_> {
    /// Finds the tetrahedra around `seed` that are in conflict with vertex `v`, and the new ones that are to replace
    /// them; false if it does not see all facets around, or these are not a sphere.
    #[inline(always)]
    pub(super) fn find_star(&mut self, v: u32, seed: u32) -> bool {
        self.search(v, seed);
        let mut is_seen = true;
        for wall in &mut self.cavity.walls {
            wall.sphere = sphere_of(self.mesh.vertices, &wall.vertices);
            is_seen &= wall.is_seen();
        }
        self.laps.end(Part::Predicates);
        is_seen && self.star.pair(&self.cavity.walls)
    }

    /// Finds a cavity that is not as the values of spheres have it: one around the tetrahedron that the point is in,
    /// without those that hide facets, or just that tetrahedron; with its neighbour, if the point is on a facet.
    #[cold]
    #[inline(never)]
    pub(super) fn repair_star(&mut self, v: u32, seed: u32) -> bool {
        self.stats.repairs += 1;
        let Some(seed) = self.containing(seed, self.mesh.vertices[v as usize].at) else { return false };
        let is_found = self.find_star_by_decisions(v, seed) || {
            self.cavity.is_narrow = true;
            self.find_star_by_decisions(v, seed)
        };
        self.cavity.is_narrow = false;
        is_found
    }

    fn find_star_by_decisions(&mut self, v: u32, seed: u32) -> bool {
        let mut searches = 0;
        let is_found = loop {
            searches += 1;
            let is_found = self.find_star(v, seed);
            if is_found || searches == SEARCHES_MAX || !self.cavity.decide(seed) {
                break is_found;
            }
        };
        self.cavity.decided.clear();
        is_found
    }

    /// Collects the tetrahedra in conflict, breadth first, and the facets around them.
    #[inline(always)]
    fn search(&mut self, v: u32, seed: u32) {
        let p = self.mesh.vertices[v as usize].at;
        let limit = self.patience.limit(self.mesh.cells.len());
        self.cavity.begin(seed, self.mesh.cells.len());
        let mut next = 0;
        while let Some(&t) = self.cavity.cells.get(next) {
            next += 1;
            let cell = self.mesh.cells[t as usize];
            for (outside, corners) in cell.across.into_iter().zip(FACETS) {
                let other = tetrahedron_of(outside);
                let is_inside = self.cavity.known(other).unwrap_or_else(|| {
                    let is_inside = self.cavity.cells.len() < limit && self.is_in_conflict(other, p);
                    self.cavity.add(other, is_inside);
                    is_inside
                });
                if !is_inside {
                    let [a, b, c] = corners.map(|corner| cell.vertices[corner]);
                    self.cavity.walls.push(Wall {
                        inside: t,
                        outside,
                        vertices: [v, a, b, c],
                        sphere: Sphere::NONE,
                    });
                }
            }
        }
        self.patience.spend(next * (1 + self.cavity.decided.len()));
    }

    /// Whether `p` is inside or on the sphere of a tetrahedron; ties are broken as in thesis 4.4: if `p` is in the plane
    /// of a facet of the hull, as for the finite tetrahedron on the other side.
    #[inline(always)]
    fn is_in_conflict(&mut self, t: u32, p: Point3) -> bool {
        if !self.cavity.decided.is_empty()
            && let Some(is_inside) = self.cavity.decision(t)
        {
            return is_inside;
        }
        if self.cavity.is_narrow {
            return false;
        }
        let tested = self.test(t, p);
        if tested.value != 0.0 || tested.volume != 0.0 {
            return tested.value >= 0.0;
        }
        let finite = self.mesh.beside_faraway(t);
        self.cavity.known(finite).unwrap_or_else(|| self.test(finite, p).value >= 0.0)
    }
}
