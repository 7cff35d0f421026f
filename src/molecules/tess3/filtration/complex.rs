//! The simplices of a triangulation and their values.
//!
//! A simplex is attached if a vertex is in conflict with its least orthosphere; its value is then the least
//! of its cofaces with one more vertex. Otherwise it is the power of its own orthocentre. So each value is
//! the power of the orthocentre of some simplex, the carrier of the value. Vertices next to the simplex (its
//! link) tell whether it is attached.

use super::sites::{NONE, Simplex, Sites};
use super::value::Value;
use spmesh_delaunay::delaunay3::{Ring, Tetrahedralization};

/// All simplices, by number: tetrahedra, triangles, edges, vertices.
#[derive(Debug, Default)]
pub(super) struct Table {
    pub(super) simplices: Vec<Simplex>,
    /// Number of the simplex whose orthocentre has the value as its power.
    pub(super) carriers: Vec<u32>,
    pub(super) values: Vec<Value>,
}

/// The simplices of a triangulation, without those that have a vertex which is not in `sites`.
///
/// Memory: 40 bytes per simplex, and 16 per tetrahedron until it is done; some 1.3 kB per point in all.
pub(super) fn simplices(sites: &Sites<'_>, mesh: &Tetrahedralization) -> Table {
    let mut complex = Complex { sites, mesh, table: Table::default(), triangles: Vec::new() };
    complex.add_tetrahedra();
    complex.add_triangles();
    let vertices = complex.add_edges();
    complex.add_vertices(vertices);
    complex.table
}

struct Complex<'c> {
    sites: &'c Sites<'c>,
    mesh: &'c Tetrahedralization,
    table: Table,
    /// The triangles opposite to the corners of tetrahedra.
    triangles: Vec<[u32; 4]>,
}

/// What edges tell of one of their ends.
#[derive(Debug, Clone, Copy)]
struct End {
    is_attached: bool,
    /// The edge of least value.
    least: u32,
}

