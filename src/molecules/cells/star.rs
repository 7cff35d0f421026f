//! One cell of the power diagram, from the tetrahedra around its site.
//!
//! The cell is the union of the cones over its faces, each with the site as apex; a face is a polygon whose
//! corners are the orthocentres of the tetrahedra around an edge. All is computed relative to the site, so it
//! does not depend on where the site is.

use super::lattice::Lattice;
use crate::balls::dual::orthocentre;
use crate::balls::face::Pair;
use foldhash::fast::FixedState;
use spmesh_delaunay::delaunay3::{NONE, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;
use spmesh_delaunay::vector::{cross, difference, dot};
use std::collections::HashMap;

/// Share of the surface of a cell below which a face is taken as empty: where more than four cells meet in a
/// point, rounding leaves something of faces that are points or edges.
const NOISE: f64 = 1e-12;

/// What orthocentres may be off by, as a share of radii; they are far more accurate.
const SLACK: f64 = 1e-6;

/// A face of the cell that was measured last.
#[derive(Debug, Clone, Copy)]
pub(super) struct StarFace {
    /// The vertex of the mesh beyond it.
    pub(super) vertex: u32,
    /// Infinite if it reaches to infinity.
    pub(super) area: f64,
    /// Signed distance of its plane from the site.
    height: f64,
}

/// A cell, measured; sums are infinite if it is unbounded.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Measure {
    pub(super) volume: f64,
    pub(super) area: f64,
    pub(super) faces: u32,
    /// Volume of all tetrahedra around the site.
    pub(super) star: f64,
}

/// How far beyond the box images can matter, in fractional coordinates along each axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Needed {
    pub(super) margins: Point3,
    /// Where a cell is open to infinity.
    pub(super) is_open: [bool; 3],
}

impl Needed {
    pub(super) fn add(&mut self, other: &Needed) {
        for axis in 0..3 {
            self.margins[axis] = self.margins[axis].max(other.margins[axis]);
            self.is_open[axis] |= other.is_open[axis];
        }
    }
}

/// Measures cells one after the other.
pub(super) struct Stars<'m> {
    mesh: &'m Tetrahedralization,
    /// For each input point its radius; empty if all are equal.
    radii: &'m [f64],
    /// The tetrahedra around the site, and their places in the list.
    tetrahedra: Vec<u32>,
    places: HashMap<u32, u32, FixedState>,
    /// Their orthocentres, relative to the site.
    centres: Vec<Point3>,
    /// For each vertex of the mesh its face of the current cell.
    slots: Vec<u32>,
    pairs: Vec<Pair>,
    faces: Vec<StarFace>,
}

