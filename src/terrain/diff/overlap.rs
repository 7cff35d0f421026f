//! What two triangles have in common.
//!
//! Which corners the common polygon has follows from signs of determinants and comparisons of fractions in
//! integers, so it is exact. Its corners are corners of one triangle in the other, and crossings of edges.

use std::cmp::Ordering;

use super::Real;
use super::piece::{Corner, Piece};
use spmesh_delaunay::predicates::Pair;

/// A corner on the common grid.
pub(super) type Vertex = [i64; 3];

/// A counterclockwise triangle, from its least corner on.
pub(super) type Triangle = [Vertex; 3];

/// Corners of the common polygon: those of the first triangle, of the second, crossings of edges.
const OF_SECOND: usize = 3;
const CROSSINGS: usize = 6;
const NAMES: usize = 15;

/// Marks a name that is no corner.
const NONE: u8 = u8::MAX;

/// The sides of three corners of one triangle by three edges of another: `sides[corner][edge]` is twice the
/// area of both, positive to the left.
type Sides = [[i128; 3]; 3];

/// Two triangles, from a common origin.
struct Overlap {
    first: Triangle,
    second: Triangle,
    /// Corners of the first by edges of the second, and the other way round.
    of_first: Sides,
    of_second: Sides,
    /// What corners of the second triangle are called: those of the first at the same place, if there are.
    names: [usize; 3],
}

/// The polygon that two triangles have in common, with the second surface minus the first; `None` if it has
/// no area. The triangles are given with an origin, from which the corners of the polygon count.
///
/// Domain: differences of coordinates are below 2^41, so that products of three are below 2^127.
#[inline]
pub(super) fn common(first: &Triangle, second: &Triangle, origin: &Vertex) -> Option<Piece> {
    let near = |triangle: &Triangle| triangle.map(|corner| [0, 1, 2].map(|axis| corner[axis] - origin[axis]));
    let (first, second) = (near(first), near(second));
    let of_first = sides(&first, &second);
    let of_second = sides(&second, &first);
    // Convex polygons without a common inner place are on two sides of an edge of one of them.
    if is_apart(&of_first) || is_apart(&of_second) {
        return None;
    }
    let place = |corner: Vertex| [corner[0], corner[1]];
    let name = |corner: usize| {
        let same = first.iter().position(|&other| place(other) == place(second[corner]));
        same.unwrap_or(OF_SECOND + corner)
    };
    let names = [0, 1, 2].map(name);
    Some(Overlap { first, second, of_first, of_second, names }.piece())
}

#[inline]
fn sides(corners: &Triangle, edges: &Triangle) -> Sides {
    let next = [edges[1], edges[2], edges[0]];
    corners.map(|[x, y, _]| {
        [0, 1, 2].map(|edge| {
            let ([ax, ay, _], [bx, by, _]) = (edges[edge], next[edge]);
            i128::from(bx - ax) * i128::from(y - ay) - i128::from(by - ay) * i128::from(x - ax)
        })
    })
}

#[inline]
fn is_apart(sides: &Sides) -> bool {
    (0..3).any(|edge| sides.iter().all(|corner| corner[edge] <= 0))
}

/// The part of an edge in a triangle: where it enters and leaves it, if not at its ends.
#[derive(Default)]
struct Within {
    enters: Option<([i128; 2], usize)>,
    leaves: Option<([i128; 2], usize)>,
}

/// Cuts an edge at the three edges of a triangle; `None` if nothing or a single place is left.
#[inline]
fn within(from: &[i128; 3], to: &[i128; 3]) -> Option<Within> {
    let mut found = Within::default();
    for edge in 0..3 {
        let (p, q) = (from[edge], to[edge]);
        if p >= 0 && q >= 0 {
            continue;
        }
        if p <= 0 && q <= 0 {
            return None;
        }
        let share = [p.abs(), p.abs() + q.abs()];
        if p < 0 {
            if found.enters.is_none_or(|(other, _)| compare(share, other) == Ordering::Greater) {
                found.enters = Some((share, edge));
            }
        } else if found.leaves.is_none_or(|(other, _)| compare(share, other) == Ordering::Less) {
            found.leaves = Some((share, edge));
        }
    }
    if let (Some((enters, _)), Some((leaves, _))) = (found.enters, found.leaves)
        && compare(enters, leaves) != Ordering::Less
    {
        return None;
    }
    Some(found)
}

/// Compares fractions with positive parts by their continued fractions, where products do not fit.
fn compare([a, b]: [i128; 2], [c, d]: [i128; 2]) -> Ordering {
    if let (Some(left), Some(right)) = (a.checked_mul(d), c.checked_mul(b)) {
        return left.cmp(&right);
    }
    match (a / b).cmp(&(c / d)) {
        Ordering::Equal => match (a % b, c % d) {
            (0, 0) => Ordering::Equal,
            (0, _) => Ordering::Less,
            (_, 0) => Ordering::Greater,
            (p, q) => compare([d, q], [b, p]),
        },
        other => other,
    }
}

