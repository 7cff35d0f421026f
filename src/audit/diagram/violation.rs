//! The claims that the audit of a diagram proves, and their violations.

use std::fmt;

use spmesh_stream::model::cells4::Point4;

claims! {
    /// One kind of claim that the audit proves.
    Claim:
    Points "points" "points are finite, distinct and, in a diagram, in lexicographic order"
    Cells "cells" "numbers of vertices and neighbours are in range and increasing, simplices positively oriented"
    Order "order" "cells come in canonical order"
    Vertices "vertices" "every point is a vertex"
    Neighbours "neighbours" "neighbours are mutual, and an infinite cell has one finite neighbour"
    Spheres "spheres" "the vertices of every cell are on one sphere and span space"
    Facets "facets" "what cells share are facets of both, on opposite sides"
    Faces "faces" "the facets of a cell close up"
    Delaunay "delaunay" "spheres are empty: neighbours are outside"
    Boundary "boundary" "the boundary is convex, and its facets are neighbours across their ridges"
    Covering "covering" "the cells cover their hull once"
    Euler "euler" "faces of all dimensions are as many as in a ball"
}

/// The first violation in a diagram or complex.
#[derive(Debug, Clone, PartialEq)]
pub struct Violation {
    /// The claim that does not hold.
    pub claim: Claim,
    /// Describes the violation, with the numbers of the cells and points concerned.
    pub message: String,
    /// The cells concerned.
    pub cells: Vec<u32>,
    /// The points concerned.
    pub vertices: Vec<(u32, Point4)>,
}

impl Violation {
    pub(super) fn new(claim: Claim, message: impl Into<String>) -> Self {
        Violation { claim, message: message.into(), cells: Vec::new(), vertices: Vec::new() }
    }

    pub(super) fn of_cells(mut self, cells: &[usize]) -> Self {
        self.cells.extend(cells.iter().map(|&cell| cell as u32));
        self
    }

    /// Adds the points with these numbers; numbers out of range are left out.
    pub(super) fn at(mut self, points: &[Point4], numbers: &[u32]) -> Self {
        let known = numbers.iter().filter_map(|&number| Some((number, *points.get(number as usize)?)));
        self.vertices.extend(known);
        self
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} check failed: {}", self.claim.name(), self.message)?;
        for (i, (number, [x, y, z, t])) in self.vertices.iter().enumerate() {
            let separator = if i == 0 { ":" } else { "," };
            write!(f, "{separator} {number} at ({x}, {y}, {z}, {t})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Violation {}
