//! Delaunay diagrams in four dimensions, as made by the engine and carried by streams.

use super::cells4::{Cells4, Point4};

/// A Delaunay diagram in four dimensions, or points alone, without cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Diagram4 {
    /// The points. The points of a diagram are distinct, in lexicographic order, and each is a vertex.
    pub points: Vec<Point4>,
    /// A value for each point, NaN where it is unknown; `None` if the points have no values.
    pub values: Option<Vec<f64>>,
    /// Points of the input that are equal to an earlier one.
    pub merged: u64,
    /// The cells. The engine makes finite cells first and then infinite ones, both in the order of their
    /// vertices; a stream may hold cells in any order. Neighbours are numbers of cells.
    pub cells: Cells4,
}
