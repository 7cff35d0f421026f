//! Constrained Delaunay triangulation of a region: segments become edges, and every other edge is locally
//! Delaunay with canonical ties.
//!
//! A [`Region`] starts as some triangles of a Delaunay triangulation. Its border stays. Vertices and segments
//! are inserted; what comes out is the constrained Delaunay triangulation of the region, which is unique:
//! ties on circles are broken by the perturbation of [`Predicates2::incircle_perturbed`]. So the order of
//! insertion does not matter.
//!
//! A [`ConstrainedTriangulation`] is that of a whole set of points and segments.
//!
//! Source: Chew, "Constrained Delaunay triangulations", 1989; Anglada, "An improved incremental algorithm for
//! constructing restricted Delaunay triangulations", 1997, for the insertion of a segment.

mod chord;
mod depths;
mod mesh;
mod triangulation;
mod vertex;
mod walk;

use crate::error::Result;
use crate::predicates::{Point2, Predicates2};
use mesh::{Mesh, NONE, Side};
pub use triangulation::ConstrainedTriangulation;
pub use vertex::Host;

/// A part of a triangulation that is triangulated anew.
#[derive(Debug, Clone, Default)]
pub struct Region {
    mesh: Mesh,
    /// The triangle that the last vertex was inserted in, by its number at the start, and that vertex.
    last: Option<[u32; 2]>,
}

/// A side on the border of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BorderSide {
    side: Side,
    /// The places of its ends; the region is on its left.
    pub ends: [Point2; 2],
}

/// A triangle of the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piece {
    /// Numbers of its points, counterclockwise.
    pub points: [u32; 3],
    /// For each side, opposite to the point of the same place, the segment that it is on.
    pub segments: [Option<u32>; 3],
}

impl Region {
    /// The region of some triangles, which are counterclockwise and overlap nowhere. They are indices of
    /// `points`, of which no two are equal.
    pub fn new(points: &[Point2], triangles: &[[u32; 3]]) -> Region {
        Region { mesh: mesh::mesh_of(points, triangles), last: None }
    }

    /// Where a place lies that is in the triangle with this number in the order of [`Region::new`]: the
    /// triangle or edge of the present mesh.
    ///
    /// Domain: the place is in this triangle or on its border.
    pub fn host(&self, place: Point2, triangle: u32, predicates: &mut impl Predicates2) -> Host {
        let from = self.mesh.origins[triangle as usize][0];
        vertex::host(&self.mesh, from, place, predicates)
    }

    /// Inserts the point with number `point` at a place in the triangle with this number in the order of
    /// [`Region::new`]. Does nothing if a point is there already.
    ///
    /// Domain: as of [`Region::host`].
    ///
    /// Cost: O(k) for a way across k triangles: from the vertex before, if it is in the same triangle, or
    /// else from a corner. So points should follow each other closely.
    pub fn insert(&mut self, point: u32, place: Point2, triangle: u32, predicates: &mut impl Predicates2) {
        let last = self.last.filter(|&[other, _]| other == triangle);
        let from = last.map_or(self.mesh.origins[triangle as usize][0], |[_, vertex]| vertex);
        if let Some(vertex) = vertex::insert(&mut self.mesh, from, point, place, predicates) {
            self.last = Some([triangle, vertex]);
        }
    }

    /// Makes the parts of a segment edges that go from some of the points `on`, which all lie on it, towards
    /// its second end. A part goes up to the next point on the segment. Parts that leave the region before
    /// are left out; returns whether there is one.
    ///
    /// Cost: O(k log k) expected for a part that crosses k triangles.
    ///
    /// # Errors
    /// Runtime, if the segment crosses another one.
    pub fn constrain(
        &mut self,
        segment: u32,
        to: Point2,
        on: &[u32],
        predicates: &mut impl Predicates2,
    ) -> Result<bool> {
        let mut leaves = false;
        for &point in on {
            let copies = self.mesh.copies(point);
            for vertex in copies {
                leaves |= chord::insert(&mut self.mesh, vertex, to, segment, predicates)?;
            }
        }
        Ok(leaves)
    }

    /// Whether the straight way from a point to a place where there is none stays in the region, and meets
    /// neither a point nor a segment.
    pub fn sees(&self, point: u32, place: Point2, predicates: &mut impl Predicates2) -> bool {
        let is_free = |side: &Side| self.mesh.triangle(side.triangle).segments[side.place] == NONE;
        self.mesh.copies(point).into_iter().any(|vertex| {
            let (walk, end) = walk::walk(&self.mesh, vertex, place, predicates);
            walk.crossed.iter().all(is_free)
                && match end {
                    walk::End::Inside(_) => true,
                    walk::End::On(side) => is_free(&side),
                    walk::End::Vertex(_) | walk::End::Border(_) => false,
                }
        })
    }

    /// The sides on the border now.
    pub fn border(&self) -> impl Iterator<Item = BorderSide> + '_ {
        walk::border(&self.mesh).map(|(side, ends)| BorderSide { side, ends })
    }

    /// The triangles, numbered as in [`Region::pieces`], that a segment crosses which enters through a side
    /// of the border: up to the next vertex on it, or to the border.
    ///
    /// Domain: the segment crosses the side, and its first end is outside.
    pub fn crossed(
        &self,
        entry: &BorderSide,
        segment: [Point2; 2],
        predicates: &mut impl Predicates2,
    ) -> Vec<u32> {
        walk::from_border(&self.mesh, entry.side, segment, predicates)
    }

    /// The triangles now.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = Piece> + '_ {
        self.mesh.triangles.iter().map(|triangle| Piece {
            points: triangle.vertices.map(|vertex| self.mesh.vertices[vertex as usize].point),
            segments: triangle.segments.map(|segment| (segment != NONE).then_some(segment)),
        })
    }
}
