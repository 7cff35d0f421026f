//! The outline of a face between two cells: where the sides of its polygon enter and leave the disk.

use super::super::dual::Dual;
use spmesh_delaunay::delaunay3::Ring;

/// A step on the way around a polygon, right-handed about the edge that is dual to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// The way enters the disk at a crossing.
    Enter(Crossing),
    /// The way leaves the disk: up to the next entry, the outline is an arc.
    Leave(Crossing),
    /// A corner in the disk: the orthocentre of a tetrahedron.
    Corner(usize),
}

/// Where an edge of the power diagram crosses the surface: the tetrahedron at its outer end, and the corner
/// opposite to the facet that is dual to the edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crossing {
    pub(super) tetrahedron: usize,
    pub(super) corner: usize,
}

/// The way around the polygon of a ring. Without steps, the whole polygon is outside of the disk, or the disk
/// in the polygon.
pub(super) fn outline(dual: &Dual<'_>, ring: &Ring, steps: &mut Vec<Step>) {
    steps.clear();
    let Some(&last) = ring.tetrahedra.back() else { return };
    let mut from = last as usize;
    for (&to, &third) in ring.tetrahedra.iter().zip(&ring.link) {
        let to = to as usize;
        let crossing = |tetrahedron: usize| {
            let vertices = dual.tile.tetrahedra()[tetrahedron].vertices;
            let is_apex = |v: &u32| !ring.ends.contains(v) && *v != third;
            Crossing { tetrahedron, corner: vertices.iter().position(is_apex).unwrap_or(0) }
        };
        match (dual.is_empty(from), dual.is_empty(to)) {
            (false, true) => steps.push(Step::Leave(crossing(to))),
            (true, false) => steps.push(Step::Enter(crossing(from))),
            (true, true) if dual.dips(to, crossing(to).corner) => {
                steps.extend([Step::Enter(crossing(from)), Step::Leave(crossing(to))]);
            }
            _ => {}
        }
        if !dual.is_empty(to) {
            steps.push(Step::Corner(to));
        }
        from = to;
    }
}
