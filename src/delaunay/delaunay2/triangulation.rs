//! A triangulation that answers questions.

use super::Kernel;
use super::half_edge::NONE;
use super::insert::FarWalks;
use super::triangles::{Triangle, Triangles};
use crate::error::Result;
use crate::location::Location;
use crate::points::is_finite;
use crate::predicates::{Extent, FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};
use crate::starts::Starts;
use crate::walk::{self, Arrival, Walkable};
use std::num::NonZeroUsize;
use std::sync::OnceLock;

/// A Delaunay triangulation with its points. All vertices are indices of the input points.
///
/// [`Tetrahedralization`](crate::delaunay3::Tetrahedralization) has the same methods in space.
#[derive(Debug, Clone, Default)]
pub struct Triangulation {
    pub(super) points: Vec<Point2>,
    pub(super) triangles: Triangles,
    /// Of walks, found when they are needed first.
    pub(super) starts: OnceLock<Starts<2>>,
    pub(super) far_walks: FarWalks,
}

impl Triangulation {
    /// The triangulation of points that a kernel makes.
    ///
    /// # Errors
    /// As [`Kernel::triangulate`].
    pub fn by(kernel: &mut Kernel, points: Vec<Point2>) -> Result<Triangulation> {
        let mut triangles = Triangles::default();
        kernel.triangulate(&points, &mut triangles)?;
        Ok(Triangulation { points, triangles, ..Triangulation::default() })
    }

    /// The input points, duplicates included.
    pub fn points(&self) -> &[Point2] {
        &self.points
    }

    /// The arrays of the kernel.
    pub fn arrays(&self) -> &Triangles {
        &self.triangles
    }

    /// All triangles with their neighbours; [`Triangulation::simplices`] are their vertices alone.
    pub fn triangles(&self) -> &[Triangle] {
        self.triangles.triangles()
    }

    /// Points left out because an equal point of lesser index is there: `[duplicate, vertex]`.
    pub fn duplicates(&self) -> &[[u32; 2]] {
        &self.triangles.duplicates
    }

    /// The triangles by their vertices, counterclockwise. Their numbers are those of
    /// [`Triangulation::neighbours`].
    pub fn simplices(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        self.triangles().iter().map(|triangle| triangle.vertices)
    }

    /// The triangles across the edges opposite to the three vertices of triangle `number`; `None` at the
    /// hull.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn neighbours(&self, number: u32) -> [Option<u32>; 3] {
        let triangle = &self.triangles()[number as usize];
        [0, 1, 2].map(|side| triangle.neighbour(side).map(|corner| corner.triangle))
    }

    /// The edges of all triangles, each once with its lesser vertex first, in increasing order.
    ///
    /// Cost: a sort.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
        let mut edges: Vec<[u32; 2]> =
            self.simplices().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The edges of the hull, counterclockwise; none if there are no triangles.
    pub fn hull(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let vertices = &self.triangles.hull;
        let count = if self.triangles().is_empty() { 0 } else { vertices.len() };
        (0..count).map(move |i| [vertices[i], vertices[(i + 1) % count]])
    }

    /// For each point the vertex that stands for it: the equal point of least index.
    pub fn representatives(&self) -> Vec<u32> {
        let mut representatives: Vec<u32> = (0..self.points.len() as u32).collect();
        self.triangles
            .duplicates
            .iter()
            .for_each(|&[point, vertex]| representatives[point as usize] = vertex);
        representatives
    }

    /// Where `target` lies: exactly. A target with a coordinate that is not finite is outside.
    ///
    /// If there are no triangles, every target that is no vertex is outside.
    ///
    /// Cost: a walk of O(sqrt n) triangles for points that are spread evenly.
    pub fn locate(&self, target: Point2) -> Location {
        self.locate_from(target, 0)
    }

    /// [`Triangulation::locate`] by a walk that begins at triangle `start`: short, if that is near, such as
    /// the one that [`Starts`] find. Any number will do.
    pub fn locate_from(&self, target: Point2, start: u32) -> Location {
        match walk::walk(self, start, target, &mut FiniteFloatPredicates::default()) {
            Some(Arrival::Inside(number, sides)) => {
                Location::in_simplex(number, self.triangles()[number as usize].vertices, sides)
            }
            Some(Arrival::Outside(..)) => Location::Outside,
            None => self.vertex_on_line(target).map_or(Location::Outside, Location::Vertex),
        }
    }

    /// A triangle that contains `target`, its border included, by a walk that begins at triangle `near`, any
    /// number, which becomes the last one of the walk. `None` outside of the hull, without triangles, and if
    /// the target is not finite.
    pub fn triangle_at(&self, target: Point2, near: &mut u32) -> Option<u32> {
        let arrival = walk::walk(self, *near, target, &mut FiniteFloatPredicates::default())?;
        *near = arrival.simplex();
        matches!(arrival, Arrival::Inside(..)).then_some(*near)
    }

    /// For each target the number of the triangle that contains it, its border included: the least, if there
    /// are several. [`NONE`] for targets that are outside, or not finite.
    ///
    /// The targets are asked for in order along a curve, in blocks, on so many threads; the answers do not
    /// depend on them.
    ///
    /// Cost: O(log m) for each of m targets that are spread as the points are, to put it in order.
    pub fn locate_all(&self, targets: &[Point2], threads: NonZeroUsize) -> Vec<u32> {
        walk::find_all(self, targets, threads, NONE)
    }

    /// Triangles to begin walks at, for targets in no order. They are found with the first question, and stay
    /// good enough when points are inserted.
    ///
    /// Cost: a sort of a quarter as many as points.
    pub fn starts(&self) -> &Starts<2> {
        self.starts.get_or_init(|| {
            let corner = |number: u32| self.points[self.triangles()[number as usize].vertices[0] as usize];
            Starts::new(self.triangles().len(), &Extent::of(&self.points), corner)
        })
    }

    /// Where the corners of a triangle are.
    #[inline(always)]
    pub(super) fn places(&self, triangle: &Triangle) -> [Point2; 3] {
        triangle.vertices.map(|v| self.points[v as usize])
    }

    /// The vertex at `target` if there are no triangles: the vertices are in lexicographic order then.
    pub(super) fn vertex_on_line(&self, target: Point2) -> Option<u32> {
        let is_answer = self.triangles().is_empty() && is_finite(&target);
        is_answer.then(|| self.place_on_line(target).ok()).flatten().map(|place| self.triangles.hull[place])
    }

    /// The place of the vertex at `target` in the hull of a triangulation without triangles, or where it
    /// would be.
    pub(super) fn place_on_line(&self, target: Point2) -> std::result::Result<usize, usize> {
        self.triangles.hull.binary_search_by(|&v| lexicographic(self.points[v as usize], target))
    }
}

impl Walkable<2, 3> for Triangulation {
    type Predicates = FiniteFloatPredicates;

    fn simplices_len(&self) -> usize {
        self.triangles().len()
    }

    fn start_near(&self, target: Point2) -> u32 {
        self.starts().near(target)
    }

    #[inline]
    fn side(
        &self,
        number: u32,
        corner: usize,
        target: Point2,
        predicates: &mut FiniteFloatPredicates,
    ) -> Sign {
        let vertices = self.triangles()[number as usize].vertices;
        let [u, v] = [1, 2].map(|turn| self.points[vertices[(corner + turn) % 3] as usize]);
        predicates.orient2d(u, v, target)
    }

    #[inline]
    fn across(&self, number: u32, corner: usize) -> Option<u32> {
        self.triangles()[number as usize].neighbour(corner).map(|corner| corner.triangle)
    }
}
