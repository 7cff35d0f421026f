//! Which cells of a row have their centres in a triangle.

use std::ops::Range;

use super::centers::Centers;
use super::search::first;
use crate::predicates::{Point2, Predicates2, Sign};

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

impl Span {
    /// The cells of a row among `columns`.
    ///
    /// Domain: corners counterclockwise, and the row not above or below all of them.
    pub(super) fn of(
        corners: [Point2; 3],
        columns: Range<u32>,
        y: f64,
        centers: &Centers,
        predicates: &mut impl Predicates2,
    ) -> Span {
        let mut span = Span { owned_end: columns.end, cells: columns };
        let [a, b, c] = corners;
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if span.cells.is_empty() {
                break;
            }
            span.cut([from, to], y, centers, predicates);
        }
        span.owned_end = span.owned_end.clamp(span.cells.start, span.cells.end.max(span.cells.start));
        span
    }

    /// Leaves what is on the left of an edge, or on it. The interior is on the left: on the right side of edges that fall.
    fn cut(&mut self, [a, b]: [Point2; 2], y: f64, centers: &Centers, predicates: &mut impl Predicates2) {
        if a[1] == b[1] {
            // Between its ends, an upper edge has nothing above that would belong to the triangle.
            if a[0] > b[0] && y == a[1] {
                self.owned_end = 0;
            }
            return;
        }
        let mut side = |column| predicates.orient2d(a, b, [centers.x(column), y]);
        let near = centers.column_near(a[0] + (y - a[1]) * ((b[0] - a[0]) / (b[1] - a[1])));
        let cells = self.cells.clone();
        if a[1] > b[1] {
            self.cells.start = first(cells, near, |column| side(column) != Sign::Negative);
        } else {
            let on_edge = first(cells.clone(), near, |column| side(column) != Sign::Positive);
            self.owned_end = self.owned_end.min(on_edge);
            let end = on_edge..cells.end;
            self.cells.end = first(end, f64::from(on_edge), |column| side(column) == Sign::Negative);
        }
    }
}
