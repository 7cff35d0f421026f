//! The order in which points are inserted (thesis 3.4.1): levels of common low bits, and a curve within each
//! level.

use super::options::Options;
use spmesh_delaunay::delaunay3::Vertex;
use spmesh_delaunay::order::{Insertions, SpatialOrder, Suffixes};
use spmesh_delaunay::predicates::{Extent, Point3};

/// Distinct points, and what was found when they were put in order.
pub(super) struct Sorted {
    /// In order along the curve.
    pub(super) vertices: Vec<Vertex>,
    /// Indices of other points, with those of their equals.
    pub(super) duplicates: Vec<[u32; 2]>,
    /// The vertices as they are to be inserted.
    pub(super) insertions: Insertions,
}

/// Puts points in order. Domain: finite coordinates, whose extent is `extent`.
pub(super) fn sort(points: &[Point3], extent: &Extent<3>, options: &Options) -> Sorted {
    let mut vertices: Vec<Vertex> = Vec::with_capacity(points.len());
    let mut duplicates = Vec::new();
    for index in SpatialOrder::default().sort(points, extent, options.curve) {
        let at = points[index as usize];
        match vertices.last() {
            Some(last) if last.at == at => duplicates.push([index, last.index]),
            _ => vertices.push(Vertex::new(at, index)),
        }
    }
    let insertions = if options.by_bit_levels {
        let points: Vec<Point3> = vertices.iter().map(|vertex| vertex.at).collect();
        options.sequence.by_levels(&points, Suffixes::MostCommon)
    } else {
        options.sequence.of(vertices.len())
    };
    Sorted { vertices, duplicates, insertions }
}
