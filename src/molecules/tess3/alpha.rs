//! The alpha complex: which simplices have an empty circumscribed sphere that is small enough.
//!
//! A simplex of the triangulation belongs to the complex of radius R if a sphere of radius R or less passes
//! through all its vertices and has no point inside. Its least circumscribed sphere has its centre in the
//! flat that the simplex spans. If no point lies inside that sphere (a Gabriel simplex), the radius of the
//! sphere decides. Otherwise the smallest empty sphere of the simplex is also the smallest empty sphere of a
//! coface with one more vertex, and the simplex belongs to the complex if one of these cofaces does. A
//! tetrahedron has one sphere only. For a simplex of the triangulation, the adjacent vertices decide whether
//! its least sphere is empty. Points on a sphere are not inside it, and a radius of exactly R is small
//! enough; both are decided exactly, for R as written by the user.
//!
//! Source: Edelsbrunner and Mücke, "Three-dimensional alpha shapes", 1994.

use super::radius::Radius;
use super::spheres::{
    edge_fits, is_in_sphere_of_edge, is_in_sphere_of_triangle, tetrahedron_fits, triangle_fits,
};
use spmesh_delaunay::delaunay3::{Ring, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;

/// An alpha complex of a tetrahedralization.
#[derive(Debug)]
pub struct AlphaComplex<'m> {
    mesh: &'m Tetrahedralization,
    /// In the unit of the mesh's coordinates.
    radius: Radius,
    /// A bit per tetrahedron: whether it belongs to the complex.
    tetrahedra: Vec<u64>,
}

impl<'m> AlphaComplex<'m> {
    /// The complex of a radius in the unit of the mesh's coordinates.
    ///
    /// Cost: a few sphere equations and one bit of memory per tetrahedron.
    pub fn new(mesh: &'m Tetrahedralization, radius: Radius) -> Self {
        let fits =
            |vertices: &[u32; 4]| tetrahedron_fits(vertices.map(|v| mesh.vertices()[v as usize].at), &radius);
        let tetrahedra = mesh
            .tetrahedra()
            .chunks(64)
            .map(|chunk| chunk.iter().rev().fold(0, |bits, t| bits << 1 | u64::from(fits(&t.vertices))));
        let tetrahedra = tetrahedra.collect();
        AlphaComplex { mesh, radius, tetrahedra }
    }

    /// Whether tetrahedron `t` belongs to the complex.
    #[inline]
    pub fn has_tetrahedron(&self, t: usize) -> bool {
        self.tetrahedra[t / 64] >> (t % 64) & 1 == 1
    }

    /// A bit for each tetrahedron: tetrahedron `t` has bit `t % 64` of word `t / 64`.
    pub fn into_bits(self) -> Vec<u64> {
        self.tetrahedra
    }

    /// Number of tetrahedra of the complex.
    pub fn tetrahedra(&self) -> u64 {
        self.tetrahedra.iter().map(|bits| u64::from(bits.count_ones())).sum()
    }

    /// Whether an edge belongs to the complex, given its surroundings.
    pub(super) fn has_edge(&self, ring: &Ring) -> bool {
        let [a, b] = ring.ends.map(|v| self.point(v));
        if !edge_fits([a, b], &self.radius) {
            return false;
        }
        let is_inside = |&v: &u32| is_in_sphere_of_edge([a, b, self.point(v)], &self.radius);
        !ring.link.iter().any(is_inside)
            || ring.tetrahedra.iter().any(|&t| self.has_triangle_at(t, ring.ends))
    }

    /// Whether one of the two triangles of tetrahedron `t` at an edge belongs to the complex.
    fn has_triangle_at(&self, t: u32, edge: [u32; 2]) -> bool {
        let vertices = self.mesh.tetrahedra()[t as usize].vertices;
        let sides = (0..4).filter(|&side| !edge.contains(&vertices[side]));
        self.has_tetrahedron(t as usize) || sides.into_iter().any(|side| self.has_triangle(t, side))
    }

    /// Whether the triangle opposite to corner `side` of a tetrahedron belongs to the complex.
    fn has_triangle(&self, t: u32, side: usize) -> bool {
        let tetrahedron = &self.mesh.tetrahedra()[t as usize];
        let [a, b, c] = [1, 2, 3].map(|i| self.point(tetrahedron.vertices[(side + i) % 4]));
        if !triangle_fits([a, b, c], &self.radius) {
            return false;
        }
        let beyond = tetrahedron.neighbour(side);
        let other = beyond.map(|corner| {
            self.mesh.tetrahedra()[corner.tetrahedron as usize].vertices[corner.corner as usize]
        });
        let mut opposite = [Some(tetrahedron.vertices[side]), other].into_iter().flatten();
        let is_inside = |v: u32| is_in_sphere_of_triangle([a, b, c, self.point(v)], &self.radius);
        self.has_tetrahedron(t as usize)
            || beyond.is_some_and(|corner| self.has_tetrahedron(corner.tetrahedron as usize))
            || !opposite.any(is_inside)
    }

    fn point(&self, v: u32) -> Point3 {
        self.mesh.vertices()[v as usize].at
    }
}
