//! The final tetrahedra of a region.

use std::cmp::Ordering;

use super::live::{LiveTetrahedra, Star};
use super::{Corner, check_link};
use crate::Standard;
use crate::check::{Check, Ledger, Violation};
use crate::exact::Decided;
use crate::exact::space::{Xyz, enclosing_sphere, facing, in_raised_sphere, in_sphere, orientation};
use crate::facets::OpenFacets;
use crate::partial::FinalSimplices;
use crate::residual_fit::WallGeometry;
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
        self.patch(patch, &[], ledger, finalize)
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

    fn ahead(star: &Star) -> u16 {
        star.winding.ahead()
    }

    /// A wall is counterclockwise as seen from its tetrahedron, an open facet as seen from outside of it.
    fn turned([a, b, c]: [u64; 3]) -> [u64; 3] {
        [a, c, b]
    }
}

/// The ray goes in the direction (1, e, e²) for an infinitesimal e.
impl WallGeometry<3> for LiveTetrahedra {
    const BALL: &'static str = "sphere";

    fn in_ball([a, b, c]: [Xyz; 3], apex: Xyz, at: Xyz) -> Decided {
        in_sphere(a, b, c, apex, at)
    }

    fn in_raised_ball([a, b, c]: [Xyz; 3], apex: Xyz, at: Xyz) -> Ordering {
        in_raised_sphere(a, b, c, apex, at)
    }

    fn enclosing_ball([a, b, c]: [Xyz; 3], apex: Xyz) -> Option<(Xyz, f64)> {
        enclosing_sphere(a, b, c, apex)
    }

    fn crossing([a, b, c]: [Xyz; 3], at: Xyz) -> i64 {
        // How the wall goes around the ray, seen against its direction.
        match [facing(at, a, b), facing(at, b, c), facing(at, c, a)] {
            [Ordering::Less, Ordering::Less, Ordering::Less] => {
                i64::from(orientation(a, b, c, at).sign == Ordering::Greater)
            }
            [Ordering::Greater, Ordering::Greater, Ordering::Greater] => {
                -i64::from(orientation(a, b, c, at).sign == Ordering::Less)
            }
            _ => 0,
        }
    }

    fn shadow([a, b, c]: [Xyz; 3]) -> [Xyz; 2] {
        let low = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let high = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        [[f64::NEG_INFINITY, low(1), low(2)], [0, 1, 2].map(high)]
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
