//! Which cells of a row have their centres in a triangle.

use std::ops::Range;

use super::axis::{Axis, Place};
use super::search::first;
use spmesh_geometry::predicates::{Point2, Predicates2, Sign};

/// Half a unit in the last place of one.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// The cells of a row with centres in a closed triangle; the first ones belong to it.
///
/// A centre that is on an edge or a vertex belongs to the triangle that it would be in if it moved to the right by an infinitesimal,
/// and up by a much smaller one. There is at most one such triangle, and none only where that way leads out of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    /// All cells.
    pub(super) cells: Range<u32>,
    /// From here on, centres are on the border of the triangle and belong to another one, or to none.
    pub(super) owned_end: u32,
}

/// The edges of a triangle, with what all rows need to know of them.
#[derive(Debug)]
pub(super) struct Edges([Edge; 3]);

#[derive(Debug)]
struct Edge {
    from: Point2,
    to: Point2,
    /// The place of its start among columns, and by how much that changes by unit of the ordinate.
    start: Place,
    slope: f64,
}

impl Edges {
    /// Those of a triangle.
    ///
    /// Domain: corners counterclockwise.
    #[inline]
    pub(super) fn of([a, b, c]: [Point2; 3], columns: &Axis) -> Edges {
        Edges([[a, b], [b, c], [c, a]].map(|[from, to]| Edge {
            from,
            to,
            start: columns.place(from[0]),
            slope: (to[0] - from[0]) / (to[1] - from[1]) * columns.slope(),
        }))
    }

    /// The cells of a row among `within`; `y` is the ordinate of its centres.
    ///
    /// Domain: the row not above or below all corners, and no column of its cells beside all of them.
    #[inline]
    pub(super) fn span(
        &self,
        y: f64,
        within: Range<u32>,
        columns: &Axis,
        predicates: &mut impl Predicates2,
    ) -> Span {
        let mut span = Span { owned_end: within.end, cells: within };
        for edge in &self.0 {
            span.cut(edge, y, columns, predicates);
        }
        span.cells.end = span.cells.end.max(span.cells.start);
        span.owned_end = span.owned_end.clamp(span.cells.start, span.cells.end);
        span
    }
}

impl Edge {
    /// Where the line of the edge meets a row.
    ///
    /// Error: differences of ordinates and abscissae are off by u = 2^-53 of themselves, their quotient by 3u, the product with the
    /// slope of the axis, which is off by u, by 5u, and the distance from the start by 7u, plus u of the sum.
    #[inline]
    fn place(&self, y: f64) -> Place {
        let distance = (y - self.from[1]) * self.slope;
        let error = self.start.error + 16.0 * ROUNDING * (distance.abs() + self.start.near.abs());
        Place { near: self.start.near + distance, error }
    }
}

impl Span {
    /// Leaves what is on the left of an edge, or on it. The interior is on the left: on the right side of edges that fall.
    #[inline]
    fn cut(&mut self, edge: &Edge, y: f64, columns: &Axis, predicates: &mut impl Predicates2) {
        let Edge { from, to, .. } = *edge;
        if from[1] == to[1] {
            // Between its ends, an upper edge has nothing above that would belong to the triangle.
            if from[0] > to[0] && y == from[1] {
                self.owned_end = 0;
            }
            return;
        }
        let falls = from[1] > to[1];
        let [low, high] = if falls { [to[1], from[1]] } else { [from[1], to[1]] };
        if y < low || y > high || self.cells.is_empty() {
            // In a row that an edge does not meet, others bound the triangle.
            return;
        }
        let place = edge.place(y);
        if let Some(cell) = place.first_cell(self.cells.clone()) {
            predicates.counts_mut().filter += 1;
            if falls {
                self.cells.start = cell;
            } else {
                self.cells.end = cell;
            }
            return;
        }
        let mut side = |column| predicates.orient2d(from, to, [columns.at(column), y]);
        if falls {
            self.cells.start = first(self.cells.clone(), place.near, |column| side(column) != Sign::Negative);
        } else {
            let on_edge = first(self.cells.clone(), place.near, |column| side(column) != Sign::Positive);
            self.owned_end = self.owned_end.min(on_edge);
            let rest = on_edge..self.cells.end;
            self.cells.end = first(rest, f64::from(on_edge), |column| side(column) == Sign::Negative);
        }
    }
}
