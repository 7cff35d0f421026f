//! The star of a new point: simplices of the point and each facet of the border of its cavity.

use super::arrays::Arrays;
use super::cavity::Cavity;
use super::coefficient::Coefficient;
use super::complex::{FACETS, Facet, facet, facet_of, simplex_of, spheres_of, without};
use super::lanes::{LANES, Lanes};
use super::links::Links;
use spmesh_stream::model::cells4::Point4;

/// The place of the new point in its simplices.
const LAST: usize = FACETS - 1;

/// Makes a simplex of each facet of the border and vertex `q`, in the places given, and links them.
#[inline(always)]
pub(super) fn make<C: Coefficient, L: Lanes>(
    token: L::Token,
    arrays: &mut Arrays<'_, C>,
    near: &[Point4],
    q: u32,
    cavity: &Cavity,
    places: &[u32],
    links: &mut Links,
) {
    let o = near[q as usize];
    links.clear(places.len());
    for (facets, star) in cavity.border().chunks(LANES).zip(places.chunks(LANES)) {
        let last = facets.len() - 1;
        let vertices = |lane: usize| facet_vertices(arrays, facets[lane.min(last)]);
        let vertices = [vertices(0), vertices(1), vertices(2), vertices(3)];
        let spheres = spheres_of::<C, L>(token, near, &o, &vertices);
        for (lane, &new) in star.iter().enumerate() {
            let (new, outer) = (new as usize, arrays.neighbour(facets[lane]));
            arrays.set_neighbour(outer, facet(new, LAST));
            let [a, b, c, d] = vertices[lane];
            arrays.set(new, [a, b, c, d, q], spheres[lane]);
            arrays.set_neighbour(facet(new, LAST), outer);
            links.link(arrays, new, &vertices[lane]);
        }
    }
}

/// The vertices of a facet of the border, in the order that makes a positive simplex with the new point as
/// the last.
///
/// The new point, greater than all others, replaces the vertex opposite to the facet, and goes to the end,
/// past all vertices after it. The first two vertices are swapped if that turns the simplex.
#[inline(always)]
fn facet_vertices<C: Coefficient>(arrays: &Arrays<'_, C>, facet: Facet) -> [u32; 4] {
    let side = facet_of(facet);
    let [a, b, c, d] = without(arrays.vertices(simplex_of(facet)), side);
    if side.is_multiple_of(2) { [a, b, c, d] } else { [b, a, c, d] }
}
