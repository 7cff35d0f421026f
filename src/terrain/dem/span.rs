//! The cells of a row with centres in a triangle.

use std::ops::Range;

use super::axis::{Axis, Place};
use super::search::first;
use spmesh_delaunay::predicates::{Point2, Predicates2, Sign};

/// Half a unit in the last place of one.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// The cells of a row with centres in a closed triangle. The first of them belong to the triangle.
///
/// A centre on an edge or a vertex belongs to the triangle that it would be in after an infinitesimal move to
/// the right and a much smaller one up. There is at most one such triangle; there is none only where the move
/// leads out of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    /// All cells.
    pub(super) cells: Range<u32>,
    /// From here on, centres are on the border of the triangle and belong to another triangle, or to none.
    pub(super) owned_end: u32,
}

/// The edges of a triangle, prepared for all rows.
#[derive(Debug)]
pub(super) struct Edges([Edge; 3]);

#[derive(Debug)]
struct Edge {
    from: Point2,
    to: Point2,
    /// The place of its start among columns, and the change of place per unit of the ordinate.
    start: Place,
    slope: f64,
}

impl Edges {
    /// The edges of a triangle.
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
    /// Domain: the row is within the ordinates of the corners, and `within` is inside their columns.
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
    /// The place where the line of the edge meets a row.
    ///
    /// Error: let u = 2^-53. The relative error is u for differences of ordinates and abscissae, 3u for their
    /// quotient, 5u for its product with the slope of the axis, whose own error is u, and 7u for the distance
    /// from the start. The sum adds u.
    #[inline]
    fn place(&self, y: f64) -> Place {
        let distance = (y - self.from[1]) * self.slope;
        let error = self.start.error + 16.0 * ROUNDING * (distance.abs() + self.start.near.abs());
        Place { near: self.start.near + distance, error }
    }
}

impl Span {
    /// Keeps the cells on the left of an edge, or on it. The interior is on the left; a falling edge has
    /// larger abscissae there.
    #[inline]
    fn cut(&mut self, edge: &Edge, y: f64, columns: &Axis, predicates: &mut impl Predicates2) {
        let Edge { from, to, .. } = *edge;
        if from[1] == to[1] {
            // A centre on an upper edge would move up and out of the triangle.
            if from[0] > to[0] && y == from[1] {
                self.owned_end = 0;
            }
            return;
        }
        let falls = from[1] > to[1];
        let [low, high] = if falls { [to[1], from[1]] } else { [from[1], to[1]] };
        if y < low || y > high || self.cells.is_empty() {
            // The edge does not meet the row; others bound the triangle there.
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
