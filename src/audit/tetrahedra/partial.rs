//! The final tetrahedra of a region.

use super::check_link;
use super::live::{LiveTetrahedra, Star};
use crate::audit::Standard;
use crate::audit::check::{Check, Ledger, Violation};
use crate::audit::partial::FinalSimplices;
use crate::audit::vertices::Vertex;
use crate::bounds::Point;
use crate::stream::Patch;

impl FinalSimplices for LiveTetrahedra {
    const NAMES: [&'static str; 2] = ["tetrahedron", "facet"];

    const CHECKS: [Check; 9] = [
        Check::Orientation,
        Check::Facets,
        Check::Delaunay,
        Check::Vertices,
        Check::Finalization,
        Check::Counts,
        Check::Region,
        Check::Residual,
        Check::Walls,
    ];

    fn new(standard: Standard) -> Self {
        LiveTetrahedra::new(standard)
    }

    fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.patch(patch, ledger, finalize)
    }

    fn vertices(&self) -> u64 {
        self.seen().vertices
    }

    fn place(&self, id: u64) -> Option<Point> {
        self.vertices.live(id).map(|vertex| vertex.at)
    }

    fn first_live(&self, is_wrong: impl Fn(u64) -> bool) -> Option<(u64, Point)> {
        self.vertices.first_live(|vertex| is_wrong(vertex.id)).map(|vertex| (vertex.id, vertex.at))
    }

    /// A wall is counterclockwise as seen from its tetrahedron, an open facet as seen from outside of it.
    fn close(&mut self, wall: &[u64]) -> bool {
        matches!(wall, &[a, b, c] if self.facets.close([a, c, b]))
    }

    fn first_open(&self) -> Option<Vec<u64>> {
        self.facets.first().map(|[a, b, c]| vec![a, c, b])
    }

    fn width(&self) -> (usize, usize) {
        (self.vertices.live_max(), self.facets.len())
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
