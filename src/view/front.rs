//! Where a mesh is still growing: vertices that later triangles may use, and the border of the triangles so far.

use foldhash::{HashMap, HashMapExt};

use super::triangles::Triangle;
use spmesh_core::error::Result;
use spmesh_model::bounds::Point;
use spmesh_stream::{LiveVertices, Patch};

/// Vertices between their patch and their finalization, and edges that have one triangle so far.
///
/// Memory: with the width of the stream.
#[derive(Debug, Default)]
pub(super) struct Front {
    /// Live vertices, but for those that the patch at hand finalizes.
    live: LiveVertices<Point>,
    /// The vertices of the patch at hand.
    local: Vec<(u64, Point)>,
    /// Those of them that are finalized with it.
    leaving: Vec<u64>,
    /// Whether anybody asks for more than vertices.
    is_drawn: bool,
    /// Edges with one triangle, by their ends.
    open: HashMap<[u64; 2], [Point; 2]>,
    vertices: u64,
}

impl Front {
    /// No vertices. Edges are remembered only if they are going to be drawn.
    pub(super) fn new(is_drawn: bool) -> Front {
        Front { is_drawn, open: HashMap::new(), ..Front::default() }
    }

    /// Begins a patch; `to_world` says where vertices are.
    ///
    /// # Errors
    /// If the patch uses a vertex that is finalized or unknown.
    pub(super) fn begin(&mut self, patch: &Patch, to_world: impl Fn(Point) -> Point) -> Result<()> {
        let local = self.live.enter(patch, |_, stored| to_world(stored))?;
        self.local.clear();
        self.local.extend_from_slice(local);
        self.leaving = patch.finalized.iter().map(|&local| patch.id(local)).collect();
        self.leaving.sort_unstable();
        self.vertices += patch.new.len() as u64;
        Ok(())
    }

    /// A triangle of the patch at hand, with its number in the stream.
    pub(super) fn triangle(&mut self, local: [u32; 3], number: u64) -> Triangle {
        let vertices = local.map(|local| self.local[local as usize]);
        let triangle =
            Triangle { ids: vertices.map(|(id, _)| id), corners: vertices.map(|(_, at)| at), number };
        if self.is_drawn {
            [[0, 1], [1, 2], [2, 0]].into_iter().for_each(|ends| self.toggle(&triangle, ends));
        }
        triangle
    }

    /// Ends the patch at hand.
    pub(super) fn end(&mut self) {
        if self.is_drawn && !self.leaving.is_empty() {
            // An edge with a final end and one triangle is on the hull: nothing comes there.
            let leaving = &self.leaving;
            self.open.retain(|ends, _| ends.iter().all(|id| leaving.binary_search(id).is_err()));
        }
        self.leaving.clear();
        self.local.clear();
    }

    /// Where live vertices are.
    pub(super) fn vertices(&self) -> Vec<Point> {
        let leaving = self.local.iter().copied().filter(|(id, _)| self.leaving.binary_search(id).is_ok());
        let mut live: Vec<(u64, Point)> = self.live.iter().chain(leaving).collect();
        // As a table has them, they come in any order.
        live.sort_unstable_by_key(|&(id, _)| id);
        live.into_iter().map(|(_, at)| at).collect()
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
