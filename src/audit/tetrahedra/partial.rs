//! The final tetrahedra of a region.

use super::live::{LiveTetrahedra, Star};
use super::{Corner, check_link};
use crate::Standard;
use crate::check::{Check, Ledger, Violation};
use crate::facets::OpenFacets;
use crate::partial::FinalSimplices;
use crate::vertices::{Vertex, Vertices};
use spmesh_stream::Patch;

impl FinalSimplices<3> for LiveTetrahedra {
    const NAMES: [&'static str; 2] = ["tetrahedron", "facet"];
    const FACETS: Check = Check::Facets;
    type Star = Star;

    fn new(standard: Standard) -> Self {
        LiveTetrahedra::new(standard)
    }

    fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.patch(patch, ledger, finalize)
    }

    fn vertices(&self) -> &Vertices<Star> {
        &self.vertices
    }

    fn facets(&self) -> &OpenFacets<3, Corner> {
        &self.facets
    }

    fn facets_mut(&mut self) -> &mut OpenFacets<3, Corner> {
        &mut self.facets
    }

    /// A wall is counterclockwise as seen from its tetrahedron, an open facet as seen from outside of it.
    fn turned([a, b, c]: [u64; 3]) -> [u64; 3] {
        [a, c, b]
    }
}

fn finalize(vertex: &Vertex<Star>, ledger: &mut Ledger) -> Result<(), Violation> {
    ledger.add(Check::Vertices, 1);
    let fault = if vertex.star.tetrahedra == 0 {
        "without a tetrahedron"
    } else if vertex.star.open > 0 {
        "with open facets"
    } else {
        return check_link(vertex);
    };
    let message = format!("vertex {} is finalized {fault}", vertex.id);
    Err(Violation::new(Check::Vertices, message).with(vertex.id, vertex.at))
}
