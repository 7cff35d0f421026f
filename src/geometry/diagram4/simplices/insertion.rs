//! Inserts points: a star around the new point replaces the simplices in conflict.

use super::cavity::Cavity;
use super::coefficient::Coefficient;
use super::complex::{Complex, FACETS, Facet, INFINITE, SIMPLICES_MAX, Simplex, facet, facet_of, simplex_of};
use super::lanes::LANES;
use super::links::Links;
use crate::diagram4::exact::orientation;
use spmesh_core::error::{Error, ErrorKind, Result};
use std::cmp::Ordering;

pub(super) struct Insertion<'a, C> {
    pub(super) complex: Complex<'a, C>,
    cavity: Cavity,
    /// The simplices around the new point, one for each facet of the border.
    star: Vec<u32>,
    links: Links,
    pub(super) created: u64,
    pub(super) tests: u64,
}

impl<'a, C: Coefficient> Insertion<'a, C> {
    /// A triangulation of the first five points, which span space.
    pub(super) fn new(complex: Complex<'a, C>) -> Insertion<'a, C> {
        let (cavity, links) = (Cavity::default(), Links::default());
        let mut insertion = Insertion { complex, cavity, star: Vec::new(), links, created: 6, tests: 0 };
        insertion.insert_first();
        insertion
    }

    fn insert_first(&mut self) {
        let complex = &mut self.complex;
        let mut vertices = [0, 1, 2, 3, 4];
        let [a, b, c, d, e] = vertices.map(|vertex| complex.point(vertex));
        let exactness = complex.sites.exactness;
        if orientation(exactness, [a, b, c, d], e) == Ordering::Less {
            vertices.swap(0, 1);
        }
        // Simplex 1 is finite. Simplex i + 2 is its neighbour at facet i: the faraway point replaces vertex
        // i, and the other vertices keep their places.
        let mut all = vec![(vertices, std::array::from_fn(|side| facet(side + 2, side)))];
        for side in 0..FACETS {
            let mut vertices = vertices;
            vertices[side] = INFINITE;
            // The neighbour opposite to the faraway point is the finite simplex. The one opposite to vertex k
            // lacks k and has vertex i in its own place.
            let mut neighbours: [Facet; FACETS] =
                std::array::from_fn(|other| facet(if other == side { 1 } else { other + 2 }, side));
            // Replacing a vertex by a point across the facet turns the orientation: swap two vertices.
            let (i, j) = if side < 2 { (2, 3) } else { (0, 1) };
            vertices.swap(i, j);
            neighbours.swap(i, j);
            all.push((vertices, neighbours));
        }
        for (vertices, neighbours) in all {
            let common = vertices.iter().position(|&vertex| vertex != INFINITE).unwrap_or_default();
            let o = complex.near[vertices[common] as usize];
            let [sphere, ..] = complex.spheres_of(&o, [&vertices; LANES], [common; LANES]);
            complex.simplices.push(Simplex { vertices, neighbours });
            complex.spheres.push(sphere);
        }
        fix_sides(&mut complex.simplices);
    }

    /// Inserts all other points, with AVX2 where the processor has it.
    ///
    /// # Errors
    /// Too many simplices.
    pub(super) fn run(&mut self) -> Result<()> {
        #[cfg(target_arch = "x86_64")]
        if crate::processor::Avx2Fma::detect().is_some() {
            // SAFETY: the token proves that the processor has AVX2.
            return unsafe { self.run_avx2() };
        }
        self.run_portable()
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_avx2(&mut self) -> Result<()> {
        self.run_portable()
    }

    #[inline(always)]
    fn run_portable(&mut self) -> Result<()> {
        let mut start = 1;
        for q in 5..self.complex.order.len() as u32 {
            start = self.insert(q, start)?;
        }
        Ok(())
    }

    /// Inserts vertex `q`; returns a simplex to start from for a point nearby.
    #[inline(always)]
    fn insert(&mut self, q: u32, start: usize) -> Result<usize> {
        let p = self.complex.lifted(q);
        let found = self.complex.locate(q, &p, start);
        self.cavity.find(&mut self.complex, q, found);
        self.allocate()?;
        self.make_star(q);
        self.tests += (self.cavity.dead().len() + self.cavity.border().len()) as u64;
        self.created += self.star.len() as u64;
        self.complex.free.extend_from_slice(self.cavity.dead());
        Ok(self.star[0] as usize)
    }

    /// Allocates the new simplices: dead ones are reused first.
    #[inline(always)]
    fn allocate(&mut self) -> Result<()> {
        let Complex { simplices, spheres, free, .. } = &mut self.complex;
        let wanted = self.cavity.border().len();
        if simplices.len() + wanted > SIMPLICES_MAX {
            let message =
                format!("more than {SIMPLICES_MAX} simplices, the most that a diagram can be made of");
            return Err(Error::new(ErrorKind::Io, message));
        }
        let (reused, before) = (free.len().min(wanted), simplices.len());
        self.star.clear();
        self.star.extend(free.drain(free.len() - reused..).rev());
        simplices.resize(before + wanted - reused, simplices[0]);
        spheres.resize(simplices.len(), spheres[0]);
        self.star.extend(before as u32..simplices.len() as u32);
        Ok(())
    }

    /// Makes a simplex of each facet of the border and the new point, in the allocated places, and links
    /// them.
    #[inline(always)]
    fn make_star(&mut self, q: u32) {
        let o = self.complex.near[q as usize];
        self.links.clear(self.star.len());
        for (facets, star) in self.cavity.border().chunks(LANES).zip(self.star.chunks(LANES)) {
            let facets: [Facet; LANES] = std::array::from_fn(|lane| facets[lane.min(facets.len() - 1)]);
            let sides = facets.map(facet_of);
            let vertices = facets.map(|facet| {
                let dead = &self.complex.simplices[simplex_of(facet)].vertices;
                std::array::from_fn(|i| if i == facet_of(facet) { q } else { dead[i] })
            });
            let spheres =
                self.complex.spheres_of(&o, [&vertices[0], &vertices[1], &vertices[2], &vertices[3]], sides);
            for (lane, &new) in star.iter().enumerate() {
                let (new, side) = (new as usize, sides[lane]);
                let simplices = &mut self.complex.simplices;
                let outer = simplices[simplex_of(facets[lane])].neighbours[side];
                simplices[simplex_of(outer)].neighbours[facet_of(outer)] = facet(new, side);
                self.complex.spheres[new] = spheres[lane];
                let simplex = &mut simplices[new];
                simplex.vertices = vertices[lane];
                simplex.neighbours[side] = outer;
                self.links.link(simplices, new, &vertices[lane], side);
            }
        }
    }
}

/// Corrects the side of each neighbour.
fn fix_sides(all: &mut [Simplex]) {
    for number in 1..all.len() {
        for side in 0..FACETS {
            let other = simplex_of(all[number].neighbours[side]);
            let back = all[other].neighbours.iter().position(|&neighbour| simplex_of(neighbour) == number);
            all[number].neighbours[side] = facet(other, back.expect("mutual neighbours"));
        }
    }
}
