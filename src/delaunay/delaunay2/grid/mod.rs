//! Points on the nodes of a grid, with few tests and no walks.
//!
//! A *grid* has columns and rows at any distances; each point lies in a column and in a row, and most
//! *nodes*, where they cross, have a point. Rasters, gridded soundings and elevation models are such points.
//! The axes of the grid may be turned by 45 degrees.
//!
//! The circle of a *cell* between neighbouring columns and rows has no point inside: between the columns
//! there is none, nor between the rows, and every point inside of the circle is in one of the two. Nor is
//! there any on the circle but the corners. Hence, in the canonical triangulation:
//!
//! 1. A cell with all corners is two triangles. The corner of greatest rank decides the tie: the diagonal
//!    joins its two neighbours. This is the same in all cells.
//! 2. A cell with three corners is the triangle of these and some rest; two corners of a cell are joined by
//!    an edge.
//! 3. So a node without a point, whose four neighbours have points, is in a quadrangle of four edges without
//!    other points. One in-circle test decides its diagonal. Cells and such quadrangles are *covered*.
//! 4. A triangle that is not covered has its corners at points that are not surrounded by covered ones. So
//!    the triangulation of these points alone has that triangle, and the borders of what is covered
//!    ([canonical.md](../../../../docs/theory/canonical.md), section 5): the kernel triangulates them by
//!    insertion, and what is covered is cut out. A point is surrounded if its four neighbours have points or
//!    are in quadrangles.

mod axes;
mod cover;
mod quads;
mod rest;

use super::Triangles;
use super::half_edge::NONE;
use crate::predicates::{Arithmetic, Point2, PredicateCounts};
use axes::{Axes, Frame};
use cover::Cover;
use rest::Rest;

/// Fewer points are triangulated by insertion.
const POINTS_MIN: usize = 9;

/// If more of the points are not surrounded, insertion of all is faster.
const REST_SHARE_MAX: f64 = 0.4;

/// The finder of grids with its buffers.
#[derive(Debug, Default)]
pub(super) struct Grid {
    axes: Axes,
    cover: Cover,
    rest: Rest,
}

impl Grid {
    /// Finds out whether `points` are on a grid whose cells are worth it, and prepares
    /// [`Grid::finish`]. Pushes duplicates to those of `triangles`.
    ///
    /// Cost: if they are on none, usually the time of a few times sqrt(n) points.
    pub(super) fn find(
        &mut self,
        points: &[Point2],
        arithmetic: Arithmetic,
        counts: &mut PredicateCounts,
        duplicates: &mut Vec<[u32; 2]>,
    ) -> bool {
        if points.len() < POINTS_MIN {
            return false;
        }
        let frames = [Frame::Straight, Frame::Diagonal];
        let Some(frame) = frames.into_iter().find(|&frame| self.axes.collect(points, frame)) else {
            return false;
        };
        self.cover.place(points, &self.axes, frame, duplicates);
        self.cover.find_cells(frame);
        arithmetic.run(self.cover.quadrangles(points), counts);
        self.rest.collect(&self.cover, points);
        let is_worth_it = self.rest.points.len() as f64 <= REST_SHARE_MAX * points.len() as f64;
        if !is_worth_it {
            duplicates.clear();
        }
        is_worth_it
    }

    /// The points that are not surrounded by covered ones.
    pub(super) fn rest(&mut self) -> (&[Point2], &mut Triangles) {
        (&self.rest.points, &mut self.rest.triangles)
    }

    /// Writes the triangulation, when that of the rest is complete; `points` is the number of points.
    pub(super) fn finish(&mut self, points: usize, triangles: &mut Triangles) {
        triangles.triangle_of_vertex.clear();
        triangles.triangle_of_vertex.resize(points, NONE);
        let distinct = points - triangles.duplicates.len();
        let words = triangles.memory.allocate(distinct);
        let covered = self.cover.write(words, &mut triangles.triangle_of_vertex);
        let count = self.rest.write(
            &self.cover,
            covered,
            words,
            &mut triangles.triangle_of_vertex,
            &mut triangles.hull,
        );
        triangles.memory.set_count(count);
    }
}
