//! Nearest vertices, found along the edges of a Delaunay triangulation of the plane or of space.
//!
//! A vertex that is not nearest to a target has a neighbour that is strictly nearer: on the segment from the
//! vertex to the target the first border of its Voronoi cell is one with that neighbour. So a walk from
//! neighbour to nearer neighbour ends at a nearest vertex, and all vertices up to a distance, but for the
//! nearest ones, have a neighbour among those before. Several nearest vertices are the vertices of a face of
//! the triangulation or of cocircular or cospherical ones, which edges between them connect.

use crate::predicates::nearer;
use foldhash::HashSet;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Vertices and the edges between them.
pub(crate) trait Graph<const D: usize> {
    /// A vertex with what makes it easy to find its neighbours.
    type Node: Copy;

    /// Where it is.
    fn point(&self, node: Self::Node) -> [f64; D];

    /// Index of the input point.
    fn index(&self, node: Self::Node) -> u32;

    /// Replaces the content of `neighbours`.
    fn find_neighbours(&mut self, node: Self::Node, neighbours: &mut Vec<Self::Node>);
}

/// A vertex by its distance from a target, then by its index.
struct Candidate<N, const D: usize> {
    node: N,
    index: u32,
    point: [f64; D],
    target: [f64; D],
}

impl<N, const D: usize> Ord for Candidate<N, D> {
    fn cmp(&self, other: &Self) -> Ordering {
        nearer(self.target, self.point, other.point).then(self.index.cmp(&other.index))
    }
}

impl<N, const D: usize> PartialOrd for Candidate<N, D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<N, const D: usize> PartialEq for Candidate<N, D> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<N, const D: usize> Eq for Candidate<N, D> {}

/// A search for vertices near to a target.
pub(crate) struct Search<'g, G: Graph<D>, const D: usize> {
    graph: &'g mut G,
    target: [f64; D],
    neighbours: Vec<G::Node>,
}

impl<'g, G: Graph<D>, const D: usize> Search<'g, G, D> {
    /// Domain: the target is finite.
    pub(crate) fn new(graph: &'g mut G, target: [f64; D]) -> Self {
        Search { graph, target, neighbours: Vec::new() }
    }

    /// The index of the nearest vertex, the least one of equals, found from any vertex.
    pub(crate) fn nearest(&mut self, start: G::Node) -> u32 {
        let (nearest, has_equals) = self.descend(start);
        let equals = if has_equals { self.equals(nearest) } else { vec![nearest] };
        equals.into_iter().map(|node| self.graph.index(node)).min().expect("a vertex")
    }

    /// The indices of the `count` nearest vertices, by distance, then by index.
    pub(crate) fn k_nearest(&mut self, start: G::Node, count: usize) -> Vec<u32> {
        let (nearest, _) = self.descend(start);
        let first = self.equals(nearest);
        let mut seen: HashSet<u32> = first.iter().map(|&node| self.graph.index(node)).collect();
        let mut heap: BinaryHeap<_> = first.into_iter().map(|node| Reverse(self.candidate(node))).collect();
        let mut found = Vec::new();
        while found.len() < count
            && let Some(Reverse(candidate)) = heap.pop()
        {
            found.push(candidate.index);
            self.graph.find_neighbours(candidate.node, &mut self.neighbours);
            for place in 0..self.neighbours.len() {
                let node = self.neighbours[place];
                if seen.insert(self.graph.index(node)) {
                    heap.push(Reverse(self.candidate(node)));
                }
            }
        }
        found
    }

    fn candidate(&self, node: G::Node) -> Candidate<G::Node, D> {
        let (index, point) = (self.graph.index(node), self.graph.point(node));
        Candidate { node, index, point, target: self.target }
    }

    /// Walks to a nearest vertex, always to the nearest neighbour. Tells whether a neighbour is as near.
    fn descend(&mut self, mut node: G::Node) -> (G::Node, bool) {
        let mut point = self.graph.point(node);
        loop {
            self.graph.find_neighbours(node, &mut self.neighbours);
            let (mut has_nearer, mut has_equals) = (false, false);
            for &neighbour in &self.neighbours {
                let other = self.graph.point(neighbour);
                match nearer(self.target, other, point) {
                    Ordering::Less => (node, point, has_nearer) = (neighbour, other, true),
                    Ordering::Equal => has_equals = true,
                    Ordering::Greater => {}
                }
            }
            if !has_nearer {
                return (node, has_equals);
            }
        }
    }

    /// All vertices that are as near as a nearest one.
    fn equals(&mut self, nearest: G::Node) -> Vec<G::Node> {
        let point = self.graph.point(nearest);
        let mut seen: HashSet<u32> = [self.graph.index(nearest)].into_iter().collect();
        let mut equals = vec![nearest];
        let mut next = 0;
        while let Some(&node) = equals.get(next) {
            next += 1;
            self.graph.find_neighbours(node, &mut self.neighbours);
            for &neighbour in &self.neighbours {
                let is_equal = nearer(self.target, self.graph.point(neighbour), point).is_eq();
                if is_equal && seen.insert(self.graph.index(neighbour)) {
                    equals.push(neighbour);
                }
            }
        }
        equals
    }
}

/// The `count` nearest of `points` with their indices, by distance, then by index: by a look at all of them.
///
/// Cost: O(n) and a sort of the nearest.
pub(crate) fn nearest_of_all<const D: usize>(
    points: impl Iterator<Item = ([f64; D], u32)>,
    target: [f64; D],
    count: usize,
) -> Vec<u32> {
    let mut all: Vec<_> = points.map(|(point, index)| Candidate { node: (), index, point, target }).collect();
    if count > 0 && count < all.len() {
        all.select_nth_unstable(count - 1);
    }
    all.truncate(count);
    all.sort_unstable();
    all.into_iter().map(|candidate| candidate.index).collect()
}
