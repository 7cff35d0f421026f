//! Delaunay diagrams in four dimensions, as the engine makes them and streams carry them.

use super::cells4::{Cells4, Point4};

/// A Delaunay diagram in four dimensions; without cells, points alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Diagram4 {
    /// The points. Those of a diagram are distinct, in lexicographic order, and each is a vertex.
    pub points: Vec<Point4>,
    /// A value for each point, NaN where it is unknown; `None` if the points have no values.
    pub values: Option<Vec<f64>>,
    /// Points of the input that are equal to an earlier one.
    pub merged: u64,
    /// The cells: finite ones in the order of their vertices, then infinite ones in that of theirs, if the
    /// engine made them; a stream may hold them in any order. Neighbours are numbers of cells.
    pub cells: Cells4,
}
