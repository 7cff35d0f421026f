//! Turns centroid triangulations of repeated knots into meshes without degenerate triangles, which all
//! programs accept.

use super::centroids::{CentroidMesh, centroid};
use super::knots::Knots;
use foldhash::{HashMap, HashMapExt};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};

impl CentroidMesh {
    /// The same mesh with one vertex for all sets with the same places, and without flat triangles.
    ///
    /// Triangles whose boundary has two knots at one place shrink to edges, and their neighbours become
    /// adjacent. Other flat triangles have knots on a line, some of them moved symbolically. They lie on the
    /// border: inside the mesh, other triangles would end in the middle of an edge.
    pub fn without_flat(&self, knots: &Knots) -> CentroidMesh {
        let mut predicates = FiniteFloatPredicates::default();
        let firsts = distinct(knots.points());
        let mut numbers: HashMap<Vec<u32>, u32> = HashMap::new();
        let mut merged = CentroidMesh { order: self.order(), ..CentroidMesh::default() };
        for (number, corners) in self.triangles.iter().enumerate() {
            let different = self.different(*corners).map(|id| knots.at(id));
            let [a, b, c] = different;
            if predicates.orient2d(a, b, c) == Sign::Zero {
                continue;
            }
            merged.from_upper += usize::from(number < self.from_upper);
            let vertices = corners.map(|corner| {
                let mut places: Vec<u32> = self.set(corner).iter().map(|&id| firsts[id as usize]).collect();
                places.sort_unstable();
                *numbers.entry(places).or_insert_with(|| {
                    merged.sets.extend_from_slice(self.set(corner));
                    merged.vertices.push(centroid(knots, self.set(corner)));
                    merged.vertices.len() as u32 - 1
                })
            });
            merged.triangles.push(vertices);
        }
        merged
    }

    /// The three knots of the boundary that a triangle comes from: the knots that are not in all three sets.
    fn different(&self, corners: [u32; 3]) -> [u32; 3] {
        let [first, second, third] = corners.map(|corner| self.set(corner));
        let lacks = |set: &[u32], id: &u32| set.binary_search(id).is_err();
        let all = first.iter().filter(|id| lacks(second, id) || lacks(third, id));
        let others = second.iter().filter(|id| lacks(first, id));
        let rest = third.iter().filter(|id| lacks(first, id) && lacks(second, id));
        let mut found = all.chain(others).chain(rest).copied();
        std::array::from_fn(|_| found.next().expect("sets of a triangle differ by three knots"))
    }
}
