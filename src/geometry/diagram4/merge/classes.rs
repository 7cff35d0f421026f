//! Finds the simplices of each cell.

use super::AHEAD;
use super::borders::Borders;
use super::marks::Marks;
use super::ranks::sort_distinct;
use crate::diagram4::simplices::{FACETS, Facet, Simplex, facet, facet_of, simplex_of, without};
use spmesh_core::prefetch::prefetch;
use spmesh_model::cells4::Lists4;

/// The simplices of each cell: a class.
pub(super) struct Classes {
    /// The class of each simplex.
    of: Vec<u32>,
    /// The simplices of each class, one class after the other, finite classes first. Each is given by the
    /// facet through which the search reached it; the vertex opposite to that facet may be new to the class.
    members: Vec<Facet>,
    /// Start of each class among the members, and the end of the last.
    starts: Vec<u32>,
    /// The sites of the vertices of each class, in increasing order.
    vertices: Lists4,
    /// Number of classes of finite simplices.
    pub(super) finite: usize,
}

impl Classes {
    /// Finds the classes of simplices; `sites` has the site of each vertex.
    pub(super) fn new(simplices: &[Simplex], sites: &[u32], borders: Borders) -> Classes {
        let count = simplices.len();
        let mut search = Search {
            simplices,
            borders,
            of: vec![0; count],
            // One place more, because a neighbour is written before it is known whether it joins.
            members: vec![0; count + 1],
            end: 0,
            listed: Marks::new(sites.len()),
        };
        let mut starts = vec![0];
        let mut vertices = Lists4::with_capacity(count / 2, FACETS * count);
        let mut finite = 0;
        for is_infinite in [false, true] {
            for (seed, simplex) in simplices.iter().enumerate() {
                search.fetch_around((seed + AHEAD).min(count - 1));
                if !search.borders.is_new(seed) || simplex.is_infinite() != is_infinite {
                    continue;
                }
                let class = starts.len() as u32 - 1;
                search.list_first(&mut vertices, seed, is_infinite);
                search.flood(seed, class, is_infinite, &mut vertices);
                starts.push(search.end as u32);
                let list = vertices.end();
                list.iter_mut().for_each(|vertex| *vertex = sites[*vertex as usize]);
                sort_distinct(list);
            }
            if !is_infinite {
                finite = starts.len() - 1;
            }
        }
        let Search { of, mut members, end, .. } = search;
        members.truncate(end);
        Classes { of, members, starts, vertices, finite }
    }

    /// Numbers of finite and of infinite simplices.
    pub(super) fn simplices(&self) -> (u64, u64) {
        let finite = self.starts[self.finite].into();
        (finite, self.members.len() as u64 - finite)
    }

    /// The vertices of each class, and the classes around each, in any order.
    pub(super) fn lists(self, simplices: &[Simplex]) -> (Lists4, Lists4) {
        let count = self.vertices.len();
        let mut lists = Lists4::with_capacity(count, FACETS * self.members.len());
        let mut met = Marks::new(count);
        let around = |place: usize| {
            if let Some(&later) = self.members.get(place + 2 * AHEAD) {
                prefetch(simplices, simplex_of(later));
            }
            if let Some(&later) = self.members.get(place + AHEAD) {
                let neighbours = &simplices[simplex_of(later)].neighbours;
                neighbours.iter().for_each(|&neighbour| prefetch(&self.of, simplex_of(neighbour)));
            }
            let neighbours = &simplices[simplex_of(self.members[place])].neighbours;
            neighbours.map(|neighbour| self.of[simplex_of(neighbour)])
        };
        for class in 0..count {
            let members = self.starts[class] as usize..self.starts[class + 1] as usize;
            if members.len() == 1 {
                // Two convex cells have one facet in common, if any: none of these is met twice.
                lists.extend(around(members.start));
            } else {
                met.clear();
                met.mark(class as u32);
                for member in members {
                    lists.extend_if(around(member), |other| met.mark(other));
                }
            }
            lists.end();
        }
        (self.vertices, lists)
    }
}

/// The search for classes.
struct Search<'a> {
    simplices: &'a [Simplex],
    borders: Borders,
    of: Vec<u32>,
    /// Those of all classes so far, and the class that is being made.
    members: Vec<Facet>,
    end: usize,
    /// Vertices of the class.
    listed: Marks,
}

impl Search<'_> {
    /// Lists the finite vertices of the first simplex of a class.
    #[inline(always)]
    fn list_first(&mut self, vertices: &mut Lists4, seed: usize, is_infinite: bool) {
        let simplex = &self.simplices[seed];
        if is_infinite {
            vertices.extend(without(simplex.vertices, simplex.faraway_side()));
        } else {
            vertices.extend(simplex.vertices);
        }
    }

    /// Prefetches what the search needs from the neighbours of a simplex in the same cell.
    #[inline(always)]
    fn fetch_around(&self, simplex: usize) {
        let inner = self.borders.inner(simplex);
        for (side, &neighbour) in self.simplices[simplex].neighbours.iter().enumerate() {
            let other = if inner >> side & 1 == 0 { 0 } else { simplex_of(neighbour) };
            prefetch(self.simplices, other);
            self.borders.fetch(other);
        }
    }

    /// Makes a class of all simplices around a seed on its sphere, or in its hyperplane and beyond the same
    /// finite cell. Lists their vertices after those of the seed.
    #[inline(always)]
    fn flood(&mut self, seed: usize, class: u32, is_infinite: bool, vertices: &mut Lists4) {
        let start = self.end;
        self.borders.visit(seed, true);
        self.of[seed] = class;
        self.members[start] = facet(seed, 0);
        self.end += 1;
        if self.borders.inner(seed) == 0 {
            return;
        }
        let inside = |search: &Self, simplex: usize| {
            let simplex = &search.simplices[simplex];
            search.of[simplex_of(simplex.neighbours[simplex.faraway_side()])]
        };
        let mut next = start;
        while next < self.end {
            let at = simplex_of(self.members[next]);
            next += 1;
            self.of[at] = class;
            let (inner, neighbours) = (self.borders.inner(at), self.simplices[at].neighbours);
            for (side, neighbour) in neighbours.into_iter().enumerate() {
                // Whether a neighbour joins is unpredictable: without branches, and with simplex 0, which
                // never joins, in place of those across a border.
                let other = if inner >> side & 1 == 0 { 0 } else { simplex_of(neighbour) };
                let mut joins = self.borders.is_new(other);
                if is_infinite {
                    joins = joins && inside(self, other) == inside(self, seed);
                }
                self.borders.visit(other, joins);
                self.members[self.end] = neighbour;
                self.end += usize::from(joins);
                prefetch(self.simplices, other);
            }
        }
        self.listed.clear();
        for vertex in self.simplices[seed].vertices {
            self.listed.mark(vertex);
        }
        for &member in &self.members[start + 1..self.end] {
            let apex = self.simplices[simplex_of(member)].vertices[facet_of(member)];
            vertices.extend_if([apex], |apex| self.listed.mark(apex));
        }
    }
}
