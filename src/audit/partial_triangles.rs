//! The final triangles of a region.

use std::cmp::Ordering;

use super::check::{Check, Ledger, Violation};
use super::exact::Decided;
use super::exact::plane::{Xy, enclosing_circle, in_circle, in_raised_circle, lexicographic, orientation};
use super::facets::OpenFacets;
use super::partial::FinalSimplices;
use super::residual_fit::WallGeometry;
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

    fn ahead(star: &Fans) -> u16 {
        star.winding.ahead()
    }

    /// A wall has its triangle on the left, as an open edge has.
    fn turned(edge: [u64; 2]) -> [u64; 2] {
        edge
    }
}

/// The ray goes down, infinitesimally to the right.
impl WallGeometry<2> for Triangles {
    const BALL: &'static str = "circle";

    fn in_ball([a, b]: [Xy; 2], apex: Xy, at: Xy) -> Decided {
        in_circle(a, b, apex, at)
    }

    fn in_raised_ball([a, b]: [Xy; 2], apex: Xy, at: Xy) -> Ordering {
        in_raised_circle(a, b, apex, at)
    }

    fn enclosing_ball([a, b]: [Xy; 2], apex: Xy) -> Option<(Xy, f64)> {
        enclosing_circle(a, b, apex)
    }

    fn crossing([a, b]: [Xy; 2], at: Xy) -> i64 {
        match (lexicographic(a, at), lexicographic(b, at)) {
            (Ordering::Less, Ordering::Greater) => i64::from(orientation(a, b, at).sign == Ordering::Greater),
            (Ordering::Greater, Ordering::Less) => -i64::from(orientation(a, b, at).sign == Ordering::Less),
            _ => 0,
        }
    }

    fn shadow([a, b]: [Xy; 2]) -> [Xy; 2] {
        [[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), f64::INFINITY]]
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
