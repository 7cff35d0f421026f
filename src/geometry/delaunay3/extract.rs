//! From the triangulated 3-sphere to a [`super::Tetrahedralization`], in place: infinite tetrahedra go.

use super::complex::Complex;
use super::tetrahedralization::{NONE, Tetrahedron, WORDS};

/// Leaves the finite tetrahedra and vertices in the arrays of the complex; returns the number of facets of
/// the hull. Tells `see` the vertices of each finite tetrahedron.
#[inline]
pub(super) fn extract(complex: &mut Complex<'_>, mut see: impl FnMut([u32; 4])) -> usize {
    let mut holes = Vec::new();
    let mut hull_facets = 0;
    for t in complex.words_of_tetrahedra() {
        if complex.is_deleted(t) {
            holes.push(t);
        } else if let Some(side) = complex.hull_facet(t) {
            holes.push(t);
            hull_facets += 1;
            let inside = complex.neighbour(side);
            complex.set_neighbour(inside, NONE);
        } else {
            see(complex.corners(t));
        }
    }
    holes.iter().for_each(|&t| complex.delete(t));
    fill(complex, &holes);
    let count = complex.tetrahedra.len() - holes.len();
    complex.tetrahedra.truncate(count);
    complex.vertices.pop();
    hull_facets
}

/// Moves the last tetrahedra to the places of those that are not there.
fn fill(complex: &mut Complex<'_>, holes: &[u32]) {
    let count = complex.tetrahedra.len() - holes.len();
    let mut last = complex.tetrahedra.len();
    for &hole in holes.iter().take_while(|&&hole| (hole as usize) < count * WORDS) {
        last -= 1;
        while complex.is_deleted((last * WORDS) as u32) {
            last -= 1;
        }
        let Tetrahedron { vertices, neighbours } = complex.tetrahedra[last];
        complex.write(hole, vertices, neighbours);
        for (facet, other) in (hole..).zip(neighbours).filter(|(_, other)| *other != NONE) {
            complex.set_neighbour(other, facet);
        }
    }
}
