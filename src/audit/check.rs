//! The checks of an audit, their counts, and the first violation.

use spmesh_base::error::{Error, ErrorKind};
use spmesh_stream::Header;
use spmesh_stream::model::bounds::Point;

claims! {
    /// One kind of claim that an audit proves.
    Check:
    Orientation "orientation" "every simplex is positively oriented, none is flat"
    Edges "edges" "every directed edge belongs to one triangle"
    Facets "facets" "every oriented facet belongs to one tetrahedron"
    Delaunay "delaunay" "every interior edge or facet is locally Delaunay"
    ConstrainedDelaunay "constrained" "every interior edge that is on no segment is locally Delaunay"
    Canonical "canonical" "cocircular or cospherical points are triangulated canonically"
    Hidden "hidden" "vertices of no tetrahedron have an empty cell: others around them are heavier"
    Vertices "vertices" "the simplices of every vertex close around it, or up to the hull"
    Finalization "finalization" "no vertex is used after its finalization"
    Hull "hull" "the boundary is convex, closed, and goes around once"
    Border "border" "the boundary does not meet itself, and its edges are those that cutting leaves"
    Constraints "segments" "segments are chains of edges, or named as open, and meet at ends only"
    Euler "euler" "simplices of all dimensions are as many as in a disk or ball"
    Counts "counts" "vertices, merged and unwritten points are all points"
    Bounds "bounds" "the bounding box holds all points"
    Points "points" "the vertices are where the given points are"
    Within "within" "every given point is at most so far above or below the surface"
    Labels "labels" "all vertices have a label or none has, and it follows its vertex"
    Region "region" "every point lies in the region of the stream"
    Cells "cells" "no point follows the tag of its cell, every tag is news"
    Chunks "chunks" "the points between two runs of tags lie in one cell, which the second run tags"
    Residual "residual" "the residual is what is not final, each point once"
    Walls "walls" "the walls are the open edges or facets of the final simplices"
}

impl Check {
    /// The claim that the check proves.
    pub fn claim(self) -> &'static str {
        self.row().1
    }
}

/// How often each check was made.
#[derive(Debug, Clone, Default)]
pub(super) struct Ledger {
    tallies: [Option<Tally>; Check::ALL.len()],
}

#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    tests: u64,
    exactly: u64,
}

impl Ledger {
    /// A ledger with a line for each of `checks`, even if there is nothing to test.
    pub(super) fn of(checks: &[Check]) -> Self {
        let mut ledger = Ledger::default();
        checks.iter().for_each(|&check| ledger.tallies[check as usize] = Some(Tally::default()));
        ledger
    }

    /// Adds one test, and whether the filter left it to exact arithmetic.
    pub(super) fn count(&mut self, check: Check, exactly: bool) {
        let tally = self.tallies[check as usize].get_or_insert_default();
        tally.tests += 1;
        tally.exactly += u64::from(exactly);
    }

    /// Adds tests that need no arithmetic.
    pub(super) fn add(&mut self, check: Check, tests: u64) {
        self.tallies[check as usize].get_or_insert_default().tests += tests;
    }

    /// The checks that were made; all passed unless `violation` says otherwise.
    pub(super) fn lines(&self, violation: Option<&Violation>) -> Vec<CheckLine> {
        let line = |check: Check| {
            let tally = self.tallies[check as usize]?;
            let passed = violation.is_none_or(|violation| violation.check != check);
            Some(CheckLine { check, passed, tests: tally.tests, exactly: tally.exactly })
        };
        Check::ALL.into_iter().filter_map(line).collect()
    }
}

/// One line of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CheckLine {
    /// What was checked.
    pub check: Check,
    /// Whether no test failed.
    pub passed: bool,
    /// Number of tests made.
    pub tests: u64,
    /// Number of tests that the floating-point filter left to exact arithmetic.
    pub exactly: u64,
}

/// The first violation in a stream.
#[derive(Debug, Clone, PartialEq)]
pub struct Violation {
    /// The check that failed.
    pub check: Check,
    /// Describes the violation, with the ids of the vertices concerned.
    pub message: String,
    /// The vertices or points concerned, each with its id where it has one, in stored coordinates.
    pub vertices: Vec<(Option<u64>, Point)>,
}

impl Violation {
    pub(super) fn new(check: Check, message: impl Into<String>) -> Self {
        Violation { check, message: message.into(), vertices: Vec::new() }
    }

    pub(super) fn with(mut self, id: impl Into<Option<u64>>, at: Point) -> Self {
        self.vertices.push((id.into(), at));
        self
    }

    /// The violation as an error, with the geometry in world coordinates of the stream's `header`.
    pub fn to_error(&self, header: &Header) -> Error {
        let mut message = format!("{} check failed: {}", self.check.name(), self.message);
        for (i, &(id, stored)) in self.vertices.iter().enumerate() {
            let world = header.coordinates.to_decimal(stored);
            let world: Vec<String> = world[..usize::from(header.dims)].iter().map(f64::to_string).collect();
            let name = id.map_or("point".to_string(), |id| id.to_string());
            let separator = if i == 0 { ":" } else { "," };
            message += &format!("{separator} {name} at ({})", world.join(", "));
        }
        Error::new(ErrorKind::Audit, message)
    }
}
