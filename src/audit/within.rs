//! Whether the vertices of a mesh are among given points, and all others near its surface.

use std::cmp::Ordering;

use super::check::{Check, Ledger, Violation};
use super::exact::plane::{distance_to, orientation};
use super::point_set::same_positions;
use super::point_tree::PointTree;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, LiveVertices, Patch};

/// Points, how far from a surface they may be, and which of them it has been compared with.
///
/// Memory: 48 bytes a point.
pub struct NearPoints {
    points: Vec<Point>,
    tree: PointTree<2>,
    /// Units: stored ones.
    tolerance: f64,
    is_found: Vec<bool>,
    live: LiveVertices<Point>,
}

impl NearPoints {
    /// Points in stored coordinates of this encoding, and the greatest vertical distance in the world.
    ///
    /// # Errors
    /// Usage, if the mesh, of the encoding `mesh`, stores its coordinates in another way, or there are more
    /// than 2^32 points.
    pub fn new(
        coordinates: Coordinates,
        points: Vec<Point>,
        mesh: &Coordinates,
        tolerance: f64,
    ) -> Result<NearPoints> {
        if !same_positions(&coordinates, mesh, 3) {
            return Err(Error::usage(
                "the points have another coordinate type, scale or offset than the mesh: cannot compare",
            ));
        }
        if points.len() > u32::MAX as usize {
            return Err(Error::usage("more than 2^32 points to compare with: audit parts of the surface"));
        }
        let tolerance = match coordinates {
            Coordinates::I32 { scale, .. } => tolerance / scale[2],
            Coordinates::F64 => tolerance,
        };
        let tree = PointTree::new(points.iter().map(|&[x, y, _]| [x, y]));
        let (is_found, live) = (vec![false; points.len()], LiveVertices::new());
        Ok(NearPoints { points, tree, tolerance, is_found, live })
    }

    /// Compares the vertices and triangles of a patch with the points.
    pub(super) fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> std::result::Result<(), Violation> {
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.vertex(id, at, ledger)?;
        }
        let entered = self.live.enter(patch, |_, at| at);
        let local = entered.map_err(|error| Violation::new(Check::Finalization, error.to_string()))?.to_vec();
        for triangle in patch.triangles() {
            self.triangle(triangle.map(|corner| local[corner as usize]), ledger)?;
        }
        Ok(())
    }

    /// Proves that a vertex is one of the points.
    fn vertex(&mut self, id: u64, at: Point, ledger: &mut Ledger) -> std::result::Result<(), Violation> {
        ledger.add(Check::Points, 1);
        let ([x, y, z], mut is_there) = (at, false);
        let NearPoints { points, tree, is_found, .. } = self;
        let Ok(()) = tree.in_box([x, y], [x, y], |_, number| {
            if points[number as usize][2] == z {
                is_found[number as usize] = true;
                is_there = true;
            }
            Ok::<(), std::convert::Infallible>(())
        });
        if is_there {
            return Ok(());
        }
        let message = "a vertex is at the position and elevation of no given point";
        Err(Violation::new(Check::Points, message).with(id, at))
    }

    /// Proves that the points in a triangle are near it.
    fn triangle(
        &mut self,
        corners: [(u64, Point); 3],
        ledger: &mut Ledger,
    ) -> std::result::Result<(), Violation> {
        let places = corners.map(|(_, [x, y, _])| [x, y]);
        let [low, high] = [f64::min, f64::max]
            .map(|end| [0, 1].map(|axis| places.iter().map(|at| at[axis]).reduce(end).unwrap_or(0.0)));
        let NearPoints { points, tree, is_found, tolerance, .. } = self;
        tree.in_box(low, high, |at, number| {
            let (number, [a, b, c]) = (number as usize, places);
            let is_outside = |p, q| orientation(p, q, at).sign == Ordering::Less;
            if is_found[number] || is_outside(a, b) || is_outside(b, c) || is_outside(c, a) {
                return Ok(());
            }
            let distance = distance_to(corners.map(|(_, corner)| corner), points[number], *tolerance);
            ledger.count(Check::Within, distance.exactly);
            if distance.sign == Ordering::Greater {
                let [a, b, c] = corners.map(|(id, _)| id);
                let message = format!(
                    "a given point is farther than that from triangle ({a}, {b}, {c}) below or above it"
                );
                return Err(Violation::new(Check::Within, message).with(None, points[number]));
            }
            is_found[number] = true;
            Ok(())
        })
    }

    /// Proves that all points were met.
    pub(super) fn check_complete(&self) -> std::result::Result<(), Violation> {
        let Some(number) = self.is_found.iter().position(|is_found| !is_found) else { return Ok(()) };
        let message = "a given point is in no triangle";
        Err(Violation::new(Check::Within, message).with(None, self.points[number]))
    }
}
