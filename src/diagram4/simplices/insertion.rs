//! Insertion of points: simplices in conflict give way to a star around the new point.

use super::complex::{Complex, FACETS, INFINITE, SIMPLICES_MAX, Simplex, facet, facet_of, simplex_of};
use super::lanes::LANES;
use crate::diagram4::exact::orientation;
use crate::error::{Error, ErrorKind, Result};
use crate::prefetch::prefetch;
use std::cmp::Ordering;

/// A facet between a simplex in conflict and one that stays.
#[derive(Debug, Clone, Copy)]
struct Border {
    /// The simplex in conflict, and the side of the facet.
    dead: u32,
    side: u32,
    /// The simplex that is made of the facet and the new point.
    new: u32,
}

/// Marks where a dead simplex leads to a new one; alone, what is beyond a facet of a new one before it is linked.
const NEW: u32 = 1 << 31;

pub(super) struct Insertion<'a> {
    pub(super) complex: Complex<'a>,
    /// Simplices in conflict: those up to the one at hand have been looked around.
    dead: Vec<u32>,
    border: Vec<Border>,
    pub(super) created: u64,
    pub(super) tests: u64,
}

impl<'a> Insertion<'a> {
    /// Begins with the simplex of the first five points, which span space.
    pub(super) fn new(complex: Complex<'a>) -> Insertion<'a> {
        let mut insertion = Insertion { complex, dead: Vec::new(), border: Vec::new(), created: 6, tests: 0 };
        insertion.begin();
        insertion
    }

    fn begin(&mut self) {
        let complex = &mut self.complex;
        let mut vertices = [0, 1, 2, 3, 4];
        let [a, b, c, d, e] = vertices.map(|vertex| complex.point(vertex));
        let exactness = complex.sites.exactness;
        if orientation(exactness, [a, b, c, d], e) == Ordering::Less {
            vertices.swap(0, 1);
        }
        // Simplex 0, and number i + 1 beyond its facet i, in which the faraway point takes the place of vertex i; the
        // other vertices keep their places.
        let mut all = vec![Simplex { vertices, beyond: std::array::from_fn(|side| facet(side + 1, side)) }];
        for side in 0..FACETS {
            let mut infinite = Simplex { vertices, beyond: [0; FACETS] };
            infinite.vertices[side] = INFINITE;
            for other in 0..FACETS {
                // Opposite to the faraway point is simplex 0; opposite to vertex k is the one without k, where vertex i
                // is in its own place.
                infinite.beyond[other] = if other == side { facet(0, side) } else { facet(other + 1, side) };
            }
            // Another point in the place of a vertex, on the other side of the facet, would be negative.
            let (i, j) = if side < 2 { (2, 3) } else { (0, 1) };
            swap_places(&mut infinite, i, j);
            all.push(infinite);
        }
        fix_sides(&mut all);
        for simplex in all {
            let common = simplex.vertices.iter().position(|&vertex| vertex != INFINITE).unwrap_or_default();
            let o = complex.near[simplex.vertices[common] as usize];
            let [sphere, ..] = complex.spheres_of(&o, [&simplex.vertices; LANES], [common; LANES]);
            complex.simplices.push(simplex);
            complex.spheres.push(sphere);
        }
    }

    /// Inserts all other points, with the widest instructions there are.
    ///
    /// Errors: too many simplices.
    pub(super) fn run(&mut self) -> Result<()> {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // Safety: the processor has AVX2.
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
        let mut start = 0;
        for q in 5..self.complex.order.len() as u32 {
            start = self.insert(q, start)?;
        }
        Ok(())
    }

    /// Inserts vertex `q`; says where to start for a point nearby.
    #[inline(always)]
    fn insert(&mut self, q: u32, start: usize) -> Result<usize> {
        let p = self.complex.lifted(q);
        let found = self.complex.locate(q, &p, start);
        self.find_cavity(q, found);
        self.make_room()?;
        self.make_star(q);
        self.link_star();
        self.tests += (self.dead.len() + self.border.len()) as u64;
        self.created += self.border.len() as u64;
        self.complex.free.extend_from_slice(&self.dead);
        Ok(self.border[0].new as usize)
    }

    /// Finds all simplices in conflict, and the facets around them.
    #[inline(always)]
    fn find_cavity(&mut self, q: u32, found: usize) {
        let complex = &mut self.complex;
        let p = complex.lifted(q);
        self.dead.clear();
        self.border.clear();
        complex.kill(found);
        self.dead.push(found as u32);
        let mut next = 0;
        while next < self.dead.len() {
            let at = self.dead[next];
            next += 1;
            if let Some(&later) = self.dead.get(next + 1) {
                complex.fetch_neighbours(later as usize);
            }
            let beyond = complex.simplices[at as usize].beyond;
            for (side, beyond) in beyond.into_iter().enumerate() {
                let other = simplex_of(beyond);
                if complex.is_dead(other) {
                    continue;
                }
                if complex.is_in_conflict(other, q, &p) {
                    complex.kill(other);
                    prefetch(&complex.simplices, other);
                    self.dead.push(other as u32);
                } else {
                    self.border.push(Border { dead: at, side: side as u32, new: 0 });
                }
            }
        }
    }

    /// Makes a simplex of each facet of the border and the new point, in places that are free. The dead ones lead to them.
    #[inline(always)]
    fn make_star(&mut self, q: u32) {
        let complex = &mut self.complex;
        let o = complex.near[q as usize];
        for borders in self.border.chunks(LANES) {
            let mut star = [complex.simplices[borders[0].dead as usize]; LANES];
            let mut sides = [0; LANES];
            for ((simplex, side), border) in star.iter_mut().zip(&mut sides).zip(borders) {
                *simplex = complex.simplices[border.dead as usize];
                *side = border.side as usize;
                simplex.vertices[*side] = q;
            }
            let [a, b, c, d] = &star;
            let spheres = complex.spheres_of(&o, [&a.vertices, &b.vertices, &c.vertices, &d.vertices], sides);
            for ((border, simplex), sphere) in borders.iter().zip(star).zip(spheres) {
                let (dead, side, new) = (border.dead as usize, border.side as usize, border.new as usize);
                let outer = simplex.beyond[side];
                let mut beyond = [NEW; FACETS];
                beyond[side] = outer;
                complex.simplices[new] = Simplex { beyond, ..simplex };
                complex.spheres[new] = sphere;
                complex.simplices[simplex_of(outer)].beyond[facet_of(outer)] = facet(new, side);
                complex.simplices[dead].beyond[side] = NEW | facet(new, side);
            }
        }
    }

    /// Finds places for the new simplices.
    #[inline(always)]
    fn make_room(&mut self) -> Result<()> {
        let complex = &mut self.complex;
        if complex.simplices.len() + self.border.len() > SIMPLICES_MAX {
            let message =
                format!("more than {SIMPLICES_MAX} simplices, the most that a diagram can be made of");
            return Err(Error::new(ErrorKind::Io, message));
        }
        for border in &mut self.border {
            border.new = complex.free.pop().unwrap_or_else(|| {
                complex.simplices.push(complex.simplices[0]);
                complex.spheres.push(complex.spheres[0]);
                complex.simplices.len() as u32 - 1
            });
        }
        Ok(())
    }

    /// Links the new simplices with each other.
    ///
    /// Between two of them is a triangle of the border. Around it the dead simplices lead from one to the other: each has two
    /// facets at the triangle, opposite to its two other vertices.
    #[inline(always)]
    fn link_star(&mut self) {
        let simplices = &mut self.complex.simplices;
        for &Border { dead, side, new } in &self.border {
            let from = side as usize;
            let Simplex { vertices, beyond } = simplices[dead as usize];
            for to in (0..FACETS).filter(|&to| to != from) {
                if simplices[new as usize].beyond[to] != NEW {
                    // Found from the other side.
                    continue;
                }
                // Entered so far opposite to the vertex `pivot`, which is what the next one is left opposite to.
                let (mut entered, mut pivot, mut way) = (from, vertices[from], beyond[to]);
                while way & NEW == 0 {
                    let next = &simplices[simplex_of(way)];
                    entered = facet_of(way);
                    let left = place_of(pivot, &next.vertices);
                    pivot = next.vertices[entered];
                    way = next.beyond[left];
                }
                let other = simplex_of(way ^ NEW);
                simplices[new as usize].beyond[to] = facet(other, entered);
                simplices[other].beyond[entered] = facet(new as usize, to);
            }
        }
    }
}

/// The place of a vertex that is one of these, without branches.
#[inline(always)]
fn place_of(vertex: u32, vertices: &[u32; FACETS]) -> usize {
    (1..FACETS).map(|place| if vertices[place] == vertex { place } else { 0 }).sum()
}

/// Exchanges two vertices, with what is beyond the facets opposite to them.
fn swap_places(simplex: &mut Simplex, i: usize, j: usize) {
    simplex.vertices.swap(i, j);
    simplex.beyond.swap(i, j);
}

/// Corrects which side of the simplex beyond each facet is.
fn fix_sides(all: &mut [Simplex]) {
    for number in 0..all.len() {
        for side in 0..FACETS {
            let other = simplex_of(all[number].beyond[side]);
            let back = all[other].beyond.iter().position(|&beyond| simplex_of(beyond) == number);
            all[number].beyond[side] = facet(other, back.expect("mutual neighbours"));
        }
    }
}
