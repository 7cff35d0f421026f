//! Insertion of points: the tetrahedra in conflict with a point give way to a star around it.

use super::cavity::Cavity;
use super::mesh::{Cell, MAX_TETRAHEDRA, Mesh, corner_of, facet, faraway_corner, tetrahedron_of};
use super::phase_timer::{Laps, Part};
use super::star::Star;
use super::{Options, Stats};
use crate::delaunay3::{Tetrahedron, Vertex};
use crate::order::Insertions;
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_core::random::Random;
use std::time::Instant;

/// Work per point, in tetrahedra, after which walks and cavities are kept short: rounding must not make a run endless.
const WORK_PER_POINT: u64 = 10_000;

/// Tetrahedra per walk or cavity until then, and from then on.
const LONG: usize = 1 << 26;
const SHORT: usize = 1000;

/// What walks and cavities may cost.
#[derive(Debug)]
pub(super) struct Patience {
    left: u64,
}

impl Patience {
    /// Greatest number of tetrahedra in a walk or a cavity, if there are `count` in all.
    #[inline(always)]
    pub(super) fn limit(&self, count: usize) -> usize {
        count.min(if self.left > 0 { LONG } else { SHORT })
    }

    /// Takes down that as many were visited.
    #[inline(always)]
    pub(super) fn spend(&mut self, tetrahedra: usize) {
        self.left = self.left.saturating_sub(tetrahedra as u64);
    }
}

/// The triangulation of the points inserted so far, and what inserting needs.
pub(super) struct Insertion<'a> {
    pub(super) mesh: Mesh<'a>,
    pub(super) options: &'a Options,
    pub(super) stats: Stats,
    pub(super) random: Random,
    pub(super) cavity: Cavity,
    pub(super) patience: Patience,
    /// A finite tetrahedron made of late: where walks start.
    pub(super) start: u32,
    pub(super) star: Star,
    pub(super) laps: Laps,
}

impl<'a> Insertion<'a> {
    /// Nothing inserted but the corners of `first`, which is positively oriented.
    pub(super) fn new(vertices: &'a [Vertex], options: &'a Options, first: [u32; 4]) -> Insertion<'a> {
        let mesh = Mesh::new(vertices, first, options.cache_spheres);
        Insertion {
            stats: Stats { created: mesh.cells.len() as u64, ..Stats::default() },
            mesh,
            options,
            random: Random::new(options.seed),
            cavity: Cavity::default(),
            patience: Patience { left: WORK_PER_POINT * vertices.len() as u64 },
            start: 0,
            star: Star::new(vertices.len()),
            laps: Laps::default(),
        }
    }

    /// Inserts the other vertices: the finite tetrahedra, and what was done.
    pub(super) fn run(mut self, insertions: Insertions) -> Result<(Vec<Tetrahedron>, Stats)> {
        let first = self.mesh.cells[0].vertices;
        self.laps.begin_all();
        for v in insertions.filter(|v| !first.contains(v)) {
            self.insert(v)?;
        }
        self.laps.end_all(&mut self.stats.seconds);
        self.stats.bytes = (self.mesh.bytes() + self.cavity.bytes() + self.star.bytes()) as u64;
        let begin = Instant::now();
        let tetrahedra = self.mesh.finite();
        self.stats.missing = self.missing(&tetrahedra);
        self.stats.seconds.extract = begin.elapsed().as_secs_f64();
        Ok((tetrahedra, self.stats))
    }

    /// Inserts a vertex; leaves it out if rounding makes it impossible.
    fn insert(&mut self, v: u32) -> Result<()> {
        self.laps.begin(v);
        let seed = self.locate(self.mesh.vertices[v as usize].at);
        self.laps.end(Part::Locate);
        if seed.is_some_and(|seed| self.find_star(v, seed) || self.repair_star(v, seed)) {
            self.replace()?;
        }
        self.laps.end(Part::Update);
        Ok(())
    }

    /// Puts the star in the place of the cavity.
    fn replace(&mut self) -> Result<()> {
        let Cavity { cells, walls, .. } = &self.cavity;
        let Star { slots, beside, .. } = &mut self.star;
        slots.clear();
        slots.extend(cells.iter().take(walls.len()));
        cells.iter().skip(walls.len()).for_each(|&t| self.mesh.delete(t));
        while slots.len() < walls.len() {
            slots.push(self.mesh.slot().ok_or_else(|| {
                Error::new(
                    ErrorKind::Memory,
                    format!("more than {MAX_TETRAHEDRA} tetrahedra; cut the input into parts"),
                )
            })?);
        }
        for ((wall, beside), &slot) in walls.iter().zip(beside).zip(&*slots) {
            let mut across = beside.map(|side| facet(slots[tetrahedron_of(side) as usize], corner_of(side)));
            across[0] = wall.outside;
            self.mesh.write(slot, Cell { vertices: wall.vertices, across }, &wall.sphere);
            self.mesh.set_across(wall.outside, facet(slot, 0));
            if faraway_corner(&wall.vertices).is_none() {
                self.start = slot;
            }
        }
        self.stats.created += walls.len() as u64;
        Ok(())
    }

    /// Counts the vertices that are in none of the `tetrahedra`.
    fn missing(&self, tetrahedra: &[Tetrahedron]) -> u64 {
        let mut is_there = vec![false; self.mesh.vertices.len()];
        for vertex in tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.vertices) {
            is_there[vertex as usize] = true;
        }
        is_there.iter().filter(|&&is_there| !is_there).count() as u64
    }
}
