//! Where a mesh still grows: the vertices that later triangles may use, and the border of the triangles so
//! far.

use foldhash::{HashMap, HashMapExt};

use super::triangles::Triangle;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{LiveVertices, Patch};

/// A vertex, with its place in stored coordinates.
#[derive(Debug, Clone, Copy, Default)]
struct Vertex {
    at: Point,
    stored: Point2,
}

/// The live vertices, and the edges that have one triangle so far.
///
/// Memory: proportional to the width of the stream.
#[derive(Debug, Default)]
pub(super) struct Front {
    /// Live vertices, except those that the current patch finalizes.
    live: LiveVertices<Vertex>,
    /// The vertices of the current patch.
    local: Vec<(u64, Vertex)>,
    /// Those that the current patch finalizes, sorted.
    leaving: Vec<u64>,
    /// Whether edges are tracked.
    is_drawn: bool,
    /// Edges with one triangle, by the ids of their ends.
    open: HashMap<[u64; 2], [Point; 2]>,
    vertices: u64,
}

impl Front {
    /// An empty front. Edges are tracked only if they are going to be drawn.
    pub(super) fn new(is_drawn: bool) -> Front {
        Front { is_drawn, open: HashMap::new(), ..Front::default() }
    }

    /// Begins a patch; `to_world` maps the number of a new vertex and its stored coordinates to the world.
    pub(super) fn begin(&mut self, patch: &Patch, to_world: impl Fn(usize, Point) -> Point) -> Result<()> {
        let number = |id: u64| (id - patch.first_id) as usize;
        let vertex =
            |id, stored: Point| Vertex { at: to_world(number(id), stored), stored: [stored[0], stored[1]] };
        let local = self.live.enter(patch, vertex)?;
        self.local.clear();
        self.local.extend_from_slice(local);
        self.leaving = patch.finalized.iter().map(|&local| patch.id(local)).collect();
        self.leaving.sort_unstable();
        self.vertices += patch.new.len() as u64;
        Ok(())
    }

    /// The place of a vertex of the current patch.
    pub(super) fn place(&self, local: u32) -> Point {
        self.local[local as usize].1.at
    }

    /// A triangle of the current patch, with its number in the stream, and its corners in stored coordinates.
    pub(super) fn triangle(&mut self, local: [u32; 3], number: u64) -> (Triangle, [Point2; 3]) {
        let vertices = local.map(|local| self.local[local as usize]);
        let triangle = Triangle {
            ids: vertices.map(|(id, _)| id),
            corners: vertices.map(|(_, vertex)| vertex.at),
            number,
        };
        if self.is_drawn {
            [[0, 1], [1, 2], [2, 0]].into_iter().for_each(|ends| self.toggle(&triangle, ends));
        }
        (triangle, vertices.map(|(_, vertex)| vertex.stored))
    }

    /// Ends the current patch.
    pub(super) fn end(&mut self) {
        if self.is_drawn && !self.leaving.is_empty() {
            // An edge with a final end and one triangle is on the hull; no other triangle can come.
            let leaving = &self.leaving;
            self.open.retain(|ends, _| ends.iter().all(|id| leaving.binary_search(id).is_err()));
        }
        self.leaving.clear();
        self.local.clear();
    }

    /// The places of the live vertices.
    pub(super) fn vertices(&self) -> Vec<Point> {
        let leaving = self.local.iter().copied().filter(|(id, _)| self.leaving.binary_search(id).is_ok());
        let mut live: Vec<(u64, Vertex)> = self.live.iter().chain(leaving).collect();
        // The table has no stable order.
        live.sort_unstable_by_key(|&(id, _)| id);
        live.into_iter().map(|(_, vertex)| vertex.at).collect()
    }

    /// The border of the triangles so far, where more may come.
    pub(super) fn border(&self) -> Vec<[Point; 2]> {
        let mut border: Vec<_> = self.open.iter().collect();
        border.sort_unstable_by_key(|(ends, _)| **ends);
        border.into_iter().map(|(_, &ends)| ends).collect()
    }

    /// Number of vertices so far.
    pub(super) fn count(&self) -> u64 {
        self.vertices
    }

    fn toggle(&mut self, triangle: &Triangle, ends: [usize; 2]) {
        let [a, b] = ends.map(|end| triangle.ids[end]);
        let key = [a.min(b), a.max(b)];
        if self.open.remove(&key).is_none() {
            self.open.insert(key, ends.map(|end| triangle.corners[end]));
        }
    }
}
