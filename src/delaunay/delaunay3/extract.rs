//! From the triangulated 3-sphere to a [`super::Tetrahedralization`], in place: infinite tetrahedra go.

use super::complex::{DELETED, Facet};
use super::tetrahedralization::{NONE, Tetrahedron, WORDS};
use crate::error::Result;
use crate::parallel;
use bytemuck::cast_slice_mut;
use std::num::NonZeroUsize;

/// Tetrahedra that a thread looks at in one go.
const PIECE: usize = 1 << 16;

/// What is to be changed in a piece of the array.
struct Piece {
    /// Where no finite tetrahedra are.
    holes: Vec<u32>,
    /// The facets of finite tetrahedra on the hull.
    hull: Vec<Facet>,
}

/// Leaves the finite tetrahedra in the array; returns the number of facets of the hull.
pub(super) fn extract(
    tetrahedra: &mut Vec<Tetrahedron>,
    infinite: u32,
    threads: NonZeroUsize,
) -> Result<usize> {
    let pieces = tetrahedra.chunks(PIECE).enumerate();
    let pieces =
        parallel::map(threads, pieces, |(number, piece)| Ok(look_at(number * PIECE, piece, infinite)))?;
    let mut hull_facets = 0;
    for &facet in pieces.iter().flat_map(|piece| &piece.hull) {
        set_neighbour(tetrahedra, facet, NONE);
        hull_facets += 1;
    }
    let holes: Vec<u32> = pieces.into_iter().flat_map(|piece| piece.holes).collect();
    holes.iter().for_each(|&t| tetrahedra[t as usize].vertices[0] = DELETED);
    fill(tetrahedra, &holes);
    tetrahedra.truncate(tetrahedra.len() - holes.len());
    Ok(hull_facets)
}

/// Looks at the tetrahedra from number `first` on.
fn look_at(first: usize, tetrahedra: &[Tetrahedron], infinite: u32) -> Piece {
    let mut piece = Piece { holes: Vec::new(), hull: Vec::new() };
    for (t, Tetrahedron { vertices, neighbours }) in (first as u32..).zip(tetrahedra) {
        if vertices[0] >= DELETED {
            piece.holes.push(t);
        } else if let Some(side) = vertices.iter().position(|&v| v == infinite) {
            piece.holes.push(t);
            piece.hull.push(neighbours[side]);
        }
    }
    piece
}

/// Moves the last tetrahedra to the places of those that are not there.
fn fill(tetrahedra: &mut [Tetrahedron], holes: &[u32]) {
    let count = tetrahedra.len() - holes.len();
    let mut last = tetrahedra.len();
    for hole in holes.iter().map(|&hole| hole as usize).take_while(|&hole| hole < count) {
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
