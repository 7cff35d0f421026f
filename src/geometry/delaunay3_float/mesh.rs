//! The tetrahedra of a triangulated 3-sphere: those of the points, and infinite ones at the faraway point.

use super::check;
use super::sphere::{Sphere, orientation};
use crate::delaunay3::{Corner, NONE, Tetrahedron, Vertex};
use crate::order::Insertions;
use crate::predicates::{Point3, Sign};

/// The faraway point (thesis 4.3), never the first vertex of a tetrahedron.
pub(super) const FARAWAY: u32 = u32::MAX;

/// In place of the first vertex of a tetrahedron that is no longer there.
const DELETED: u32 = u32::MAX;

/// The corners of the facet opposite to each corner, such that a tetrahedron of a point on the inner side, followed
/// by these three, is positively oriented.
pub(super) const FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

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

/// A tetrahedron: its vertices, positively oriented, and for each facet the same one as that of the other tetrahedron.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Cell {
    pub(super) vertices: [u32; 4],
    pub(super) across: [Facet; 4],
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
    pub(super) cells: Vec<Cell>,
    /// Of each tetrahedron, if they are kept.
    spheres: Option<Vec<Sphere>>,
    /// Tetrahedra that are not there.
    free: Vec<u32>,
}

impl<'a> Mesh<'a> {
    /// A positively oriented tetrahedron, and the four infinite ones around it.
    pub(super) fn new(vertices: &'a [Vertex], first: [u32; 4], keep_spheres: bool) -> Mesh<'a> {
        let mut mesh =
            Mesh { vertices, cells: Vec::new(), spheres: keep_spheres.then(Vec::new), free: Vec::new() };
        let around = FACETS.map(|corners| {
            let [a, b, c] = corners.map(|corner| first[corner]);
            [a, FARAWAY, b, c]
        });
        for corners in std::iter::once(first).chain(around) {
            let slot = mesh.slot().expect("five are not too many");
            mesh.write(slot, Cell { vertices: corners, across: [0; 4] }, &sphere_of(vertices, &corners));
        }
        mesh.link_all();
        mesh
    }

    /// Links all facets by comparing all with all: for a few tetrahedra.
    fn link_all(&mut self) {
        let vertices = |cells: &[Cell], facet: Facet| {
            let mut vertices = cells[tetrahedron_of(facet) as usize].vertices;
            vertices[corner_of(facet)] = 0;
            let mut vertices = FACETS[corner_of(facet)].map(|corner| vertices[corner]);
            vertices.sort_unstable();
            vertices
        };
        let facets = 0..4 * self.cells.len() as u32;
        for facet in facets.clone() {
            let wanted = vertices(&self.cells, facet);
            let other =
                facets.clone().find(|&other| other != facet && vertices(&self.cells, other) == wanted);
            self.cells[tetrahedron_of(facet) as usize].across[corner_of(facet)] =
                other.expect("every facet is one of two tetrahedra");
        }
    }

    /// Room for a tetrahedron, none if there are too many.
    #[inline(always)]
    pub(super) fn slot(&mut self) -> Option<u32> {
        if let Some(slot) = self.free.pop() {
            return Some(slot);
        }
        if self.cells.len() >= MAX_TETRAHEDRA {
            return None;
        }
        self.cells.push(Cell { vertices: [DELETED; 4], across: [0; 4] });
        if let Some(spheres) = &mut self.spheres {
            spheres.push(Sphere::NONE);
        }
        Some(self.cells.len() as u32 - 1)
    }

    /// Writes a tetrahedron with its sphere.
    #[inline(always)]
    pub(super) fn write(&mut self, slot: u32, cell: Cell, sphere: &Sphere) {
        self.cells[slot as usize] = cell;
        if let Some(spheres) = &mut self.spheres {
            spheres[slot as usize] = *sphere;
        }
    }

    /// Deletes a tetrahedron.
    pub(super) fn delete(&mut self, slot: u32) {
        self.cells[slot as usize].vertices = [DELETED; 4];
        self.free.push(slot);
    }

    #[inline(always)]
    pub(super) fn across(&self, t: u32, side: usize) -> Facet {
        self.cells[t as usize].across[side]
    }

    /// Links the facet of a tetrahedron to the other side, in this direction.
    #[inline(always)]
    pub(super) fn set_across(&mut self, from: Facet, to: Facet) {
        self.cells[tetrahedron_of(from) as usize].across[corner_of(from)] = to;
    }

    /// The sphere of a tetrahedron, and the point that its equation is relative to.
    #[inline(always)]
    pub(super) fn sphere(&self, t: u32) -> (Sphere, Point3) {
        let corners = &self.cells[t as usize].vertices;
        let origin = self.vertices[corners[0] as usize].at;
        match &self.spheres {
            Some(spheres) => (spheres[t as usize], origin),
            None => (sphere_of(self.vertices, corners), origin),
        }
    }

    /// Whether `p` is strictly on the outer side of a facet of a finite tetrahedron.
    #[inline(always)]
    pub(super) fn is_beyond(&self, t: u32, side: usize, p: Point3) -> bool {
        let [a, b, c] =
            FACETS[side].map(|corner| self.vertices[self.cells[t as usize].vertices[corner] as usize].at);
        orientation(p, a, b, c) < 0.0
    }

    /// Whether a tetrahedron is there, and not infinite.
    pub(super) fn is_finite(&self, t: u32) -> bool {
        let vertices = &self.cells[t as usize].vertices;
        vertices[0] != DELETED && faraway_corner(vertices).is_none()
    }

    /// The finite tetrahedron on the other side of the facet of the hull of an infinite one.
    pub(super) fn beside_faraway(&self, t: u32) -> u32 {
        let corner = faraway_corner(&self.cells[t as usize].vertices).unwrap_or_default();
        tetrahedron_of(self.across(t, corner))
    }

    /// Bytes in use.
    pub(super) fn bytes(&self) -> usize {
        let spheres = self.spheres.as_ref().map_or(0, |spheres| size_of::<Sphere>() * spheres.capacity());
        size_of::<Cell>() * self.cells.capacity() + spheres + size_of::<u32>() * self.free.capacity()
    }

    /// The finite tetrahedra, numbered anew.
    pub(super) fn finite(&mut self) -> Vec<Tetrahedron> {
        self.spheres = None;
        let count = self.cells.len() as u32;
        let mut numbers = vec![NONE; self.cells.len()];
        for (number, t) in (0..).zip((0..count).filter(|&t| self.is_finite(t))) {
            numbers[t as usize] = number;
        }
        let across = |facet: Facet| {
            let tetrahedron = numbers[tetrahedron_of(facet) as usize];
            (tetrahedron != NONE).then_some(Corner { tetrahedron, corner: corner_of(facet) as u32 })
        };
        let cells = self.cells.iter().zip(&numbers).filter(|(_, number)| **number != NONE);
        cells.map(|(cell, _)| Tetrahedron::new(cell.vertices, cell.across.map(across))).collect()
    }
}

/// Four vertices, positively oriented for exact arithmetic and for rounded arithmetic; none if all are in a plane.
///
/// The first to be inserted, the second, the first that is not collinear with them, the first after that that is not
/// coplanar.
pub(super) fn first_tetrahedron(vertices: &[Vertex], mut insertions: Insertions) -> Option<[u32; 4]> {
    let at = |v: u32| vertices[v as usize].at;
    let (a, b) = (insertions.next()?, insertions.next()?);
    let c = insertions.find(|&v| !check::are_collinear(at(a), at(b), at(v)))?;
    let is_positive = |a, b, c, d| {
        check::orient3d(at(a), at(b), at(c), at(d)) == Sign::Positive
            && orientation(at(a), at(b), at(c), at(d)) > 0.0
    };
    insertions.flat_map(|d| [[a, b, c, d], [b, a, c, d]]).find(|&[a, b, c, d]| is_positive(a, b, c, d))
}
