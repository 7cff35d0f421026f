//! Insertion of points: the tetrahedra in conflict with a point give way to a star around it.

use super::cavity::Cavity;
use super::mesh::{MAX_TETRAHEDRA, Tetrahedron, corner_of, facet, faraway_corner, tetrahedron_of};
use super::phase_timer::Phase;
use super::star::Star;
use super::state::State;
use super::stats::Stats;
use spmesh_delaunay::delaunay3;
use spmesh_delaunay::order::Insertions;
use spmesh_delaunay::{Error, Result};
use std::time::Instant;

impl State<'_> {
    /// Inserts the other vertices: the finite tetrahedra, and what was done.
    pub(super) fn run(mut self, insertions: Insertions) -> Result<(Vec<delaunay3::Tetrahedron>, Stats)> {
        let first = self.mesh.tetrahedra[0].vertices;
        self.timer.begin_all();
        for v in insertions.filter(|v| !first.contains(v)) {
            self.insert(v)?;
        }
        self.timer.end_all(&mut self.stats.seconds);
        self.stats.bytes = (self.mesh.bytes() + self.cavity.bytes() + self.star.bytes()) as u64;
        let begin = Instant::now();
        let tetrahedra = self.mesh.finite();
        self.stats.missing = self.missing(&tetrahedra);
        self.stats.seconds.extract = begin.elapsed().as_secs_f64();
        Ok((tetrahedra, self.stats))
    }

    /// Inserts a vertex; leaves it out if rounding makes it impossible.
    fn insert(&mut self, v: u32) -> Result<()> {
        self.timer.begin(v);
        let seed = self.locate(self.mesh.vertices[v as usize].at);
        self.timer.end(Phase::Locate);
        if seed.is_some_and(|seed| self.find_star(v, seed) || self.repair_star(v, seed)) {
            self.replace()?;
        }
        self.timer.end(Phase::Update);
        Ok(())
    }

    /// Puts the star in the place of the cavity.
    fn replace(&mut self) -> Result<()> {
        let Cavity { tetrahedra, walls, .. } = &self.cavity;
        let Star { slots, beside, .. } = &mut self.star;
        slots.clear();
        slots.extend(tetrahedra.iter().take(walls.len()));
        tetrahedra.iter().skip(walls.len()).for_each(|&t| self.mesh.delete(t));
        while slots.len() < walls.len() {
            slots.push(self.mesh.slot().ok_or(Error::TooManyTetrahedra(MAX_TETRAHEDRA as usize))?);
        }
        for ((wall, beside), &slot) in walls.iter().zip(beside).zip(&*slots) {
            let mut neighbours =
                beside.map(|side| facet(slots[tetrahedron_of(side) as usize], corner_of(side)));
            neighbours[0] = wall.outside;
            self.mesh.write(slot, Tetrahedron { vertices: wall.vertices, neighbours }, &wall.sphere);
            self.mesh.set_neighbour(wall.outside, facet(slot, 0));
            if faraway_corner(&wall.vertices).is_none() {
                self.start = slot;
            }
        }
        self.stats.created += walls.len() as u64;
        Ok(())
    }

    /// Counts the vertices that are in none of the `tetrahedra`.
    fn missing(&self, tetrahedra: &[delaunay3::Tetrahedron]) -> u64 {
        let mut is_there = vec![false; self.mesh.vertices.len()];
        for vertex in tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.vertices) {
            is_there[vertex as usize] = true;
        }
        is_there.iter().filter(|&&is_there| !is_there).count() as u64
    }
}
