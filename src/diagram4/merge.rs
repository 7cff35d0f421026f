//! From simplices to cells: cospherical neighbours are one.

use super::Stats;
use super::simplices::{Complex, FACETS, INFINITE, facet_of, simplex_of};
use crate::cells4::{Cell4, Cells4};
use crate::prefetch::prefetch;
use std::cmp::Ordering;

/// How far ahead memory is fetched.
const AHEAD: usize = 8;

/// The class of simplices that have none yet.
const NONE: u32 = u32::MAX;

/// The cells of the diagram, in canonical order.
///
/// The triangulation is one of the diagram of the points as they are (a limit of diagrams of perturbed points), so each
/// cell is a union of its simplices, and two simplices at a facet are in one cell exactly if the vertex of one is on
/// the sphere of the other. A facet of the diagram on the hull is the union of those facets of simplices of one cell
/// that are in one hyperplane (thesis 4.3.6).
pub(super) fn cells(complex: Complex, stats: &mut Stats) -> Cells4 {
    let mut classes = Classes::new(&complex);
    let all = 0..complex.simplices.len();
    for seed in all.clone().filter(|&seed| complex.is_finite(seed)) {
        classes.fetch_around(seed + AHEAD);
        if classes.of[seed] == NONE {
            stats.simplices += classes.flood(seed, |_, _| true);
        }
    }
    for seed in all.filter(|&seed| complex.is_infinite(seed)) {
        if classes.of[seed] == NONE {
            let inside = |of: &[u32], simplex| complex.neighbour_inside(simplex).map(|finite| of[finite]);
            stats.infinite_simplices +=
                classes.flood(seed, |of, other| inside(of, seed) == inside(of, other));
        }
    }
    let Classes { of, found, .. } = classes;
    drop(complex);
    canonical(&found, &of)
}

/// The simplices of each cell, gathered from one to the next.
struct Classes<'a> {
    complex: &'a Complex<'a>,
    /// The class of each simplex.
    of: Vec<u32>,
    /// The last class that each vertex was listed for.
    seen: Vec<u32>,
    /// A cell for each class, with a simplex of each neighbour.
    found: Cells4,
    members: Vec<u32>,
    vertices: Vec<u32>,
    beyond: Vec<u32>,
}

impl<'a> Classes<'a> {
    fn new(complex: &'a Complex<'a>) -> Classes<'a> {
        Classes {
            complex,
            of: vec![NONE; complex.simplices.len()],
            seen: vec![NONE; complex.order.len()],
            found: Cells4::default(),
            members: Vec::new(),
            vertices: Vec::new(),
            beyond: Vec::new(),
        }
    }

    /// Makes a class of all simplices around a seed whose vertices are on its sphere, or hyperplane, and which are
    /// `allowed`; says how many they are.
    fn flood(&mut self, seed: usize, allowed: impl Fn(&[u32], usize) -> bool) -> u64 {
        let class = self.found.len() as u32;
        let is_infinite = self.complex.is_infinite(seed);
        self.members.clear();
        self.vertices.clear();
        self.beyond.clear();
        self.join(seed, class);
        let mut next = 0;
        while next < self.members.len() {
            let simplex = self.complex.simplices[self.members[next] as usize];
            next += 1;
            if let Some(&later) = self.members.get(next + 1) {
                self.fetch_around(later as usize);
            }
            for side in 0..FACETS {
                self.list(simplex.vertices[side], class);
                let beyond = simplex.beyond[side];
                let other = simplex_of(beyond);
                if self.of[other] == class {
                    continue;
                }
                let apex = self.complex.simplices[other].vertices[facet_of(beyond)];
                // Across the hull, one is finite and the other is not.
                let is_across = apex == INFINITE || simplex.vertices[side] == INFINITE;
                let is_in_one = !is_across
                    && self.of[other] == NONE
                    && self.complex.sign(seed, apex) == Ordering::Equal
                    && allowed(&self.of, other);
                if is_in_one {
                    self.join(other, class);
                } else {
                    self.beyond.push(other as u32);
                }
            }
        }
        self.vertices.sort_unstable();
        self.found.push(Cell4 { is_infinite, vertices: &self.vertices, neighbours: &self.beyond });
        self.members.len() as u64
    }

    /// Has what is wanted of the neighbours of a simplex brought into the cache.
    #[inline(always)]
    fn fetch_around(&self, simplex: usize) {
        let Some(simplex) = self.complex.simplices.get(simplex) else { return };
        for beyond in simplex.beyond {
            prefetch(&self.complex.simplices, simplex_of(beyond));
            prefetch(&self.of, simplex_of(beyond));
        }
    }

    fn join(&mut self, simplex: usize, class: u32) {
        self.of[simplex] = class;
        self.members.push(simplex as u32);
    }

    /// Lists a vertex of a class, by number of its site, once.
    fn list(&mut self, vertex: u32, class: u32) {
        if vertex != INFINITE && std::mem::replace(&mut self.seen[vertex as usize], class) != class {
            self.vertices.push(self.complex.order[vertex as usize]);
        }
    }
}

/// Finite cells first, both kinds by their vertices; neighbours renumbered, each once.
///
/// What stands for neighbours are numbers whose cells `of` has.
pub(super) fn canonical(unordered: &Cells4, of: &[u32]) -> Cells4 {
    // The kind and the first vertices decide mostly: no cell has to be looked at for these.
    let key = |number: u32| {
        let cell = unordered.get(number as usize);
        let first = u64::from(cell.vertices[0]) << 31 | u64::from(cell.vertices[1]) >> 1;
        (u64::from(cell.is_infinite) << 63 | first, number)
    };
    let mut order: Vec<(u64, u32)> = (0..unordered.len() as u32).map(key).collect();
    let vertices = |number: u32| unordered.get(number as usize).vertices;
    order.sort_unstable_by(|&(key, a), &(other, b)| {
        key.cmp(&other).then_with(|| vertices(a).cmp(vertices(b)))
    });
    let mut places = vec![0; order.len()];
    for (place, &(_, number)) in (0u32..).zip(&order) {
        places[number as usize] = place;
    }
    let mut cells = Cells4::with_room_of(unordered);
    let mut neighbours = Vec::new();
    for (place, &(_, number)) in order.iter().enumerate() {
        if let Some(&(_, later)) = order.get(place + AHEAD) {
            unordered.fetch(later as usize);
        }
        let cell = unordered.get(number as usize);
        neighbours.clear();
        neighbours.extend(cell.neighbours.iter().map(|&other| places[of[other as usize] as usize]));
        neighbours.sort_unstable();
        neighbours.dedup();
        cells.push(Cell4 { neighbours: &neighbours, ..cell });
    }
    cells
}
