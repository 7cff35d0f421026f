//! What is around vertices and tetrahedra.

use super::nearest::VertexIn;
use super::tetrahedralization::{NONE, Tetrahedralization};
use crate::predicates::{Point3, circumcentre3};
use foldhash::HashSet;

/// The neighbours of vertices, with a tetrahedron for each vertex to begin at.
///
/// ```
/// use spmesh_delaunay::delaunay3::{Stars, triangulate};
///
/// let points = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [1.0, 1.0, 1.0]];
/// let mesh = triangulate(&points)?;
/// let mut stars = Stars::new(&mesh);
/// assert_eq!(stars.of(4), [0, 1, 2, 3]);
/// # Ok::<(), spmesh_delaunay::Error>(())
/// ```
#[derive(Debug)]
pub struct Stars<'m> {
    mesh: &'m Tetrahedralization,
    /// For each input point a tetrahedron at it, and its vertex there; [`NONE`] if there is none.
    starts: Vec<VertexIn>,
    around: TetrahedraAround,
    vertices: Vec<VertexIn>,
    indices: Vec<u32>,
}

impl<'m> Stars<'m> {
    /// The stars of the vertices of `mesh`. Cost: one pass, and 8 bytes for each point.
    pub fn new(mesh: &'m Tetrahedralization) -> Stars<'m> {
        let none = VertexIn { vertex: NONE, tetrahedron: NONE };
        let mut starts = vec![none; mesh.vertices.len() + mesh.duplicates.len()];
        for (tetrahedron, corners) in (0..).zip(&mesh.tetrahedra) {
            for vertex in corners.vertices {
                let index = mesh.vertices[vertex as usize].index;
                starts[index as usize] = VertexIn { vertex, tetrahedron };
            }
        }
        Stars { mesh, starts, around: TetrahedraAround::default(), vertices: Vec::new(), indices: Vec::new() }
    }

    /// The vertices that share an edge with the vertex of this index, in increasing order. None for
    /// duplicates and hidden points, and none without tetrahedra.
    ///
    /// Cost: O(1) for each tetrahedron at the vertex, and a sort.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn of(&mut self, index: u32) -> &[u32] {
        self.indices.clear();
        let start = self.starts[index as usize];
        if start.tetrahedron != NONE {
            self.around.find_vertices(self.mesh, start, &mut self.vertices);
            let vertices = self.vertices.iter().map(|node| node.vertex);
            self.indices.extend(vertices.map(|v| self.mesh.vertices[v as usize].index));
            self.indices.sort_unstable();
        }
        &self.indices
    }
}

/// The search for all tetrahedra at a vertex, with buffers that are reused.
#[derive(Debug, Default)]
pub(super) struct TetrahedraAround {
    seen: HashSet<u32>,
    left: Vec<u32>,
}

impl TetrahedraAround {
    /// Replaces the content of `vertices` by those that share an edge with a vertex, each once, in a
    /// tetrahedron that has both.
    pub(super) fn find_vertices(
        &mut self,
        mesh: &Tetrahedralization,
        node: VertexIn,
        vertices: &mut Vec<VertexIn>,
    ) {
        vertices.clear();
        self.seen.clear();
        self.seen.insert(node.tetrahedron);
        self.left.push(node.tetrahedron);
        while let Some(tetrahedron) = self.left.pop() {
            let at = &mesh.tetrahedra[tetrahedron as usize];
            for (side, &vertex) in at.vertices.iter().enumerate().filter(|&(_, &v)| v != node.vertex) {
                vertices.push(VertexIn { vertex, tetrahedron });
                // The facet opposite to another vertex has this one.
                if let Some(across) = at.neighbour(side)
                    && self.seen.insert(across.tetrahedron)
                {
                    self.left.push(across.tetrahedron);
                }
            }
        }
        vertices.sort_unstable_by_key(|found| found.vertex);
        vertices.dedup_by_key(|found| found.vertex);
    }
}

impl Tetrahedralization {
    /// The centre of the sphere through the corners of tetrahedron `number`: off by at most 1e-12 of the
    /// radius and one unit in the last place of each coordinate. `None` if it overflows.
    ///
    /// # Panics
    /// If there is no such tetrahedron.
    pub fn circumcentre(&self, number: u32) -> Option<Point3> {
        let vertices = self.tetrahedra[number as usize].vertices;
        circumcentre3(vertices.map(|v| self.vertices[v as usize].at))
    }
}
