//! The search for the simplices of each cell.

use std::sync::atomic::{AtomicU32, Ordering};

use super::classes::{Numbers, Part};
use super::order::sort_distinct;
use super::{AHEAD, Borders};
use crate::diagram4::simplices::{FACETS, Simplex, facet, facet_of, simplex_of, without};
use spmesh_base::prefetch::prefetch;
use spmesh_stream::model::cells4::Lists4;

/// Simplices in a row that one part of the search begins at. Parts alternate, so that each has its share of
/// simplices of all ages.
pub(super) const BLOCK: usize = 1 << 10;

/// One part of the search for classes. It begins at the simplices of its blocks, and makes those classes
/// whose first simplex is one of these.
pub(super) struct Search<'a> {
    simplices: &'a [Simplex],
    sites: &'a [u32],
    of: &'a [AtomicU32],
    borders: Borders,
    part: Part,
    /// Number of members of all classes so far, and of the class that is being made.
    end: usize,
    /// Vertices of the class.
    listed: Marks,
}

impl<'a> Search<'a> {
    /// A search that stores the class of each simplex in `of`.
    pub(super) fn new(
        simplices: &'a [Simplex],
        of: &'a [AtomicU32],
        borders: Borders,
        numbers: Numbers,
        sites: &'a [u32],
    ) -> Search<'a> {
        let (count, share) = (simplices.len(), simplices.len() / numbers.parts);
        let part = Part {
            numbers,
            finite: 0,
            // One place more, because a neighbour is written before it is known whether it joins.
            members: vec![0; count + 1],
            starts: vec![0],
            vertices: Lists4::with_capacity(share / 2, FACETS * share),
        };
        Search { simplices, sites, of, borders, part, end: 0, listed: Marks::new(sites.len()) }
    }

    /// What was found.
    pub(super) fn part(mut self) -> Part {
        self.part.members.truncate(self.end);
        self.part
    }

    /// Finds all classes of a kind: finite ones, then infinite ones.
    pub(super) fn find(&mut self, is_infinite: bool) {
        // Compiled for each kind.
        if is_infinite { self.find_all(true) } else { self.find_all(false) }
    }

    #[inline(always)]
    fn find_all(&mut self, is_infinite: bool) {
        let (count, Numbers { part, parts }) = (self.simplices.len(), self.part.numbers);
        for block in (part * BLOCK..count).step_by(parts * BLOCK) {
            for seed in block..(block + BLOCK).min(count) {
                self.fetch_around((seed + AHEAD).min(count - 1));
                let is_new = self.borders.is_new(seed);
                if is_new
                    && self.simplices[seed].is_infinite() == is_infinite
                    && self.flood(seed, is_infinite)
                {
                    self.list(seed, is_infinite);
                }
            }
        }
        if !is_infinite {
            self.part.finite = self.part.starts.len() - 1;
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

    /// Finds all simplices around a seed on its sphere, or in its hyperplane and beyond the same finite cell.
    /// Returns whether they make a class of this part.
    #[inline(always)]
    fn flood(&mut self, seed: usize, is_infinite: bool) -> bool {
        let start = self.end;
        self.borders.visit(seed, true);
        self.part.members[start] = facet(seed, 0);
        self.end += 1;
        if self.borders.inner(seed) == 0 {
            return true;
        }
        let inside = |search: &Self, simplex: usize| {
            let simplex = &search.simplices[simplex];
            search.of[simplex_of(simplex.neighbours[simplex.faraway_side()])].load(Ordering::Relaxed)
        };
        // Simplices of this part before the seed were all visited. So an earlier simplex that joins is of
        // another part, and so is the class.
        let mut is_of_another = false;
        let mut next = start;
        while next < self.end {
            let at = simplex_of(self.part.members[next]);
            next += 1;
            let (inner, neighbours) = (self.borders.inner(at), self.simplices[at].neighbours);
            for (side, neighbour) in neighbours.into_iter().enumerate() {
                // Whether a neighbour joins is unpredictable, so there is no branch: simplex 0, which never
                // joins, stands for the neighbour across a border.
                let other = if inner >> side & 1 == 0 { 0 } else { simplex_of(neighbour) };
                let mut joins = self.borders.is_new(other);
                if is_infinite {
                    joins = joins && inside(self, other) == inside(self, seed);
                }
                self.borders.visit(other, joins);
                is_of_another |= joins & (other < seed);
                self.part.members[self.end] = neighbour;
                self.end += usize::from(joins);
                prefetch(self.simplices, other);
            }
        }
        self.end = if is_of_another { start } else { self.end };
        !is_of_another
    }

    /// Numbers the class that was found last, around a seed, and lists its vertices.
    #[inline(always)]
    fn list(&mut self, seed: usize, is_infinite: bool) {
        let Search { simplices, of, part: Part { numbers, starts, members, vertices, .. }, .. } = self;
        let class = numbers.of(starts.len() - 1);
        let simplex = &simplices[seed];
        if is_infinite {
            vertices.extend(without(simplex.vertices, simplex.faraway_side()));
        } else {
            vertices.extend(simplex.vertices);
        }
        of[seed].store(class, Ordering::Relaxed);
        let others = starts[starts.len() - 1] as usize + 1..self.end;
        if !others.is_empty() {
            self.listed.clear();
            simplex.vertices.iter().for_each(|&vertex| _ = self.listed.mark(vertex));
            for &member in &members[others] {
                of[simplex_of(member)].store(class, Ordering::Relaxed);
                let apex = simplices[simplex_of(member)].vertices[facet_of(member)];
                vertices.extend_if([apex], |apex| self.listed.mark(apex));
            }
        }
        starts.push(self.end as u32);
        let list = vertices.end();
        list.iter_mut().for_each(|vertex| *vertex = self.sites[*vertex as usize]);
        sort_distinct(list);
    }
}

pub(super) struct Marks {
    round: u32,
    rounds: Vec<u32>,
}

impl Marks {
    /// An empty set of numbers below a limit.
    pub(super) fn new(numbers: usize) -> Marks {
        Marks { round: 1, rounds: vec![0; numbers] }
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.rounds.fill(0);
            self.round = 1;
        }
    }

    /// Whether the number had no mark before.
    #[inline(always)]
    pub(super) fn mark(&mut self, number: u32) -> bool {
        std::mem::replace(&mut self.rounds[number as usize], self.round) != self.round
    }
}
