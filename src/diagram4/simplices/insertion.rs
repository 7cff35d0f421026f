//! Insertion of points: simplices in conflict give way to a star around the new point.

use super::complex::{Complex, FACETS, INFINITE, SIMPLICES_MAX, Simplex, facet, facet_of, simplex_of};
use crate::diagram4::exact::orientation;
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
            let sphere = complex.sphere_of(&simplex.vertices);
            complex.simplices.push(simplex);
            complex.spheres.push(sphere);
        }
    }

    /// Inserts all other points.
    pub(super) fn run(&mut self) {
        let mut start = 0;
        for q in 5..self.complex.order.len() as u32 {
            start = self.insert(q, start);
        }
    }

    /// Inserts vertex `q`; says where to start for a point nearby.
    fn insert(&mut self, q: u32, start: usize) -> usize {
        let p = self.complex.lifted(q);
        let found = self.complex.locate(q, &p, start);
        self.find_cavity(q, found);
        self.make_star(q);
        self.link_star();
        self.tests += (self.dead.len() + self.border.len()) as u64;
        self.created += self.border.len() as u64;
        self.complex.free.extend_from_slice(&self.dead);
        self.border[0].new as usize
    }

    /// Finds all simplices in conflict, and the facets around them.
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
            let beyond = complex.simplices[at as usize].beyond;
            for (side, beyond) in beyond.into_iter().enumerate() {
                let other = simplex_of(beyond);
                if complex.is_dead(other) {
                    continue;
                }
                if complex.is_in_conflict(other, q, &p) {
                    complex.kill(other);
                    self.dead.push(other as u32);
                } else {
                    self.border.push(Border { dead: at, side: side as u32, new: 0 });
                }
            }
        }
    }

    /// Makes a simplex of each facet of the border and the new point, in places that are free. The dead ones lead to them.
    fn make_star(&mut self, q: u32) {
        let complex = &mut self.complex;
        for border in &mut self.border {
            let (dead, side) = (border.dead as usize, border.side as usize);
            let mut simplex = complex.simplices[dead];
            let outer = simplex.beyond[side];
            simplex.vertices[side] = q;
            let sphere = complex.sphere_of(&simplex.vertices);
            let new = match complex.free.pop() {
                Some(new) => {
                    complex.simplices[new as usize] = simplex;
                    complex.spheres[new as usize] = sphere;
                    new as usize
                }
                None => {
                    assert!(complex.simplices.len() < SIMPLICES_MAX, "too many simplices");
                    complex.simplices.push(simplex);
                    complex.spheres.push(sphere);
                    complex.simplices.len() - 1
                }
            };
            complex.simplices[simplex_of(outer)].beyond[facet_of(outer)] = facet(new, side);
            complex.simplices[dead].beyond[side] = facet(new, side);
            border.new = new as u32;
        }
    }

    /// Links the new simplices with each other.
    ///
    /// Between two of them is a triangle of the border. Around it the dead simplices lead from one to the other: each has two
    /// facets at the triangle, opposite to its two other vertices.
    fn link_star(&mut self) {
        let simplices = &mut self.complex.simplices;
        for &Border { dead, side, new } in &self.border {
            let from = side as usize;
            let vertices = simplices[dead as usize].vertices;
            let beyond = simplices[dead as usize].beyond;
            for to in (0..FACETS).filter(|&to| to != from) {
                // Entered so far opposite to vertex `from`; the facet to leave by is opposite to vertex `to`.
                let (mut entered, mut pivot, mut way) = (from, vertices[from], beyond[to]);
                while self.complex.spheres[simplex_of(way)][4] < 0.0 {
                    let next = &simplices[simplex_of(way)];
                    entered = facet_of(way);
                    let left = next.vertices.iter().position(|&vertex| vertex == pivot).expect("a facet in common");
                    pivot = next.vertices[entered];
                    way = next.beyond[left];
                }
                simplices[new as usize].beyond[to] = facet(simplex_of(way), entered);
            }
        }
    }
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
