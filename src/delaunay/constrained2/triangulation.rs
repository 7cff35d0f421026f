//! Constrained Delaunay triangulations of whole sets of points.

use super::mesh::{Mesh, NONE};
use super::vertex::{At, locate};
use super::{Region, chord};
use crate::delaunay2::triangulate;
use crate::error::{Error, Result};
use crate::location::Location;
use crate::noding::{LineVertex, NodingOptions, node_lines};
use crate::points::{Point2, is_finite};
use crate::predicates::{Extent, FiniteFloatPredicates};
use crate::starts::Starts;
use std::sync::OnceLock;

/// The constrained Delaunay triangulation of points and segments: each segment is a union of edges, and no
/// vertex that an open triangle sees is in its circle. It covers the convex hull of the points, and is
/// unique: ties on circles are broken by the canonical perturbation.
///
/// Vertices are indices of the input points, segments those of the input segments.
///
/// ```
/// use spmesh_delaunay::Location;
/// use spmesh_delaunay::constrained2::ConstrainedTriangulation;
///
/// // Without the segment, the shorter diagonal from point 1 to point 3 is the edge.
/// let points = [[0.0, 0.0], [3.0, -1.0], [6.0, 0.0], [3.0, 1.0]];
/// let mesh = ConstrainedTriangulation::new(&points, &[[0, 2]])?;
/// assert_eq!(mesh.simplices().count(), 2);
/// assert_eq!(mesh.constrained_edges().collect::<Vec<_>>(), [([0, 2], 0)]);
/// assert_eq!(mesh.locate([4.0, 0.0]), Location::Edge([0, 2]));
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ConstrainedTriangulation {
    points: Vec<Point2>,
    representatives: Vec<u32>,
    pub(super) mesh: Mesh,
    /// Vertices where walks start, found with the first question.
    starts: OnceLock<Starts<2>>,
}

impl ConstrainedTriangulation {
    /// Triangulates points with fewer than 2^32 - 1 segments, each between two of them by their indices.
    ///
    /// A segment that passes through a point is divided there. Segments may meet at points and overlap; a
    /// segment between equal points constrains nothing. If all points are on one line, there are no
    /// triangles.
    ///
    /// # Errors
    /// If segments cross where there is no point: [`Error::Crossing`] has the ends of an edge of one of them.
    /// [`ConstrainedTriangulation::noded`] divides such segments. If a segment has an end that is no point, a
    /// coordinate is not finite, or there are too many points.
    ///
    /// Cost: that of [`triangulate`], and O(k log k) expected for a segment that crosses k triangles; about
    /// 150 bytes for each point.
    pub fn new(points: &[Point2], segments: &[[u32; 2]]) -> Result<ConstrainedTriangulation> {
        let is_bad = |ends: &[u32; 2]| ends.iter().any(|&end| end as usize >= points.len());
        if let Some(segment) = segments.iter().position(is_bad) {
            return Err(Error::NoSuchPoint { segment, ends: segments[segment] });
        }
        let whole = triangulate(points)?;
        let representatives = whole.representatives();
        let triangles: Vec<[u32; 3]> = whole.simplices().collect();
        drop(whole);
        let mut mesh = Region::new(points, &triangles).mesh;
        mesh.origins = Vec::new();
        let mut predicates = FiniteFloatPredicates::default();
        // Of segments that overlap the first remains the one that the edges are on: it comes last.
        for (segment, &ends) in segments.iter().enumerate().rev() {
            if mesh.triangles.is_empty() {
                break;
            }
            // Each point of a convex region is one vertex.
            let vertices = ends.map(|end| mesh.copies(representatives[end as usize])[0]);
            chord::insert_whole(&mut mesh, vertices, segment as u32, &mut predicates)?;
        }
        let starts = OnceLock::new();
        Ok(ConstrainedTriangulation { points: points.to_vec(), representatives, mesh, starts })
    }