impl Overlap {
    /// Chains the parts of all edges that are in the other triangle.
    #[inline]
    fn piece(&self) -> Piece {
        let mut next = [NONE; NAMES];
        let mut start = NONE;
        let mut add = |from: usize, to: usize| {
            if from != to {
                next[from] = to as u8;
                start = from as u8;
            }
        };
        for edge in 0..3 {
            let turn = (edge + 1) % 3;
            if let Some(Within { enters, leaves }) = within(&self.of_first[edge], &self.of_first[turn]) {
                let at = |end: Option<(_, usize)>, corner| {
                    end.map_or(corner, |(_, other)| self.crossing(edge, other))
                };
                add(at(enters, edge), at(leaves, turn));
            }
            // Edges on one line are those of the first triangle.
            let (from, to) = (&self.of_second[edge], &self.of_second[turn]);
            if (0..3).any(|other| from[other] == 0 && to[other] == 0) {
                continue;
            }
            if let Some(Within { enters, leaves }) = within(from, to) {
                let at = |end: Option<(_, usize)>, corner: usize| {
                    end.map_or(self.names[corner], |(_, other)| self.crossing(other, edge))
                };
                add(at(enters, edge), at(leaves, turn));
            }
        }
        self.walk(&next, start)
    }

    fn walk(&self, next: &[u8; NAMES], start: u8) -> Piece {
        let mut piece = Piece::default();
        // From the least name on, so that the polygon does not depend on how it was found.
        let first = next.iter().position(|&name| name != NONE).unwrap_or(0);
        debug_assert!(start != NONE, "the triangles have an area in common");
        let mut name = first;
        for _ in 0..6 {
            piece.push(self.corner(name));
            name = usize::from(next[name]);
            if name == first || name >= NAMES {
                break;
            }
        }
        debug_assert_eq!(name, first, "the border is closed");
        piece
    }

    /// The name of the place where an edge of the first triangle meets one of the second. Three lines may
    /// meet in a corner.
    fn crossing(&self, first: usize, second: usize) -> usize {
        let [first_turn, second_turn] = [(first + 1) % 3, (second + 1) % 3];
        for corner in [second, second_turn] {
            if self.of_second[corner][first] == 0 {
                return self.names[corner];
            }
        }
        for corner in [first, first_turn] {
            if self.of_first[corner][second] == 0 {
                return corner;
            }
        }
        CROSSINGS + 3 * first + second
    }

    fn corner(&self, name: usize) -> Corner {
        match name {
            0..OF_SECOND => {
                let rise = rise(&self.second, &self.of_first[name], self.first[name][2]);
                corner_at(&self.first[name], rise)
            }
            OF_SECOND..CROSSINGS => {
                let corner = name - OF_SECOND;
                let rise = rise(&self.first, &self.of_second[corner], self.second[corner][2]);
                corner_at(&self.second[corner], -rise)
            }
            _ => self.corner_at_crossing((name - CROSSINGS) / 3, (name - CROSSINGS) % 3),
        }
    }

    /// The corner where two edges cross. Numerators and their common denominator are integers.
    fn corner_at_crossing(&self, first: usize, second: usize) -> Corner {
        let [first_turn, second_turn] = [(first + 1) % 3, (second + 1) % 3];
        let (a, b) = (self.first[first], self.first[first_turn]);
        let (c, d) = (self.second[second], self.second[second_turn]);
        let (along, end) = (self.of_first[first][second], self.of_first[first_turn][second]);
        let across = self.of_second[second][first];
        let size = along - end;
        let divided = Real::from(size);
        let place = [0, 1].map(|axis| {
            let part = along * i128::from(b[axis] - a[axis]);
            Real::from(part) / divided + Pair(a[axis] as f64, 0.0)
        });
        let rise = i128::from(c[2] - a[2]) * size
            - across * i128::from(d[2] - c[2])
            - along * i128::from(b[2] - a[2]);
        Corner { place, rise: Real::from(rise) / divided }
    }
}

/// A surface minus an elevation, at a place with these sides by the edges of its triangle.
fn rise(triangle: &Triangle, sides: &[i128; 3], z: i64) -> Real {
    let size = sides[0] + sides[1] + sides[2];
    // The side by an edge is the share of the corner opposite.
    let sum = (0..3).map(|edge| sides[edge] * i128::from(triangle[(edge + 2) % 3][2] - z)).sum::<i128>();
    Real::from(sum) / Real::from(size)
}

fn corner_at(&[x, y, _]: &Vertex, rise: Real) -> Corner {
    Corner { place: [x, y].map(|value| Pair(value as f64, 0.0)), rise }
}
