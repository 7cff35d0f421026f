//! The triangles that two pairs of opposite corners make: those of a cell of the grid, and those around a
//! node without a point.
//!
//! Corners of a quadrangle are numbered counterclockwise; side i joins corners i and i + 1, all modulo 4.
//! Triangle k has corners k, k + 1 and k + 3; it lacks corner k + 2. A quadrangle has two opposite triangles,
//! or, if one corner is missing, one, or none.

use crate::delaunay2::half_edge::{HalfEdge, NONE, WORDS};

/// The triangles of a quadrangle, as a set of bits.
pub(super) type Quad = u8;

/// Corners 1 and 3 are joined.
pub(super) const ODD_JOINED: Quad = 0b0101;
/// Corners 0 and 2 are joined.
pub(super) const EVEN_JOINED: Quad = 0b1010;

/// How many triangles.
#[inline(always)]
pub(super) fn count(quad: Quad) -> u32 {
    quad.count_ones()
}

/// Whether there is triangle k.
#[inline(always)]
pub(super) fn has(quad: Quad, k: usize) -> bool {
    quad >> k & 1 != 0
}

/// The half-edge of the long side of triangle k, from the first word of the quadrangle.
#[inline(always)]
pub(super) fn long_side(quad: Quad, k: usize) -> HalfEdge {
    WORDS as u32 * (quad & ((1 << k) - 1)).count_ones()
}

/// The half-edge of a side, from the first word of the quadrangle; `NONE` if no triangle has it.
#[inline(always)]
pub(super) fn side(quad: Quad, i: usize) -> HalfEdge {
    SIDES[usize::from(quad)][i]
}

/// Sides of all sets of triangles.
static SIDES: [[HalfEdge; 4]; 16] = sides();

const fn sides() -> [[HalfEdge; 4]; 16] {
    let mut sides = [[NONE; 4]; 16];
    let mut quad = 0;
    while quad < 16 {
        let mut first = 0;
        let mut k = 0;
        while k < 4 {
            if quad >> k & 1 != 0 {
                sides[quad][(k + 3) % 4] = first + 1;
                sides[quad][k] = first + 2;
                first += WORDS as u32;
            }
            k += 1;
        }
        quad += 1;
    }
    sides
}
