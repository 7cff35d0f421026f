//! Questions to a tetrahedralization, answered in indices of input points.

use super::tetrahedralization::{Tetrahedralization, Tetrahedron};
use crate::location::Location;
use crate::predicates::{FiniteFloatPredicates3, Point3, Predicates3, Sign};
use crate::simplex::TETRAHEDRON_FACETS;

impl Tetrahedralization {
    fn input_indices<const N: usize>(&self, vertices: [u32; N]) -> [u32; N] {
        vertices.map(|v| self.vertices[v as usize].index)
    }

    /// The tetrahedra by the indices of their points, positively oriented. Their numbers are those of
    /// [`Tetrahedralization::neighbours`].
    pub fn simplices(&self) -> impl ExactSizeIterator<Item = [u32; 4]> + '_ {
        self.tetrahedra.iter().map(|tetrahedron| self.input_indices(tetrahedron.vertices))
    }

    /// The tetrahedra across the facets opposite to the four vertices of tetrahedron `number`; `None` at the
    /// hull.
    ///
    /// # Panics
    /// If there is no such tetrahedron.
    pub fn neighbours(&self, number: u32) -> [Option<u32>; 4] {
        let tetrahedron = &self.tetrahedra[number as usize];
        [0, 1, 2, 3].map(|side| tetrahedron.neighbour(side).map(|corner| corner.tetrahedron))
    }

    /// The edges of all tetrahedra, each once with its lesser point first, in increasing order.
    ///
    /// Cost: a sort of six edges per tetrahedron.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let sides = |[a, b, c, d]: [u32; 4]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
        let mut edges: Vec<[u32; 2]> =
            self.simplices().flat_map(sides).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The facets of the hull, counterclockwise as seen from outside; none if there are no tetrahedra.
    pub fn hull(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let open = |tetrahedron: &Tetrahedron, side: usize| tetrahedron.neighbour(side).is_none();
        self.tetrahedra.iter().flat_map(move |tetrahedron| {
            let sides = (0..4).filter(move |&side| open(tetrahedron, side));
            sides.map(|side| self.input_indices(TETRAHEDRON_FACETS[side].map(|i| tetrahedron.vertices[i])))
        })
    }

    /// For each input point the one that stands for it: the equal point of least index.
    pub fn representatives(&self) -> Vec<u32> {
        let count = self.vertices.len() + self.duplicates.len();
        let mut representatives: Vec<u32> = (0..count as u32).collect();
        self.duplicates.iter().for_each(|&[point, vertex]| representatives[point as usize] = vertex);
        representatives
    }

    /// Where `target` lies: exactly. A target with a coordinate that is not finite is outside.
    ///
    /// If there are no tetrahedra, every target that is no vertex is outside.
    ///
    /// Cost: a walk of O(cbrt n) tetrahedra for points that are spread evenly; without tetrahedra, O(n).
    pub fn locate(&self, target: Point3) -> Location {
        if !target.iter().all(|coordinate| coordinate.is_finite()) {
            return Location::Outside;
        }
        if self.tetrahedra.is_empty() {
            let found = self.vertices.iter().find(|vertex| vertex.at == target);
            return found.map_or(Location::Outside, |vertex| Location::Vertex(vertex.index));
        }
        let mut predicates = FiniteFloatPredicates3::default();
        let mut number = 0;
        // In a Delaunay tetrahedralization this walk meets no tetrahedron twice.
        loop {
            let tetrahedron = &self.tetrahedra[number as usize];
            let signs = TETRAHEDRON_FACETS.map(|facet| {
                let [a, b, c] = facet.map(|i| self.vertices[tetrahedron.vertices[i] as usize].at);
                predicates.orient3d(target, a, b, c)
            });
            let Some(side) = signs.iter().position(|&sign| sign == Sign::Negative) else {
                return Location::in_simplex(number, self.input_indices(tetrahedron.vertices), signs);
            };
            match tetrahedron.neighbour(side) {
                Some(corner) => number = corner.tetrahedron,
                None => return Location::Outside,
            }
        }
    }
}
