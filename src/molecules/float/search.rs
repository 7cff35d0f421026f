//! The search of a cavity: tetrahedra whose spheres have the new point inside, changed until it sees all
//! facets around.

use super::insertion::State;
use super::mesh::{sphere_of, tetrahedron_of};
use super::phase_timer::Phase;
use super::sphere::Sphere;
use super::star::Wall;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;

/// Searches for one cavity, each with more decided.
const SEARCHES_MAX: usize = 20;

impl State<'_> {
    /// Finds the tetrahedra around `seed` that are in conflict with vertex `v`, and the new ones that are to
    /// replace them; false if it does not see all facets around, or these are not a sphere.
    #[inline(always)]
    pub(super) fn find_star(&mut self, v: u32, seed: u32) -> bool {
        self.search(v, seed);
        let mut is_seen = true;
        for wall in &mut self.cavity.walls {
            wall.sphere = sphere_of(self.mesh.vertices, &wall.vertices);
            is_seen &= wall.is_seen();
        }
        self.timer.end(Phase::Predicates);
        is_seen && self.star.pair(&self.cavity.walls)
    }

    /// Finds a cavity that is not as the values of spheres have it: one around the tetrahedron that the point
    /// is in, without those that hide facets, or just that tetrahedron; with its neighbour, if the point is
    /// on a facet.
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
        let limit = self.patience.limit(self.mesh.tetrahedra.len());
        self.cavity.begin(seed, self.mesh.tetrahedra.len());
        let mut next = 0;
        while let Some(&t) = self.cavity.tetrahedra.get(next) {
            next += 1;
            let tetrahedron = self.mesh.tetrahedra[t as usize];
            for (outside, corners) in tetrahedron.neighbours.into_iter().zip(TETRAHEDRON_FACETS) {
                let other = tetrahedron_of(outside);
                let is_inside = self.cavity.known(other).unwrap_or_else(|| {
                    let is_inside = self.cavity.tetrahedra.len() < limit && self.is_in_conflict(other, p);
                    self.cavity.add(other, is_inside);
                    is_inside
                });
                if !is_inside {
                    let [a, b, c] = corners.map(|corner| tetrahedron.vertices[corner]);
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

    /// Whether `p` is inside or on the sphere of a tetrahedron; ties are broken as in thesis 4.4: if `p` is
    /// in the plane of a facet of the hull, as for the finite tetrahedron on the other side.
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
