//! Libraries that make triangles, and answer no questions about them.

use super::Library;
use geo::{MultiPoint, TriangulateDelaunayUnconstrained};

/// A number of triangles, with what they are in, so that its end is not measured.
pub struct Built<T> {
    count: usize,
    _triangles: T,
}

impl<T> Library for Built<T> {
    fn triangles(&self) -> usize {
        self.count
    }
}

/// By `delaunator`.
pub fn delaunator(points: &[[f64; 3]]) -> Built<delaunator::Triangulation> {
    let points: Vec<_> = points.iter().map(|&[x, y, _]| delaunator::Point { x, y }).collect();
    let triangulation = delaunator::triangulate(&points);
    Built { count: triangulation.len(), _triangles: triangulation }
}

/// By `geo`, as triangles of coordinates.
pub fn geo(points: &[[f64; 3]]) -> Built<Vec<geo::Triangle>> {
    let points: MultiPoint = points.iter().map(|&[x, y, _]| (x, y)).collect();
    let triangles = points.unconstrained_triangulation().expect("finite points");
    Built { count: triangles.len(), _triangles: triangles }
}
