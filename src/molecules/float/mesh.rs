//! The tetrahedra of a triangulated 3-sphere: those of the points, and infinite ones at the faraway point.

use super::sphere::{Sphere, orientation};
use spmesh_delaunay::delaunay3::{self, Corner, NONE, Vertex};
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;

/// The faraway point (thesis 4.3), never the first vertex of a tetrahedron.
pub(super) const FARAWAY: u32 = u32::MAX;

/// Stands for each vertex of a deleted tetrahedron.
const DELETED: u32 = u32::MAX;

/// A facet of a tetrahedron, `tetrahedron * 4 + corner` with the opposite corner.
pub(super) type Facet = u32;

/// Greatest number of tetrahedra: the words of the result are eight times as great.
pub(super) const MAX_TETRAHEDRA: usize = 1 << 29;

#[inline(always)]
pub(super) fn facet(tetrahedron: u32, corner: usize) -> Facet {
    tetrahedron * 4 + corner as u32
}

#[inline(always)]
pub(super) fn tetrahedron_of(facet: Facet) -> u32 {
    facet / 4
}

#[inline(always)]
pub(super) fn corner_of(facet: Facet) -> usize {
    (facet & 3) as usize
}

/// A tetrahedron: its vertices, positively oriented, and for each facet the same facet of the neighbouring
/// tetrahedron.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Tetrahedron {
    pub(super) vertices: [u32; 4],
    pub(super) neighbours: [Facet; 4],
}

/// The corner at the faraway point.
#[inline(always)]
pub(super) fn faraway_corner(vertices: &[u32; 4]) -> Option<usize> {
    (1..4).find(|&corner| vertices[corner] == FARAWAY)
}

/// The other corners, such that these followed by one beyond their facet of the hull are positively oriented.
#[inline(always)]
pub(super) fn finite_facet(faraway_corner: usize) -> [usize; 3] {
    [0, 1 + faraway_corner % 3, 1 + (faraway_corner + 1) % 3]
}

/// Sphere of a tetrahedron, or the half-space that its sphere at the faraway point comes to.
#[inline(always)]
pub(super) fn sphere_of(vertices: &[Vertex], corners: &[u32; 4]) -> Sphere {
    let point = |corner: usize| vertices[corners[corner] as usize].at;
    match faraway_corner(corners) {
        None => Sphere::through(point(0), point(1), point(2), point(3)),
        Some(corner) => {
            let [o, a, b] = finite_facet(corner).map(point);
            Sphere::beyond(o, a, b)
        }
    }
}

/// Points and tetrahedra.
#[derive(Debug)]
pub(super) struct Mesh<'a> {
    pub(super) vertices: &'a [Vertex],
    pub(super) tetrahedra: Vec<Tetrahedron>,
    /// Of each tetrahedron, if they are kept.
    spheres: Option<Vec<Sphere>>,
    /// Deleted tetrahedra.
    free: Vec<u32>,
}

