//! The circle of a triangle, and boxes of cells that are certainly outside of it.
//!
//! The error bounds: docs/theory/constrained.md, section 7.

use super::cells::CELLS_MAX;
use super::hull::KnownHull;
use spmesh_delaunay::cell_tree::{CellBox, Grid};
use spmesh_delaunay::predicates::circle::{self, CircleBounds, Disk};
use spmesh_stream::model::points::Point2;

/// More than all roundings between a corner of a triangle and a vertex of the network in units of cells, as a
/// part of their coordinates.
const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// More than the few roundings of a length.
const SLACK: f64 = 1.0 + 16.0 * f64::EPSILON;

/// A centre with a greater error, as a part of the radius, is left aside: the power of places tells more.
const CENTRE_ERROR_MAX: f64 = 1.0 / (1u64 << 20) as f64;

/// The circle of a triangle. Unit: stored units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    /// The first corner of the triangle.
    corner: Point2,
    /// Seen from this corner; `None` where nothing is known of it.
    exact: Option<circle::Circle>,
    /// If its centre is known well.
    disk: Option<Disk>,
}

impl Circle {
    /// The circle through the corners of a triangle, which are counterclockwise.
    #[inline]
    pub(super) fn of([a, b, c]: [Point2; 3]) -> Circle {
        let exact = CircleBounds::FLOAT.circle(a, b, c);
        let is_known = |disk: &Disk| disk.errors[0] + disk.errors[1] < CENTRE_ERROR_MAX * disk.radius;
        Circle { corner: a, exact, disk: exact.and_then(|circle| circle.disk()).filter(is_known) }
    }

    /// Whether it is well inside of the hull of the mesh.
    #[inline]
    pub(super) fn is_within(&self, hull: &KnownHull) -> bool {
        self.disk.is_some_and(|disk| {
            let centre = [0, 1].map(|axis| self.corner[axis] + disk.centre[axis]);
            hull.contains(centre, disk.radius + disk.errors[0] + disk.errors[1])
        })
    }

    /// The circle among the cells of a grid.
    #[inline]
    pub(super) fn among(&self, grid: &Grid) -> CellCircle {
        let (corner, scale) = (grid.local(self.corner), grid.scale);
        let margin = ROUNDINGS * (corner[0].abs() + corner[1].abs() + CELLS_MAX);
        let disk = self.disk.map(|disk| {
            let radius = (disk.radius + (disk.errors[0] + disk.errors[1])) * scale * SLACK + 2.0 * margin;
            ([0, 1].map(|axis| corner[axis] + disk.centre[axis] * scale), radius)
        });
        CellCircle { exact: self.exact, scale, corner, margin, disk }
    }
}

/// The circle of a triangle among cells. Unit: cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellCircle {
    /// In stored units; `None` where nothing is known of it.
    exact: Option<circle::Circle>,
    scale: f64,
    /// The first corner of the triangle.
    corner: Point2,
    /// How far rounding moves a vertex of the network from the triangle, at most, along an axis.
    margin: f64,
    /// Centre and radius of a disk that has all vertices of the network that are inside of the circle, if its
    /// centre is known well.
    disk: Option<(Point2, f64)>,
}

impl CellCircle {
    /// A box around the disk, perhaps without sides.
    #[inline]
    pub(super) fn bounds(&self) -> CellBox {
        let Some((centre, radius)) = self.disk else {
            return CellBox { min: [0.0; 2], max: [f64::INFINITY; 2] };
        };
        CellBox { min: centre.map(|x| x - radius), max: centre.map(|x| x + radius) }
    }

    /// Whether a box of cells may have a vertex inside of the circle.
    pub(super) fn may_meet(&self, bounds: &CellBox) -> bool {
        let Some((centre, radius)) = self.disk else {
            let seen = |place: Point2, margin: f64| {
                [0, 1].map(|axis| (place[axis] - self.corner[axis] + margin) / self.scale)
            };
            let seen = [seen(bounds.min, -self.margin), seen(bounds.max, self.margin)];
            return !self.exact.is_some_and(|circle| circle.misses(seen));
        };
        let [x, y] = [0, 1].map(|axis| centre[axis] - centre[axis].clamp(bounds.min[axis], bounds.max[axis]));
        x * x + y * y <= radius * radius
    }
}
