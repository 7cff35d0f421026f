//! From simplices to cells: cospherical neighbours are one.

use super::Stats;
use super::canonical::canonical;
use super::simplices::{Coefficient, Complex, FACETS, Facet, INFINITE, Simplex, facet, facet_of, simplex_of};
use spmesh_core::prefetch::prefetch;
use spmesh_model::cells4::{Cell4, Cells4};
use std::cmp::Ordering;
use std::ops::Range;

/// How far ahead memory is fetched.
const AHEAD: usize = 8;

/// The class of simplices that have none yet.
const NONE: u32 = u32::MAX;

/// The cells of the diagram, in canonical order.
///
/// The triangulation is one of the diagram of the points as they are (a limit of diagrams of perturbed
/// points), so each cell is a union of its simplices, and two simplices at a facet are in one cell exactly if
/// the vertex of one is on the sphere of the other. A facet of the diagram on the hull is the union of those
/// facets of simplices of one cell that are in one hyperplane (thesis 4.3.6).
pub(super) fn cells<C: Coefficient>(complex: Complex<C>, stats: &mut Stats) -> Cells4 {
    let classes = classes(&complex);
    let members = |classes: &[u32]| (classes[classes.len() - 1] - classes[0]).into();
    stats.simplices = members(&classes.starts[..=classes.finite]);
    stats.infinite_simplices = members(&classes.starts[classes.finite..]);
    // The spheres, a third of the memory or more, are not needed any more.
    let Complex { simplices, order, spheres, .. } = complex;
    drop(spheres);
    let cells = gathered(&simplices, &order, &classes);
    drop((simplices, order, classes));
    canonical(&cells)
}

/// Which simplices make which cell.
struct Classes {
    /// The class of each simplex.
    of: Vec<u32>,
    /// The simplices of each class, one class after the other, finite ones first: each as the facet that it
    /// was met at, whose opposite vertex may be new to the class; the first as the facet opposite to a vertex
    /// that is finite.
    members: Vec<Facet>,
    /// Where each class begins among the members, and where the last ends.
    starts: Vec<u32>,
    /// Number of classes of finite simplices.
    finite: usize,
}

fn classes<C: Coefficient>(complex: &Complex<C>) -> Classes {
    let (of, members) = (vec![NONE; complex.simplices.len()], Vec::with_capacity(complex.simplices.len()));
    let mut classes = Classes { of, members, starts: vec![0], finite: 0 };
    let all = 0..complex.simplices.len();
    for seed in all.clone().filter(|&seed| complex.is_finite(seed)) {
        classes.fetch_around(complex, seed + AHEAD);
        if classes.of[seed] == NONE {
            classes.flood(complex, seed, |_, _| true);
        }
    }
    classes.finite = classes.len();
    for seed in all.filter(|&seed| complex.is_infinite(seed)) {
        if classes.of[seed] == NONE {
            let inside = |of: &[u32], simplex| complex.neighbour_inside(simplex).map(|finite| of[finite]);
            classes.flood(complex, seed, |of, other| inside(of, seed) == inside(of, other));
        }
    }
    classes
}

impl Classes {
    /// Number of classes.
    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Makes a class of all simplices around a seed whose vertices are on its sphere, or hyperplane, and
    /// which are `allowed`.
    #[inline(always)]
    fn flood<C: Coefficient>(
        &mut self,
        complex: &Complex<C>,
        seed: usize,
        allowed: impl Fn(&[u32], usize) -> bool,
    ) {
        let class = self.len() as u32;
        let mut next = self.members.len();
        let finite = usize::from(complex.simplices[seed].vertices[0] == INFINITE);
        self.join(complex, facet(seed, finite), class);
        while next < self.members.len() {
            let simplex = complex.simplices[simplex_of(self.members[next])];
            next += 1;
            for side in 0..FACETS {
                let beyond = simplex.beyond[side];
                let other = simplex_of(beyond);
                if self.of[other] != NONE {
                    continue;
                }
                let apex = complex.simplices[other].vertices[facet_of(beyond)];
                // Across the hull, one is finite and the other is not.
                let is_across = apex == INFINITE || simplex.vertices[side] == INFINITE;
                if !is_across && complex.sign(seed, apex) == Ordering::Equal && allowed(&self.of, other) {
                    self.join(complex, beyond, class);
                }
            }
        }
        self.starts.push(self.members.len() as u32);
    }

    /// Has what is wanted of the neighbours of a simplex brought into the cache.
    #[inline(always)]
    fn fetch_around<C: Coefficient>(&self, complex: &Complex<C>, simplex: usize) {
        let Some(simplex) = complex.simplices.get(simplex) else { return };
        for beyond in simplex.beyond {
            prefetch(&complex.simplices, simplex_of(beyond));
            prefetch(&self.of, simplex_of(beyond));
        }
    }

    #[inline(always)]
    fn join<C: Coefficient>(&mut self, complex: &Complex<C>, met: Facet, class: u32) {
        self.of[simplex_of(met)] = class;
        self.members.push(met);
        self.fetch_around(complex, simplex_of(met));
    }

    /// Where the simplices of a class are among the members.
    fn places(&self, class: usize) -> Range<usize> {
        self.starts[class] as usize..self.starts[class + 1] as usize
    }
}

/// A cell for each class, neighbours in any order; `order` has the number of the site of each vertex.
fn gathered(simplices: &[Simplex], order: &[u32], classes: &Classes) -> Cells4 {
    let (mut vertices, mut neighbours) = (Vec::new(), Vec::new());
    let mut listed = Marks::new(order.len());
    let mut met = Marks::new(classes.len());
    let mut cells = Cells4::with_capacity(classes.len(), 2 * FACETS * classes.members.len());
    for class in 0..classes.len() {
        vertices.clear();
        neighbours.clear();
        listed.clear();
        met.clear();
        met.mark(class as u32);
        let places = classes.places(class);
        let is_simplex = places.len() == 1;
        let first = simplices[simplex_of(classes.members[places.start])].vertices;
        vertices.extend(first.into_iter().filter(|&vertex| vertex != INFINITE && listed.mark(vertex)));
        for place in places {
            if let Some(&later) = classes.members.get(place + AHEAD) {
                prefetch(simplices, simplex_of(later));
            }
            let facet = classes.members[place];
            let simplex = &simplices[simplex_of(facet)];
            let opposite = simplex.vertices[facet_of(facet)];
            if listed.mark(opposite) {
                vertices.push(opposite);
            }
            let around = simplex.beyond.into_iter().map(|beyond| classes.of[simplex_of(beyond)]);
            if is_simplex {
                // Two convex cells have one facet in common, if any: none of these is met twice.
                neighbours.extend(around);
            } else {
                neighbours.extend(around.filter(|&other| met.mark(other)));
            }
        }
        vertices.iter_mut().for_each(|vertex| *vertex = order[*vertex as usize]);
        vertices.sort_unstable();
        let is_infinite = class >= classes.finite;
        cells.push(Cell4 { is_infinite, vertices: &vertices, neighbours: &neighbours });
    }
    cells
}

/// Marks of numbers that are all taken away at once.
struct Marks {
    round: u32,
    rounds: Vec<u32>,
}

impl Marks {
    fn new(numbers: usize) -> Marks {
        Marks { round: 0, rounds: vec![0; numbers] }
    }

    #[inline(always)]
    fn clear(&mut self) {
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.rounds.fill(0);
            self.round = 1;
        }
    }

    /// Whether the number had no mark before.
    #[inline(always)]
    fn mark(&mut self, number: u32) -> bool {
        std::mem::replace(&mut self.rounds[number as usize], self.round) != self.round
    }
}
