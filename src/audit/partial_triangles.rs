//! The final triangles of a region.

use super::check::{Check, Ledger, Violation};
use super::partial::FinalSimplices;
use super::triangles::{Fans, Standard, Triangles};
use super::vertices::Vertex;
use crate::bounds::Point;
use crate::stream::Patch;

impl FinalSimplices for Triangles {
    const NAMES: [&'static str; 2] = ["triangle", "edge"];

    const CHECKS: [Check; 9] = [
        Check::Orientation,
        Check::Edges,
        Check::Delaunay,
        Check::Vertices,
        Check::Finalization,
        Check::Counts,
        Check::Region,
        Check::Residual,
        Check::Walls,
    ];

    fn new(standard: Standard) -> Self {
        Triangles::new(standard)
    }

    fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        self.patch(patch, ledger, finalize)
    }

    fn vertices(&self) -> u64 {
        self.vertices.seen()
    }

    fn place(&self, id: u64) -> Option<Point> {
        self.vertices.live(id).map(|vertex| vertex.at)
    }

    fn first_live(&self, is_wrong: impl Fn(u64) -> bool) -> Option<(u64, Point)> {
        self.vertices.first_live(|vertex| is_wrong(vertex.id)).map(|vertex| (vertex.id, vertex.at))
    }

    /// A wall has its triangle on the left, as an open edge has.
    fn close(&mut self, edge: &[u64]) -> bool {
        matches!(edge, &[from, to] if self.edges.close([from, to]))
    }

    fn first_open(&self) -> Option<Vec<u64>> {
        self.edges.first().map(Vec::from)
    }

    fn width(&self) -> (usize, usize) {
        (self.vertices.live_max(), self.edges.len())
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
