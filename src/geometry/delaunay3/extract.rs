//! From the triangulated 3-sphere to a [`super::Tetrahedralization`], in place: infinite tetrahedra go.

use super::complex::{DELETED, Facet};
use super::tetrahedralization::{NONE, Tetrahedron, WORDS};
use bytemuck::cast_slice_mut;

/// Leaves the finite tetrahedra in the array; returns the number of facets of the hull. Tells `see` the
/// vertices of each finite tetrahedron.
#[inline]
pub(super) fn extract(
    tetrahedra: &mut Vec<Tetrahedron>,
    infinite: u32,
    mut see: impl FnMut([u32; 4]),
) -> usize {
    let mut holes = Vec::new();
    let mut hull_facets = 0;
    for t in 0..tetrahedra.len() {
        let Tetrahedron { vertices, neighbours } = tetrahedra[t];
        if vertices[0] >= DELETED {
            holes.push(t);
        } else if let Some(side) = vertices.iter().position(|&v| v == infinite) {
            holes.push(t);
            hull_facets += 1;
            set_neighbour(tetrahedra, neighbours[side], NONE);
        } else {
            see(vertices);
        }
    }
    holes.iter().for_each(|&t| tetrahedra[t].vertices[0] = DELETED);
    fill(tetrahedra, &holes);
    tetrahedra.truncate(tetrahedra.len() - holes.len());
    hull_facets
}

/// Moves the last tetrahedra to the places of those that are not there.
fn fill(tetrahedra: &mut [Tetrahedron], holes: &[usize]) {
    let count = tetrahedra.len() - holes.len();
    let mut last = tetrahedra.len();
    for &hole in holes.iter().take_while(|&&hole| hole < count) {
        last -= 1;
        while tetrahedra[last].vertices[0] >= DELETED {
            last -= 1;
        }
        tetrahedra[hole] = tetrahedra[last];
        let neighbours = tetrahedra[hole].neighbours;
        for (side, other) in (0..).zip(neighbours).filter(|(_, other)| *other != NONE) {
            set_neighbour(tetrahedra, other, (hole * WORDS) as u32 + side);
        }
    }
}

fn set_neighbour(tetrahedra: &mut [Tetrahedron], facet: Facet, other: Facet) {
    let words: &mut [[u32; WORDS]] = cast_slice_mut(tetrahedra);
    words[facet as usize / WORDS][4 + (facet & 3) as usize] = other;
}
