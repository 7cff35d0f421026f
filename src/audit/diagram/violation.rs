//! The claims that the audit of a diagram proves, and their violations.

use std::fmt;

use spmesh_stream::model::cells4::Point4;

/// One kind of claim that the audit proves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Claim {
    /// Points are finite, distinct and, in a diagram, in lexicographic order.
    Points,
    /// Numbers of vertices and neighbours are in range and increasing; every simplex is positively oriented.
    Cells,
    /// Cells come in canonical order.
    Order,
    /// Every point is a vertex.
    Vertices,
    /// Neighbours are mutual, and an infinite cell has one finite neighbour.
    Neighbours,
    /// The vertices of every cell are on one sphere and span space.
    Spheres,
    /// What cells share are facets of both, on opposite sides.
    Facets,
    /// The facets of a cell close up.
    Faces,
    /// Spheres are empty: neighbours are outside.
    Delaunay,
    /// The boundary is convex, and its facets are neighbours across their ridges.
    Boundary,
    /// The cells cover their hull once.
    Covering,
    /// Faces of all dimensions are as many as in a ball.
    Euler,
}

impl Claim {
    /// Every claim, in the order of the enumeration.
    pub const ALL: [Claim; 12] = [
        Claim::Points,
        Claim::Cells,
        Claim::Order,
        Claim::Vertices,
        Claim::Neighbours,
        Claim::Spheres,
        Claim::Facets,
        Claim::Faces,
        Claim::Delaunay,
        Claim::Boundary,
        Claim::Covering,
        Claim::Euler,
    ];

    /// Name for people and for JSON.
    pub fn name(self) -> &'static str {
        match self {
            Claim::Points => "points",
            Claim::Cells => "cells",
            Claim::Order => "order",
            Claim::Vertices => "vertices",
            Claim::Neighbours => "neighbours",
            Claim::Spheres => "spheres",
            Claim::Facets => "facets",
            Claim::Faces => "faces",
            Claim::Delaunay => "delaunay",
            Claim::Boundary => "boundary",
            Claim::Covering => "covering",
            Claim::Euler => "euler",
        }
    }
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