impl Complex<'_> {
    fn add_tetrahedra(&mut self) {
        for tetrahedron in self.mesh.tetrahedra() {
            let vertices = self.indices(tetrahedron.vertices);
            if self.are_sites(&vertices) {
                self.add(&vertices, None);
            }
        }
    }

    fn add_triangles(&mut self) {
        // If a vertex is no site, all tetrahedra have such a one.
        let has_tetrahedra = !self.table.simplices.is_empty();
        let mesh = self.mesh;
        self.triangles = vec![[NONE; 4]; mesh.tetrahedra().len()];
        for (t, tetrahedron) in mesh.tetrahedra().iter().enumerate() {
            for side in 0..4 {
                let beyond = tetrahedron.neighbour(side);
                if beyond.is_some_and(|corner| (corner.tetrahedron as usize) < t) {
                    continue;
                }
                let vertices = self.indices([1, 2, 3].map(|i| tetrahedron.vertices[(side + i) % 4]));
                if !self.are_sites(&vertices) {
                    continue;
                }
                let own = [t as u32, side as u32];
                let corners = [Some(own), beyond.map(|corner| [corner.tetrahedron, corner.corner])];
                let corners = corners.into_iter().flatten();
                let opposite = corners
                    .clone()
                    .map(|[t, corner]| mesh.tetrahedra()[t as usize].vertices[corner as usize]);
                let is_attached = has_tetrahedra && self.is_attached(&vertices, opposite);
                let coface = is_attached.then(|| self.least(corners.clone().map(|[t, _]| t)));
                let number = self.add(&vertices, coface);
                corners.for_each(|[t, corner]| self.triangles[t as usize][corner as usize] = number);
            }
        }
    }

    /// Returns what the edges tell of each vertex of the mesh.
    fn add_edges(&mut self) -> Vec<End> {
        let mesh = self.mesh;
        let of_vertices = if self.sites.is_weighted() { mesh.vertices().len() } else { 0 };
        let mut ends = vec![End { is_attached: false, least: NONE }; of_vertices];
        let add = |ring: &Ring| -> Result<(), std::convert::Infallible> {
            let vertices = self.indices(ring.ends);
            if self.are_sites(&vertices) {
                let is_attached = self.is_attached(&vertices, ring.link.iter().copied());
                let coface = is_attached.then(|| self.least(self.triangles_around(ring)));
                let number = self.add(&vertices, coface);
                self.note_ends(ring.ends, number, &mut ends);
            }
            Ok(())
        };
        let Ok(()) = mesh.for_each_edge(|_| true, add);
        ends
    }

    fn add_vertices(&mut self, ends: Vec<End>) {
        let mesh = self.mesh;
        let mut is_visible = vec![false; mesh.vertices().len()];
        let corners = mesh.tetrahedra().iter().flat_map(|tetrahedron| tetrahedron.vertices);
        corners.for_each(|vertex| is_visible[vertex as usize] = true);
        for vertex in (0..).zip(is_visible).filter_map(|(vertex, is_visible)| is_visible.then_some(vertex)) {
            let vertices = self.indices([vertex]);
            if self.are_sites(&vertices) {
                let end = ends.get(vertex as usize).filter(|end| end.is_attached);
                self.add(&vertices, end.map(|end| end.least));
            }
        }
    }

    /// The input points of vertices of the mesh.
    fn indices<const N: usize>(&self, vertices: [u32; N]) -> [u32; N] {
        let mut indices = vertices.map(|vertex| self.mesh.vertices()[vertex as usize].index);
        indices.sort_unstable();
        indices
    }

    fn are_sites(&self, indices: &[u32]) -> bool {
        indices.iter().all(|&index| self.sites.has(index))
    }

    /// Whether one of some vertices of the mesh is in conflict with a simplex.
    fn is_attached(&self, simplex: &[u32], vertices: impl Iterator<Item = u32>) -> bool {
        let mut others = vertices.map(|vertex| self.mesh.vertices()[vertex as usize].index);
        others.any(|other| self.sites.has(other) && self.sites.is_in_conflict(simplex, other))
    }

    /// The one of least value among some simplices.
    fn least(&self, simplices: impl Iterator<Item = u32>) -> u32 {
        let least = simplices.reduce(|a, b| if self.is_less(b, a) { b } else { a });
        least.expect("an attached simplex has cofaces")
    }

    fn is_less(&self, a: u32, b: u32) -> bool {
        let carrier = |number: u32| &self.table.simplices[self.table.carriers[number as usize] as usize];
        let value = |number: u32| &self.table.values[number as usize];
        self.sites.compare([carrier(a), carrier(b)], [value(a), value(b)]).is_lt()
    }

    /// The triangles at an edge whose vertices are all sites; most of them twice.
    fn triangles_around(&self, ring: &Ring) -> impl Iterator<Item = u32> {
        let at_edge = move |&t: &u32| {
            let vertices = self.mesh.tetrahedra()[t as usize].vertices;
            let sides = (0..4).filter(move |&side| !ring.ends.contains(&vertices[side]));
            sides.map(move |side| self.triangles[t as usize][side])
        };
        ring.tetrahedra.iter().flat_map(at_edge).filter(|&number| number != NONE)
    }

    /// Notes what an edge tells of its ends, if there are weights. Without, no vertex is attached.
    fn note_ends(&self, edge: [u32; 2], number: u32, ends: &mut [End]) {
        if ends.is_empty() {
            return;
        }
        for [vertex, other] in [edge, [edge[1], edge[0]]] {
            let [index, other] = [vertex, other].map(|vertex| self.mesh.vertices()[vertex as usize].index);
            let end = &mut ends[vertex as usize];
            end.is_attached |= self.sites.is_in_conflict(&[index], other);
            if end.least == NONE || self.is_less(number, end.least) {
                end.least = number;
            }
        }
    }

    /// Adds a simplex with its own value, or with that of a coface.
    fn add(&mut self, vertices: &[u32], coface: Option<u32>) -> u32 {
        let mut simplex = [NONE; 4];
        simplex[..vertices.len()].copy_from_slice(vertices);
        let number = self.table.simplices.len() as u32;
        let (carrier, value) = match coface {
            Some(coface) => (self.table.carriers[coface as usize], self.table.values[coface as usize]),
            None => (number, self.sites.value(&simplex)),
        };
        self.table.simplices.push(simplex);
        self.table.carriers.push(carrier);
        self.table.values.push(value);
        number
    }
}
