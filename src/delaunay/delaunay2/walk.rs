//! The walk of queries: from a triangle to the one that contains a target.

use super::triangles::{Corner, Triangle};
use super::triangulation::Triangulation;
use crate::predicates::{Extent, FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};
use crate::starts::Starts;

/// Steps from the last triangle after which a walker jumps. A jump costs about as much.
const STEPS_TO_NEXT: usize = 16;

/// Where a walk ends.
pub(super) enum Arrival {
    /// In this triangle, closed: the sides of its edges that the target lies on, none of them negative. Entry
    /// `i` is for the edge opposite to corner `i`.
    Inside(u32, [Sign; 3]),
    /// At the hull: the target lies strictly beyond an edge of this triangle.
    Outside(u32),
    /// In this triangle, after as many steps as were allowed.
    OnTheWay(u32),
}

/// Walks from target to target. Where it arrives does not depend on the targets before, but for the choice
/// among triangles that all contain a target.
#[derive(Debug)]
pub(super) struct Walker<'m> {
    pub(super) mesh: &'m Triangulation,
    pub(super) predicates: FiniteFloatPredicates,
    last: u32,
    /// Found when they are needed first: targets that follow each other need none.
    starts: Option<Starts<2>>,
}

impl<'m> Walker<'m> {
    pub(super) fn new(mesh: &'m Triangulation) -> Walker<'m> {
        Walker { mesh, predicates: FiniteFloatPredicates::default(), last: 0, starts: None }
    }

    /// Walks to a target, from the last one if it is near. `None` if there are no triangles or the target is
    /// not finite.
    pub(super) fn walk(&mut self, target: Point2) -> Option<Arrival> {
        let mut arrival = self.mesh.walk(target, self.last, STEPS_TO_NEXT, &mut self.predicates)?;
        if let Arrival::OnTheWay(_) = arrival {
            let start = self.starts.get_or_insert_with(|| self.mesh.starts()).near(target);
            arrival = self.mesh.walk(target, start, usize::MAX, &mut self.predicates)?;
        }
        let (Arrival::Inside(number, _) | Arrival::Outside(number) | Arrival::OnTheWay(number)) = arrival;
        self.last = number;
        Some(arrival)
    }
}

impl Triangulation {
    /// Triangles to begin walks at, for targets in no order. Cost: a sort of a quarter as many as points.
    pub fn starts(&self) -> Starts<2> {
        let triangles = self.triangles.triangles();
        let corner = |number: u32| self.points[triangles[number as usize].vertices[0] as usize];
        Starts::new(triangles.len(), &Extent::of(&self.points), corner)
    }

    /// Walks from triangle `start`, or from the last one if there are fewer, towards `target`, exactly, at
    /// most so many steps. `None` if there are no triangles or the target is not finite.
    ///
    /// Cost: a step for each triangle between; O(sqrt n) steps for points that are spread evenly.
    pub(super) fn walk(
        &self,
        target: Point2,
        start: u32,
        steps_max: usize,
        predicates: &mut FiniteFloatPredicates,
    ) -> Option<Arrival> {
        let triangles = self.triangles.triangles();
        if !target.iter().all(|coordinate| coordinate.is_finite()) {
            return None;
        }
        let mut number = start.min(triangles.len().checked_sub(1)? as u32);
        // The side across which the walk has come: the target is known to be on the inner side of it.
        let mut entered = None;
        // In a Delaunay triangulation this walk meets no triangle twice.
        for _ in 0..steps_max {
            let triangle = &triangles[number as usize];
            let corners = self.places(triangle);
            let mut signs = [Sign::Positive; 3];
            let mut exit = None;
            for side in (0..3).filter(|&side| Some(side) != entered) {
                signs[side] = predicates.orient2d(corners[(side + 1) % 3], corners[(side + 2) % 3], target);
                if signs[side] == Sign::Negative {
                    exit = Some(side);
                    break;
                }
            }
            let Some(exit) = exit else { return Some(Arrival::Inside(number, signs)) };
            let Some(Corner { triangle, corner }) = triangle.neighbour(exit) else {
                return Some(Arrival::Outside(number));
            };
            (number, entered) = (triangle, Some(corner as usize));
        }
        Some(Arrival::OnTheWay(number))
    }

    /// Where the corners of a triangle are.
    #[inline(always)]
    pub(super) fn places(&self, triangle: &Triangle) -> [Point2; 3] {
        triangle.vertices.map(|v| self.points[v as usize])
    }

    /// The vertex at `target` if there are no triangles: the vertices are in lexicographic order then.
    pub(super) fn vertex_on_line(&self, target: Point2) -> Option<u32> {
        let is_answer = self.triangles.triangles().is_empty() && target.iter().all(|c| c.is_finite());
        is_answer.then(|| self.place_on_line(target).ok()).flatten().map(|place| self.triangles.hull[place])
    }

    /// The place of the vertex at `target` in the hull of a triangulation without triangles, or where it would
    /// be.
    pub(super) fn place_on_line(&self, target: Point2) -> Result<usize, usize> {
        self.triangles.hull.binary_search_by(|&v| lexicographic(self.points[v as usize], target))
    }
}

/// The corner at which the target lies, if it lies at one: the other two signs are zero.
pub(super) fn corner_at(signs: [Sign; 3]) -> Option<usize> {
    (0..3).find(|&corner| signs[(corner + 1) % 3] == Sign::Zero && signs[(corner + 2) % 3] == Sign::Zero)
}
