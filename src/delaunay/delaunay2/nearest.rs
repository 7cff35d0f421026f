//! The nearest vertices of a target.

use super::triangulation::Triangulation;
use crate::nearest::{Graph, Search, nearest_of_all};
use crate::points::is_finite;
use crate::predicates::{FiniteFloatPredicates, Point2};
use crate::walk::walk;

impl Graph<2> for &Triangulation {
    type Node = u32;

    fn point(&self, v: u32) -> Point2 {
        self.points[v as usize]
    }

    fn index(&self, v: u32) -> u32 {
        v
    }

    fn find_neighbours(&mut self, v: u32, neighbours: &mut Vec<u32>) {
        neighbours.clear();
        neighbours.extend(self.star(v));
    }
}

impl Triangulation {
    /// The vertex nearest to the target, exactly: that of least index, if several are. The target may be
    /// outside of the hull. `None` if there are no points or the target is not finite.
    ///
    /// Cost: a walk of O(sqrt n) triangles for points that are spread evenly; without triangles, O(n).
    pub fn nearest(&self, target: Point2) -> Option<u32> {
        self.nearest_from(target, 0)
    }

    /// The same, found from triangle `start`: fast if it is near, such as the one that
    /// [`Starts`](crate::Starts) find. Any number will do.
    pub fn nearest_from(&self, target: Point2, start: u32) -> Option<u32> {
        match self.first_vertex(target, start) {
            Some(first) => Some(Search::new(&mut &*self, target).nearest(first)),
            None => self.nearest_on_line(target, 1).first().copied(),
        }
    }

    /// The `count` vertices nearest to the target, or all if there are fewer: exactly, by distance, then by
    /// index. None if the target is not finite.
    ///
    /// Cost: that of [`Triangulation::nearest`], and O(log k) for each of the k vertices and their
    /// neighbours.
    pub fn k_nearest(&self, target: Point2, count: usize) -> Vec<u32> {
        self.k_nearest_from(target, count, 0)
    }

    /// The same, found from triangle `start`.
    pub fn k_nearest_from(&self, target: Point2, count: usize, start: u32) -> Vec<u32> {
        match self.first_vertex(target, start) {
            Some(first) => Search::new(&mut &*self, target).k_nearest(first, count),
            None => self.nearest_on_line(target, count),
        }
    }

    /// A vertex of the triangle where the walk to the target ends, if there are triangles.
    fn first_vertex(&self, target: Point2, start: u32) -> Option<u32> {
        let arrival = walk(self, start, target, &mut FiniteFloatPredicates::default())?;
        Some(self.triangles()[arrival.simplex() as usize].vertices[0])
    }

    /// Without triangles.
    fn nearest_on_line(&self, target: Point2, count: usize) -> Vec<u32> {
        if !is_finite(&target) {
            return Vec::new();
        }
        nearest_of_all(self.triangles.hull.iter().map(|&v| (self.points[v as usize], v)), target, count)
    }
}