impl<'a> Mesh<'a> {
    /// A positively oriented tetrahedron, and the four infinite ones around it.
    pub(super) fn new(vertices: &'a [Vertex], first: [u32; 4], keep_spheres: bool) -> Mesh<'a> {
        let mut mesh =
            Mesh { vertices, tetrahedra: Vec::new(), spheres: keep_spheres.then(Vec::new), free: Vec::new() };
        let around = TETRAHEDRON_FACETS.map(|corners| {
            let [a, b, c] = corners.map(|corner| first[corner]);
            [a, FARAWAY, b, c]
        });
        for corners in std::iter::once(first).chain(around) {
            let slot = mesh.slot().expect("five are not too many");
            mesh.write(
                slot,
                Tetrahedron { vertices: corners, neighbours: [0; 4] },
                &sphere_of(vertices, &corners),
            );
        }
        mesh.link_all();
        mesh
    }

    /// Links all facets by comparing all with all: for a few tetrahedra.
    fn link_all(&mut self) {
        let vertices = |tetrahedra: &[Tetrahedron], facet: Facet| {
            let mut vertices = tetrahedra[tetrahedron_of(facet) as usize].vertices;
            vertices[corner_of(facet)] = 0;
            let mut vertices = TETRAHEDRON_FACETS[corner_of(facet)].map(|corner| vertices[corner]);
            vertices.sort_unstable();
            vertices
        };
        let facets = 0..4 * self.tetrahedra.len() as u32;
        for facet in facets.clone() {
            let wanted = vertices(&self.tetrahedra, facet);
            let other =
                facets.clone().find(|&other| other != facet && vertices(&self.tetrahedra, other) == wanted);
            self.tetrahedra[tetrahedron_of(facet) as usize].neighbours[corner_of(facet)] =
                other.expect("every facet is one of two tetrahedra");
        }
    }

    /// The place of a new tetrahedron; `None` if there are too many.
    #[inline(always)]
    pub(super) fn slot(&mut self) -> Option<u32> {
        if let Some(slot) = self.free.pop() {
            return Some(slot);
        }
        if self.tetrahedra.len() >= MAX_TETRAHEDRA {
            return None;
        }
        self.tetrahedra.push(Tetrahedron { vertices: [DELETED; 4], neighbours: [0; 4] });
        if let Some(spheres) = &mut self.spheres {
            spheres.push(Sphere::NONE);
        }
        Some(self.tetrahedra.len() as u32 - 1)
    }

    #[inline(always)]
    pub(super) fn write(&mut self, slot: u32, tetrahedron: Tetrahedron, sphere: &Sphere) {
        self.tetrahedra[slot as usize] = tetrahedron;
        if let Some(spheres) = &mut self.spheres {
            spheres[slot as usize] = *sphere;
        }
    }

    /// Deletes a tetrahedron.
    pub(super) fn delete(&mut self, slot: u32) {
        self.tetrahedra[slot as usize].vertices = [DELETED; 4];
        self.free.push(slot);
    }

    #[inline(always)]
    pub(super) fn neighbour(&self, t: u32, side: usize) -> Facet {
        self.tetrahedra[t as usize].neighbours[side]
    }

    /// Links the facet of a tetrahedron to the other side, in this direction.
    #[inline(always)]
    pub(super) fn set_neighbour(&mut self, from: Facet, to: Facet) {
        self.tetrahedra[tetrahedron_of(from) as usize].neighbours[corner_of(from)] = to;
    }

    /// The sphere of a tetrahedron, and the point that its equation is relative to.
    #[inline(always)]
    pub(super) fn sphere(&self, t: u32) -> (Sphere, Point3) {
        let corners = &self.tetrahedra[t as usize].vertices;
        let origin = self.vertices[corners[0] as usize].at;
        match &self.spheres {
            Some(spheres) => (spheres[t as usize], origin),
            None => (sphere_of(self.vertices, corners), origin),
        }
    }

    /// Whether `p` is strictly on the outer side of a facet of a finite tetrahedron.
    #[inline(always)]
    pub(super) fn is_beyond(&self, t: u32, side: usize, p: Point3) -> bool {
        let [a, b, c] = TETRAHEDRON_FACETS[side]
            .map(|corner| self.vertices[self.tetrahedra[t as usize].vertices[corner] as usize].at);
        orientation(p, a, b, c) < 0.0
    }

    /// Whether a tetrahedron is finite and not deleted.
    pub(super) fn is_finite(&self, t: u32) -> bool {
        let vertices = &self.tetrahedra[t as usize].vertices;
        vertices[0] != DELETED && faraway_corner(vertices).is_none()
    }

    /// The finite tetrahedron on the other side of the facet of the hull of an infinite one.
    pub(super) fn beside_faraway(&self, t: u32) -> u32 {
        let corner = faraway_corner(&self.tetrahedra[t as usize].vertices).unwrap_or_default();
        tetrahedron_of(self.neighbour(t, corner))
    }

    /// Bytes in use.
    pub(super) fn bytes(&self) -> usize {
        let spheres = self.spheres.as_ref().map_or(0, |spheres| size_of::<Sphere>() * spheres.capacity());
        size_of::<Tetrahedron>() * self.tetrahedra.capacity()
            + spheres
            + size_of::<u32>() * self.free.capacity()
    }

    /// The finite tetrahedra, numbered anew.
    pub(super) fn finite(&mut self) -> Vec<delaunay3::Tetrahedron> {
        self.spheres = None;
        let count = self.tetrahedra.len() as u32;
        let mut numbers = vec![NONE; self.tetrahedra.len()];
        for (number, t) in (0..).zip((0..count).filter(|&t| self.is_finite(t))) {
            numbers[t as usize] = number;
        }
        let neighbour = |facet: Facet| {
            let tetrahedron = numbers[tetrahedron_of(facet) as usize];
            (tetrahedron != NONE).then_some(Corner { tetrahedron, corner: corner_of(facet) as u32 })
        };
        let finite = self.tetrahedra.iter().zip(&numbers).filter(|(_, number)| **number != NONE);
        finite.map(|(t, _)| delaunay3::Tetrahedron::new(t.vertices, t.neighbours.map(neighbour))).collect()
    }
}
