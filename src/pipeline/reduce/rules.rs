//! The rules of a run.

use super::duplicates::Duplicates;
use super::sides::Sides;
use spmesh_stream::{Coordinates, Header, PointCode, Weights};

/// The rules that all nodes of a run share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules<const D: usize> {
    pub(super) coordinates: Coordinates,
    pub(super) code: PointCode,
    pub(super) duplicates: Duplicates,
    /// If points have weights.
    pub(super) weights: Option<Weights>,
    /// Whether the run leaves a residual, to be merged with others.
    pub(super) is_partial: bool,
    /// Whether to triangulate even nodes that would leave most of their points.
    pub(super) every_node: bool,
    /// Whether points on a surface may wait for the root, because there is memory, and the root has threads.
    pub(super) holds_surfaces: bool,
    /// Points of the input, if that is known.
    pub(super) points: Option<u64>,
    /// The box of all points: facets of the hull on one of its sides are final.
    pub(super) sides: Sides<D>,
}

impl<const D: usize> Rules<D> {
    /// The rules for a mesh with the given header.
    pub(super) fn new(header: &Header, duplicates: Duplicates, is_partial: bool) -> Self {
        let code = PointCode::of(header);
        let (coordinates, weights) = (header.coordinates, header.weights());
        Rules {
            coordinates,
            code,
            duplicates,
            weights,
            is_partial,
            every_node: false,
            holds_surfaces: false,
            points: None,
            sides: Sides::UNKNOWN,
        }
    }

    /// The encoding of the coordinates.
    pub(super) fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }
}
