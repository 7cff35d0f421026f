//! Finds the simplices of each cell, with numbers that several parts of the search give out at once.

use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use super::search::{BLOCK, Marks, Search};
use super::{AHEAD, Borders};
use crate::diagram4::simplices::{FACETS, Facet, Simplex, simplex_of};
use spmesh_base::prefetch::prefetch;
use spmesh_delaunay::parallel::{for_each, map};
use spmesh_stream::model::cells4::Lists4;

/// The simplices of each cell: a class.
pub(super) struct Classes<'a> {
    simplices: &'a [Simplex],
    /// The number of the class of each simplex.
    of: Vec<AtomicU32>,
    parts: Vec<Part>,
}

/// Classes that one part of the search has found, finite ones first.
pub(super) struct Part {
    pub(super) numbers: Numbers,
    pub(super) finite: usize,
    /// The simplices of each class, one class after the other. Each is given by the facet through which the
    /// search reached it; the vertex opposite to that facet may be new to the class.
    pub(super) members: Vec<Facet>,
    /// Start of each class among the members, and the end of the last.
    pub(super) starts: Vec<u32>,
    /// The sites of the vertices of each class, in increasing order.
    pub(super) vertices: Lists4,
}

impl Part {
    fn len(&self) -> usize {
        self.starts.len() - 1
    }
}

impl<'a> Classes<'a> {
    /// Finds the classes of simplices; `sites` has the site of each vertex.
    pub(super) fn new(
        simplices: &'a [Simplex],
        sites: &[u32],
        borders: Borders,
        threads: NonZeroUsize,
    ) -> Classes<'a> {
        let of: Vec<AtomicU32> = simplices.iter().map(|_| AtomicU32::new(0)).collect();
        let parts = threads.get().min(simplices.len().div_ceil(BLOCK));
        let search = |(part, borders)| Search::new(simplices, &of, borders, Numbers { part, parts }, sites);
        let mut searches: Vec<Search> = (0..).zip(vec![borders; parts]).map(search).collect();
        // The infinite classes need the numbers of all finite ones.
        for is_infinite in [false, true] {
            for_each(threads, &mut searches, |search| search.find(is_infinite));
        }
        let parts = searches.into_iter().map(Search::part).collect();
        Classes { simplices, of, parts }
    }

    /// Numbers of finite and of infinite simplices.
    pub(super) fn simplices(&self) -> (u64, u64) {
        let finite = self.parts.iter().map(|part| u64::from(part.starts[part.finite])).sum();
        let all: u64 = self.parts.iter().map(|part| part.members.len() as u64).sum();
        (finite, all - finite)
    }

    /// Bytes of the simplices, the classes, and the lists that [`Classes::lists`] makes, at most. Borders of
    /// classes are counted as if no two of them were with the same neighbour.
    pub(super) fn bytes(&self) -> usize {
        let neighbours = FACETS * size_of::<u32>();
        let simplex = size_of::<Simplex>() + size_of::<AtomicU32>() + size_of::<Facet>() + neighbours;
        let of_part = |part: &Part| {
            // A class has a start, and its list of neighbours has a start and a length.
            let class = 3 * size_of::<u32>();
            simplex * part.members.len() + class * part.starts.len() + part.vertices.bytes()
        };
        self.parts.iter().map(of_part).sum()
    }

    /// The parts of the joined lists.
    pub(super) fn joined(&self) -> Joined {
        let mut end = 0;
        let section = |part: &Part| {
            let (start, count) = (end, part.len());
            end += count;
            Section { start, count, finite: part.finite, numbers: part.numbers }
        };
        Joined(self.parts.iter().map(section).collect())
    }

    /// Whether all simplices of each class have a mark; empty without marks.
    pub(super) fn marked(&self, marks: &[bool]) -> Vec<bool> {
        if marks.is_empty() {
            return Vec::new();
        }
        let of_class = |part: &'_ Part, class: usize| {
            let members = &part.members[part.starts[class] as usize..part.starts[class + 1] as usize];
            members.iter().all(|&member| marks[simplex_of(member)])
        };
        self.parts.iter().flat_map(|part| (0..part.len()).map(move |class| of_class(part, class))).collect()
    }

    /// The vertices of each class; and, for each part, the lists of its classes' neighbours, unsorted.
    pub(super) fn lists(self, threads: NonZeroUsize) -> (Lists4, Vec<Lists4>) {
        let around = |part: &Part| Ok::<_, Infallible>(self.around(part));
        let Ok(neighbours) = map(threads, &self.parts, around);
        drop(self.of);
        (Lists4::joined(self.parts.into_iter().map(|part| part.vertices)), neighbours)
    }

    /// For each class of a part, the numbers of the classes around it.
    fn around(&self, part: &Part) -> Lists4 {
        let of = |simplex: usize| self.of[simplex].load(Ordering::Relaxed);
        let mut lists = Lists4::with_capacity(part.len(), FACETS * part.members.len());
        let mut met = Marks::new(self.joined().numbers_end());
        let around = |place: usize| {
            if let Some(&later) = part.members.get(place + 2 * AHEAD) {
                prefetch(self.simplices, simplex_of(later));
            }
            if let Some(&later) = part.members.get(place + AHEAD) {
                let neighbours = &self.simplices[simplex_of(later)].neighbours;
                neighbours.iter().for_each(|&neighbour| prefetch(&self.of, simplex_of(neighbour)));
            }
            let neighbours = &self.simplices[simplex_of(part.members[place])].neighbours;
            neighbours.map(|neighbour| of(simplex_of(neighbour)))
        };
        for class in 0..part.len() {
            let members = part.starts[class] as usize..part.starts[class + 1] as usize;
            if members.len() == 1 {
                // Two convex cells have one facet in common, if any: none of these is met twice.
                lists.extend(around(members.start));
            } else {
                met.clear();
                met.mark(part.numbers.of(class));
                for member in members {
                    lists.extend_if(around(member), |other| met.mark(other));
                }
            }
            lists.end();
        }
        lists
    }
}