    /// Triangulates points of a grid of integers with segments that may cross. These are noded by snap
    /// rounding ([`node_lines`]): crossings become the places of the grid that are nearest, and segments bend
    /// to places that they pass within half a step of the grid. So coordinates are first scaled to a grid
    /// that is as fine as crossings are to be.
    ///
    /// The points of the result are the places and those of crossings, all different and in lexicographic
    /// order. Edges that several segments share are on the one of least index.
    ///
    /// # Errors
    /// If a segment has an end that is no point, a coordinate exceeds
    /// [`COORDINATE_MAX`](crate::noding::COORDINATE_MAX), or there are more than `crossings_max` crossings.
    pub fn noded(
        places: &[[i64; 2]],
        segments: &[[u32; 2]],
        crossings_max: usize,
    ) -> Result<ConstrainedTriangulation> {
        let at = |end: u32| places.get(end as usize).map(|&place| LineVertex { place, z: None });
        let mut vertices = Vec::with_capacity(2 * segments.len() + places.len());
        for (segment, &ends) in segments.iter().enumerate() {
            let [Some(from), Some(to)] = ends.map(at) else {
                return Err(Error::NoSuchPoint { segment, ends });
            };
            vertices.extend([from, to]);
        }
        let mut starts: Vec<u32> = (0..segments.len() as u32).map(|line| 2 * line).collect();
        // Points are lines of one place.
        starts.extend((vertices.len() as u32..).take(places.len()));
        vertices.extend(places.iter().map(|&place| LineVertex { place, z: None }));
        let options = NodingOptions { round_elevations: false, crossings_max, bytes_max: u64::MAX };
        let noded = node_lines(vertices.into(), &starts, &options, &mut |_, _, _| ())?;
        let points: Vec<Point2> =
            noded.vertices.iter().map(|vertex| vertex.place.map(|c| c as f64)).collect();
        let ends: Vec<[u32; 2]> = noded.segments.iter().map(|segment| segment.ends).collect();
        let mut made = ConstrainedTriangulation::new(&points, &ends)?;
        for segment in made.mesh.triangles.iter_mut().flat_map(|triangle| &mut triangle.segments) {
            if *segment != NONE {
                *segment = noded.segments[*segment as usize].line;
            }
        }
        Ok(made)
    }

    /// The points, duplicates included.
    pub fn points(&self) -> &[Point2] {
        &self.points
    }

    /// For each point the vertex that stands for it: the equal point of least index.
    pub fn representatives(&self) -> &[u32] {
        &self.representatives
    }

    /// The triangles by their vertices, counterclockwise. Their numbers are their places in this order.
    pub fn simplices(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        self.mesh.triangles.iter().map(|triangle| self.points_of(triangle.vertices))
    }

    /// The triangles across the edges opposite to the three vertices of triangle `number`; `None` at the
    /// hull.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn neighbours(&self, number: u32) -> [Option<u32>; 3] {
        self.mesh.triangle(number).neighbours.map(|neighbour| (neighbour != NONE).then_some(neighbour))
    }

    /// The segments that the edges opposite to the three vertices of triangle `number` are on: the first one
    /// of those that overlap.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn segments(&self, number: u32) -> [Option<u32>; 3] {
        self.mesh.triangle(number).segments.map(|segment| (segment != NONE).then_some(segment))
    }

    /// The edges on segments, each once with its lesser vertex first, and the segment.
    pub fn constrained_edges(&self) -> impl Iterator<Item = ([u32; 2], u32)> + '_ {
        (0..).zip(&self.mesh.triangles).flat_map(move |(number, triangle)| {
            // The triangle of greater number names the edge, or the only one.
            let is_named = move |&side: &usize| {
                let neighbour = triangle.neighbours[side];
                triangle.segments[side] != NONE && (neighbour == NONE || neighbour < number)
            };
            (0..3).filter(is_named).map(move |side| {
                let [_, a, b] = self.points_of([0, 1, 2].map(|turn| triangle.vertices[(side + turn) % 3]));
                ([a.min(b), a.max(b)], triangle.segments[side])
            })
        })
    }

    /// Where `target` lies: exactly. A target with a coordinate that is not finite is outside.
    ///
    /// If there are no triangles, every target that is no vertex is outside.
    ///
    /// Cost: a straight walk from the nearest of many vertices, which the first call sorts; without
    /// triangles, O(n).
    pub fn locate(&self, target: Point2) -> Location {
        if !is_finite(&target) {
            return Location::Outside;
        }
        if self.mesh.triangles.is_empty() {
            let found = self.points.iter().position(|&point| point == target);
            return found.map_or(Location::Outside, |point| Location::Vertex(point as u32));
        }
        let starts = self.starts.get_or_init(|| {
            let place = |vertex: u32| self.mesh.place(vertex);
            Starts::new(self.mesh.vertices.len(), &Extent::of(&self.points), place)
        });
        let start = starts.near(target);
        match locate(&self.mesh, start, target, &mut FiniteFloatPredicates::default()) {
            None => Location::Outside,
            Some(At::Inside(number)) => Location::Simplex(number),
            Some(At::Vertex(vertex)) => Location::Vertex(self.mesh.vertices[vertex as usize].point),
            Some(At::On(side)) => {
                let vertices = self.mesh.triangle(side.triangle).vertices;
                let [_, a, b] = self.points_of([0, 1, 2].map(|turn| vertices[(side.place + turn) % 3]));
                Location::Edge([a.min(b), a.max(b)])
            }
        }
    }

    fn points_of(&self, vertices: [u32; 3]) -> [u32; 3] {
        vertices.map(|vertex| self.mesh.vertices[vertex as usize].point)
    }
}
