//! The final triangles of a region.

use super::check::{Check, Ledger, Violation};
use super::facets::OpenFacets;
use super::partial::FinalSimplices;
use super::triangles::{Corner, Fans, Standard, Triangles};
use super::vertices::{Vertex, Vertices};
use spmesh_stream::Patch;

impl FinalSimplices<2> for Triangles {
    const NAMES: [&'static str; 2] = ["triangle", "edge"];
    const FACETS: Check = Check::Edges;
    type Star = Fans;

    fn new(standard: Standard) -> Self {
        Triangles::new(standard)
    }

    fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.patch(patch, ledger, finalize)
    }

    fn vertices(&self) -> &Vertices<Fans> {
        &self.vertices
    }

    fn facets(&self) -> &OpenFacets<2, Corner> {
        &self.edges
    }

    fn facets_mut(&mut self) -> &mut OpenFacets<2, Corner> {
        &mut self.edges
    }

    /// A wall has its triangle on the left, as an open edge has.
    fn turned(edge: [u64; 2]) -> [u64; 2] {
        edge
    }
}

fn finalize(vertex: &Vertex<Fans>, ledger: &mut Ledger) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    let fans = vertex.star;
    let fault = if !fans.is_used {
        "without a triangle"
    } else if fans.entering + fans.leaving > 0 {
        "with open edges"
    } else {
        return fans.winding.check_once(vertex);
    };
    let message = format!("vertex {} is finalized {fault}", vertex.id);
    Err(Violation::new(Check::Vertices, message).with(vertex.id, vertex.at))
}
