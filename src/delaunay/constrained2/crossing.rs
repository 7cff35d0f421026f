//! Triangles that a segment crosses on its way out of the region.

use super::mesh::{Mesh, NONE, Side};
use crate::predicates::{Point2, Predicates2, Sign};

/// The sides on the border of a region, with the places of their ends; triangles are on the left.
pub(super) fn border(mesh: &Mesh) -> impl Iterator<Item = (Side, [Point2; 2])> + '_ {
    (0..mesh.triangles.len() as u32).flat_map(move |triangle| {
        let of = mesh.triangle(triangle);
        let is_open = |&place: &usize| of.neighbours[place] == NONE;
        (0..3).filter(is_open).map(move |place| {
            let ends = [1, 2].map(|turn| mesh.place(of.vertices[(place + turn) % 3]));
            (Side { triangle, place }, ends)
        })
    })
}

/// The triangles that a segment crosses which enters the region through a side of its border, up to the next
/// vertex on it or to the border. `from` is its end that is outside of this side.
pub(super) fn from_border(
    mesh: &Mesh,
    side: Side,
    [from, to]: [Point2; 2],
    predicates: &mut impl Predicates2,
) -> Vec<u32> {
    let (mut crossed, mut side) = (Vec::new(), side);
    loop {
        crossed.push(side.triangle);
        let apex = mesh.triangle(side.triangle).vertices[side.place];
        // The side runs counterclockwise; the next one ends at the apex, and the one after starts there.
        let turn = match predicates.orient2d(from, to, mesh.place(apex)) {
            Sign::Zero => return crossed,
            Sign::Positive => 1,
            Sign::Negative => 2,
        };
        let leaving = Side { triangle: side.triangle, place: (side.place + turn) % 3 };
        let Some(other) = mesh.across(leaving) else { return crossed };
        side = other;
    }
}
