//! Inserts points: a star around the new point replaces the simplices in conflict.

use super::cavity::Cavity;
use super::coefficient::Coefficient;
use super::complex::{Arrays, Complex, FACETS, Facet, INFINITE, Simplex, facet, simplex_of, spheres_of};
#[cfg(target_arch = "x86_64")]
use super::lanes::Avx2;
use super::lanes::{LANES, Lanes, Portable};
use super::links::{self, Links};

use crate::diagram4::exact::orientation;
use spmesh_base::error::Result;
#[cfg(target_arch = "x86_64")]
use spmesh_delaunay::processor::Avx2Fma;
use std::cmp::Ordering;

pub(super) struct Insertion<'a, C> {
    pub(super) complex: Complex<'a, C>,
    /// Where the next walk starts: near the last point.
    start: usize,
    cavity: Cavity,
    /// The simplices around the new point, one for each facet of the border.
    star: Vec<u32>,
    /// Places of dead simplices.
    free: Vec<u32>,
    links: Links,
    pub(super) created: u64,
    pub(super) tests: u64,
}

impl<'a, C: Coefficient> Insertion<'a, C> {
    /// A triangulation of the first five points, which span space.
    pub(super) fn new(complex: Complex<'a, C>) -> Insertion<'a, C> {
        let (cavity, star, free, links) = (Cavity::default(), Vec::new(), Vec::new(), Links::default());
        let mut insertion = Insertion { complex, start: 1, cavity, star, free, links, created: 6, tests: 0 };
        insertion.insert_first();
        insertion
    }

    fn insert_first(&mut self) {
        let complex = &mut self.complex;
        let mut vertices = [1, 2, 3, 4, 5];
        let [a, b, c, d, e] = vertices.map(|vertex| complex.point(vertex));
        let exactness = complex.sites.exactness;
        if orientation(exactness, [a, b, c, d], e) == Ordering::Less {
            vertices.swap(0, 1);
        }
        // Simplex 1 is finite. Simplex i + 2 is its neighbour at facet i: the faraway point replaces vertex
        // i, and the other vertices keep their places.
        complex.simplices.push(Simplex { vertices, neighbours: std::array::from_fn(|i| facet(i + 2, i)) });
        for side in 0..FACETS {
            let mut vertices = vertices;
            vertices[side] = INFINITE;
            // The neighbour opposite to the faraway point is the finite simplex. The one opposite to vertex k
            // lacks k and has vertex i in its own place.
            let mut neighbours: [Facet; FACETS] =
                std::array::from_fn(|other| facet(if other == side { 1 } else { other + 2 }, side));
            let swaps = sort(&mut vertices, &mut neighbours);
            // Replacing a vertex by a point across the facet turns the orientation.
            if swaps.is_multiple_of(2) {
                vertices.swap(0, 1);
                neighbours.swap(0, 1);
            }
            complex.simplices.push(Simplex { vertices, neighbours });
        }
        for number in 1..complex.simplices.len() {
            let [a, b, c, d, last] = complex.simplices[number].vertices;
            let [sphere, ..] = spheres_of::<C, Portable>(
                (),
                &complex.near,
                &complex.near[last as usize],
                &[[a, b, c, d]; LANES],
            );
            complex.spheres.push(sphere);
        }
        fix_sides(&mut complex.simplices);
    }

    /// Inserts all other points, with AVX2 where the processor has it.
    pub(super) fn run(&mut self) -> Result<()> {
        #[cfg(target_arch = "x86_64")]
        if let Some(token) = Avx2Fma::detect() {
            // SAFETY: the token proves that the processor has AVX2.
            return unsafe { self.run_avx2(token) };
        }
        self.run_with::<Portable>(())
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_avx2(&mut self, token: Avx2Fma) -> Result<()> {
        self.run_with::<Avx2>(token)
    }

    #[inline(always)]
    fn run_with<L: Lanes>(&mut self, token: L::Token) -> Result<()> {
        // In a closure it would not be compiled for the processor.
        for q in 6..self.complex.order.len() as u32 {
            self.insert::<L>(token, q)?;
        }
        Ok(())
    }

    /// Inserts vertex `q`.
    #[inline(always)]
    fn insert<L: Lanes>(&mut self, token: L::Token, q: u32) -> Result<()> {
        let Insertion { complex, start, cavity, star, free, links, .. } = self;
        let p = complex.lifted(q);
        let found = complex.locate(q, &p, *start);
        cavity.find::<C, L>(token, complex, q, found);
        let len = complex.allocate(cavity.border().len(), free, star)?;
        // SAFETY: the cavity and what is beyond its border are in the arrays, and the star is in reserved
        // places, which are read when they have been written.
        let mut arrays = unsafe { Arrays::of(&mut complex.simplices, &mut complex.spheres) };
        links::make::<C, L>(token, &mut arrays, &complex.near, q, cavity, star, links);
        // SAFETY: the star has all places that were taken.
        unsafe { complex.extend(len) };
        free.extend(cavity.dead().iter().map(|&dead| simplex_of(dead) as u32));
        *start = star[0] as usize;
        self.created += star.len() as u64;
        self.tests += (cavity.dead().len() + cavity.border().len()) as u64;
        Ok(())
    }
}

/// Sorts the vertices of a simplex, and its neighbours alike; returns the number of swaps.
fn sort(vertices: &mut [u32; FACETS], neighbours: &mut [Facet; FACETS]) -> usize {
    let mut swaps = 0;
    for end in (1..FACETS).rev() {
        for i in 0..end {
            if vertices[i] > vertices[i + 1] {
                vertices.swap(i, i + 1);
                neighbours.swap(i, i + 1);
                swaps += 1;
            }
        }
    }
    swaps
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

#[cfg(test)]
mod tests {
    use super::super::complex::facet_of;
    use super::*;
    use crate::diagram4::Stats;
    use crate::diagram4::simplices::triangulate;
    use crate::diagram4::sites::{Sites, distinct};
    use spmesh_base::random::Random;
    use spmesh_stream::model::cells4::Point4;

    /// Checks all simplices of a triangulation of so many random points with coordinates below `side`.
    fn check<C: Coefficient>(count: usize, side: u64) {
        let mut random = Random::new(side);
        let points: Vec<Point4> = (0..count).map(|_| [(); 4].map(|()| random.below(side) as f64)).collect();
        let sites = Sites::new(distinct(points, None).0);
        let complex = triangulate::<C>(&sites, &mut Stats::default()).unwrap();
        let alive = (0..complex.simplices.len()).filter(|&number| !complex.is_dead(number));
        for (number, simplex) in alive.map(|number| (number, complex.simplices[number])) {
            let [a, b, rest @ ..] = simplex.vertices;
            assert!(a != b && a.max(b) < rest[0] && rest.is_sorted_by(|x, y| x < y), "{simplex:?}");
            for (side, &neighbour) in simplex.neighbours.iter().enumerate() {
                let other = &complex.simplices[simplex_of(neighbour)];
                assert_eq!(other.neighbours[facet_of(neighbour)], facet(number, side));
                let mut facets = [simplex.vertices, other.vertices];
                (facets[0][side], facets[1][facet_of(neighbour)]) = (u32::MAX, u32::MAX);
                facets.iter_mut().for_each(|facet| facet.sort_unstable());
                assert_eq!(facets[0], facets[1]);
            }
            if !simplex.is_infinite() {
                let [a, b, c, d, e] = simplex.vertices.map(|vertex| complex.point(vertex));
                assert_eq!(orientation(sites.exactness, [a, b, c, d], e), Ordering::Greater);
            }
        }
    }

    #[test]
    fn simplices_are_sorted_positive_and_linked() {
        check::<i32>(300, 6);
        check::<f64>(300, 100);
        check::<f64>(300, 1 << 20);
    }

    #[test]
    fn few_points_in_reserved_places() {
        check::<i32>(16, 3);
        check::<f64>(16, 100);
    }
}