/// The numbers that one part gives out: every `parts`-th.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) part: usize,
    pub(super) parts: usize,
}

impl Numbers {
    /// The number of a class of the part.
    #[inline(always)]
    pub(super) fn of(self, class: usize) -> u32 {
        (self.part + self.parts * class) as u32
    }
}

/// The classes of one part among those of all parts, one part after the other.
pub(super) struct Section {
    pub(super) start: usize,
    /// Number of classes, and of the finite ones, which come first.
    pub(super) count: usize,
    pub(super) finite: usize,
    pub(super) numbers: Numbers,
}

/// The classes of all parts.
pub(in crate::diagram4) struct Joined(pub(super) Vec<Section>);

impl Joined {
    /// The places of the finite classes of each part.
    pub(in crate::diagram4) fn finite(&self) -> Vec<Range<usize>> {
        self.0.iter().map(|part| part.start..part.start + part.finite).collect()
    }

    /// The places of the infinite classes of each part.
    pub(super) fn infinite(&self) -> Vec<Range<usize>> {
        self.0.iter().map(|part| part.start + part.finite..part.start + part.count).collect()
    }

    /// The number of the class at a place.
    #[inline(always)]
    pub(super) fn number(&self, place: usize) -> u32 {
        let mut parts = self.0.iter().rev();
        parts.find(|part| part.start <= place).map_or(0, |part| part.numbers.of(place - part.start))
    }

    /// The place of the class of a number.
    #[inline(always)]
    pub(in crate::diagram4) fn place(&self, number: u32) -> u32 {
        let parts = self.0.len();
        (self.0[number as usize % parts].start + number as usize / parts) as u32
    }

    /// A number above those of all classes.
    pub(super) fn numbers_end(&self) -> usize {
        self.0.iter().map(|part| part.numbers.of(part.count) as usize).max().unwrap_or(0)
    }
}
