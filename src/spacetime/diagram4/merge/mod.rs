//! Joins cospherical neighbouring simplices to cells, in an order that depends on the diagram only.

mod classes;
mod order;
mod search;

use std::num::NonZeroUsize;

use super::Stats;
use super::simplices::{Coefficient, Complex};
use crate::diagram4::simplices::FACETS;
use classes::Classes;
pub(super) use classes::Joined;
pub use order::sort_distinct;
use spmesh_base::prefetch::prefetch;
use spmesh_delaunay::parallel::for_each;
use spmesh_stream::model::cells4::{Cells4, Lists4};

/// The cells of the diagram, in canonical order.
///
/// The triangulation is one of the diagram of the points as they are (a limit of diagrams of perturbed
/// points), so each cell is a union of its simplices, and two simplices at a facet are in one cell exactly if
/// the vertex of one is on the sphere of the other. A facet of the diagram on the hull is the union of those
/// facets of simplices of one cell that are in one hyperplane (thesis 4.3.6).
pub(super) fn cells<C: Coefficient>(complex: Complex<C>, threads: NonZeroUsize, stats: &mut Stats) -> Cells4 {
    let threads = if complex.simplices.len() < SHARED_MIN { NonZeroUsize::MIN } else { threads };
    let unordered = unordered(complex, &[], usize::MAX, threads, stats);
    let Unordered { vertices, mut neighbours, joined, .. } = unordered.expect("no limit");
    let mut order = order::canonical(&vertices, &joined.finite(), threads);
    let finite = order.len();
    order.extend(order::canonical(&vertices, &joined.infinite(), threads));
    let mut places = vec![0; joined.numbers_end()];
    for (place, &class) in (0u32..).zip(&order) {
        places[joined.number(class as usize) as usize] = place;
    }
    for_each(threads, &mut neighbours, |lists| renumber(lists, &places));
    Cells4::from_lists(vertices, Lists4::joined(neighbours), &order, finite)
}

/// The cells of a diagram, in any order.
pub(super) struct Unordered {
    /// The vertices of each cell, as sites.
    pub(super) vertices: Lists4,
    /// The neighbours of each cell, unsorted, as the numbers that `joined` gives to cells.
    pub(super) neighbours: Vec<Lists4>,
    pub(super) joined: Joined,
    /// Whether all simplices of a cell have a mark; empty without marks.
    pub(super) marked: Vec<bool>,
    /// Most bytes that it took to join them, by estimate.
    pub(super) bytes: usize,
}

/// Joins simplices, which may have marks. `None` if that takes more than `bytes`.
pub(super) fn unordered<C: Coefficient>(
    complex: Complex<C>,
    marks: &[bool],
    bytes: usize,
    threads: NonZeroUsize,
    stats: &mut Stats,
) -> Option<Unordered> {
    let borders = Borders::of(&complex, threads);
    let Complex { simplices, order: sites, spheres, near, .. } = complex;
    // Free the spheres, a third of the memory or more.
    drop((spheres, near));
    let classes = Classes::new(&simplices, &sites, borders, threads);
    drop(sites);
    let taken = classes.bytes();
    if taken > bytes {
        return None;
    }
    let (finite, infinite) = classes.simplices();
    stats.simplices += finite;
    stats.infinite_simplices += infinite;
    let (joined, marked) = (classes.joined(), classes.marked(marks));
    let (vertices, neighbours) = classes.lists(threads);
    Some(Unordered { vertices, neighbours, joined, marked, bytes: taken })
}

/// Replaces classes by their places, and sorts each list.
fn renumber(neighbours: &mut Lists4, places: &[u32]) {
    for class in 0..neighbours.len() {
        let list = neighbours.get_mut(class);
        list.iter_mut().for_each(|other| *other = places[*other as usize]);
        order::sort_distinct(list);
    }
}

/// Fewer simplices are not worth the start of threads.
const SHARED_MIN: usize = 1 << 12;

/// Simplices or cells to prefetch ahead.
const AHEAD: usize = 8;

/// Bits for each simplex: those of facets across which the neighbour is on the same sphere, or in the same
/// hyperplane, and those of dead and of visited simplices.
#[derive(Clone)]
pub(super) struct Borders(Vec<u8>);

/// Simplices that a thread tests at a time.
const PIECE: usize = 1 << 14;

const DEAD: u8 = 1 << FACETS;
const VISITED: u8 = DEAD << 1;

impl Borders {
    /// Tests all facets. The search for cells, which jumps about in memory, then needs no spheres; this pass
    /// through the memory knows in time what to prefetch.
    pub(super) fn of<C: Coefficient>(complex: &Complex<C>, threads: NonZeroUsize) -> Borders {
        let count = complex.simplices.len();
        let bits = |simplex: usize| {
            complex.fetch_spheres_around((simplex + AHEAD).min(count - 1));
            if complex.is_dead(simplex) {
                return DEAD;
            }
            (0..FACETS).fold(0, |bits, side| bits | u8::from(complex.is_cospherical(simplex, side)) << side)
        };
        let mut borders = vec![0; count];
        let pieces = borders.chunks_mut(PIECE).enumerate();
        for_each(threads, pieces, |(number, piece)| {
            (number * PIECE..).zip(piece).for_each(|(simplex, border)| *border = bits(simplex));
        });
        Borders(borders)
    }

    /// Whether a simplex is alive and was not visited before.
    #[inline(always)]
    pub(super) fn is_new(&self, simplex: usize) -> bool {
        self.0[simplex] < DEAD
    }

    /// Visits a simplex if it `joins`.
    #[inline(always)]
    pub(super) fn visit(&mut self, simplex: usize, joins: bool) {
        self.0[simplex] |= if joins { VISITED } else { 0 };
    }

    /// Prefetches the bits of a simplex.
    #[inline(always)]
    pub(super) fn fetch(&self, simplex: usize) {
        prefetch(&self.0, simplex);
    }

    /// The bits of the facets of a simplex that are inside of a cell.
    #[inline(always)]
    pub(super) fn inner(&self, simplex: usize) -> u8 {
        self.0[simplex] & (DEAD - 1)
    }
}