impl<'m> Stars<'m> {
    pub(super) fn new(mesh: &'m Tetrahedralization, radii: &'m [f64]) -> Stars<'m> {
        Stars {
            mesh,
            radii,
            tetrahedra: Vec::new(),
            places: HashMap::default(),
            centres: Vec::new(),
            slots: vec![NONE; mesh.vertices().len()],
            pairs: Vec::new(),
            faces: Vec::new(),
        }
    }

    fn at(&self, v: u32) -> Point3 {
        self.mesh.vertices()[v as usize].at
    }

    fn radius(&self, v: u32) -> f64 {
        self.radii.get(self.mesh.vertices()[v as usize].index as usize).copied().unwrap_or(0.0)
    }

    /// Measures the cell of vertex `v`, which is a corner of tetrahedron `start`.
    pub(super) fn measure(&mut self, v: u32, start: u32) -> Measure {
        self.gather(v, start);
        self.faces.iter().for_each(|face| self.slots[face.vertex as usize] = NONE);
        self.faces.clear();
        self.pairs.clear();
        let star = (0..self.tetrahedra.len()).map(|place| self.add_tetrahedron(v, place)).sum();
        let area: f64 = self.faces.iter().map(|face| face.area).sum();
        let volume = self.faces.iter().map(|face| face.height * face.area).sum::<f64>() / 3.0;
        if !area.is_finite() {
            let faces = self.faces.len() as u32;
            return Measure { volume: f64::INFINITY, area: f64::INFINITY, faces, star };
        }
        self.faces.iter_mut().filter(|face| face.area <= NOISE * area).for_each(|face| face.area = 0.0);
        let faces = self.faces.iter().filter(|face| face.area > 0.0).count() as u32;
        // Rounding may leave less than nothing of a cell that is a point.
        Measure { volume: volume.max(0.0), area, faces, star }
    }

    /// The faces of the cell that was measured last. Those of no area are points or edges.
    pub(super) fn faces(&self) -> &[StarFace] {
        &self.faces
    }

    /// Finds all tetrahedra around a vertex, and their orthocentres.
    fn gather(&mut self, v: u32, start: u32) {
        self.tetrahedra.clear();
        self.places.clear();
        self.centres.clear();
        self.places.insert(start, 0);
        self.tetrahedra.push(start);
        let mut next = 0;
        while let Some(&t) = self.tetrahedra.get(next) {
            next += 1;
            let tetrahedron = &self.mesh.tetrahedra()[t as usize];
            let own = corner_of(&tetrahedron.vertices, v);
            let [a, b, c] = TETRAHEDRON_FACETS[own].map(|corner| tetrahedron.vertices[corner]);
            let corners = [v, a, b, c];
            let weights = corners.map(|u| self.radius(u).powi(2));
            self.centres.push(orthocentre(corners.map(|u| self.at(u)), weights).0);
            for side in (0..4).filter(|&side| side != own) {
                let Some(across) = tetrahedron.neighbour(side) else { continue };
                let place = self.tetrahedra.len() as u32;
                self.places.entry(across.tetrahedron).or_insert_with(|| {
                    self.tetrahedra.push(across.tetrahedron);
                    place
                });
            }
        }
    }

    /// Adds the sides of faces that are dual to the facets of a tetrahedron, those facets that no tetrahedron
    /// before has. Returns its volume.
    fn add_tetrahedron(&mut self, v: u32, place: usize) -> f64 {
        let tetrahedron = &self.mesh.tetrahedra()[self.tetrahedra[place] as usize];
        let others = TETRAHEDRON_FACETS[corner_of(&tetrahedron.vertices, v)];
        let vertices = others.map(|corner| tetrahedron.vertices[corner]);
        let slots = vertices.map(|u| self.slot(v, u));
        let to = vertices.map(|u| difference(self.at(u), self.at(v)));
        for i in 0..3 {
            // The facet of v and these two; the tetrahedron is to the right of the first, about the way from
            // v to it, and to the left of the second.
            let [j, k] = [(i + 1) % 3, (i + 2) % 3];
            let Some(across) = tetrahedron.neighbour(others[k]) else {
                [i, j].iter().for_each(|&end| self.faces[slots[end]].area = f64::INFINITY);
                continue;
            };
            let beyond = self.places[&across.tetrahedron] as usize;
            if beyond > place {
                let ends = [self.centres[beyond], self.centres[place]];
                self.add_side(slots[i], [v, vertices[j]], to[j], ends);
                self.add_side(slots[j], [v, vertices[i]], to[i], [ends[1], ends[0]]);
            }
        }
        dot(to[0], cross(to[1], to[2])) / 6.0
    }

    /// The face towards a vertex, as an index.
    fn slot(&mut self, v: u32, u: u32) -> usize {
        let slot = self.slots[u as usize];
        if slot != NONE {
            return slot as usize;
        }
        let pair = Pair::new([v, u].map(|v| self.at(v)), [v, u].map(|v| self.radius(v)));
        self.slots[u as usize] = self.faces.len() as u32;
        self.faces.push(StarFace { vertex: u, area: 0.0, height: pair.heights[0] });
        self.pairs.push(pair);
        self.faces.len() - 1
    }

    /// Adds the triangle of a side of a face at the foot of the site, counted negative if the face is not on
    /// its side.
    fn add_side(&mut self, slot: usize, [v, third]: [u32; 2], to_third: Point3, ends: [Point3; 2]) {
        let heavier = self.radius(third).powi(2) - self.radius(v).powi(2);
        if let Some(side) = self.pairs[slot].side(to_third, heavier, ends) {
            self.faces[slot].area += 0.5 * side.offset * (side.to - side.from);
        }
    }

    /// How far beyond the box of a lattice images may be that change the cell that was measured last:
    /// `heaviest` is the greatest weight, the square of a radius. A bound, which shrinks with the cell.
    ///
    /// A site changes it only if it is in conflict with a tetrahedron: nearer to its orthocentre than the
    /// root of the power of that and its own weight. (Proof in `docs/theory/balls.md`.)
    pub(super) fn needed(&self, v: u32, lattice: &Lattice, heaviest: f64) -> Needed {
        let mut needed = Needed::default();
        let (site, weight, of_unit) = (self.at(v), self.radius(v).powi(2), lattice.extents(1.0));
        for (&t, &centre) in self.tetrahedra.iter().zip(&self.centres) {
            let radius = (dot(centre, centre) - weight + heaviest).max(0.0).sqrt() * (1.0 + SLACK);
            let middle = lattice.fraction([0, 1, 2].map(|axis| site[axis] + centre[axis]));
            for axis in 0..3 {
                let extent = of_unit[axis] * radius;
                let beyond = (extent - middle[axis]).max(middle[axis] + extent - 1.0);
                needed.margins[axis] = needed.margins[axis].max(beyond);
            }
            self.find_open(v, t, lattice, &mut needed);
        }
        needed
    }

    /// Marks the axis along which the hull cuts off the star of a site at a tetrahedron.
    fn find_open(&self, v: u32, t: u32, lattice: &Lattice, needed: &mut Needed) {
        let tetrahedron = &self.mesh.tetrahedra()[t as usize];
        let own = corner_of(&tetrahedron.vertices, v);
        for side in (0..4).filter(|&side| side != own && tetrahedron.neighbour(side).is_none()) {
            let [a, b, c] = TETRAHEDRON_FACETS[side].map(|corner| self.at(tetrahedron.vertices[corner]));
            let normal = cross(difference(b, a), difference(c, a));
            let along = lattice.vectors().map(|p| dot(normal, p).abs() / dot(p, p).sqrt());
            let axis = (1..3).fold(0, |most, axis| if along[axis] > along[most] { axis } else { most });
            needed.is_open[axis] = true;
        }
    }
}

fn corner_of(vertices: &[u32; 4], v: u32) -> usize {
    vertices.iter().position(|&corner| corner == v).expect("a tetrahedron around the vertex")
}
