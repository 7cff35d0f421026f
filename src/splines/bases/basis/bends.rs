//! Where second derivatives of quadratic functions are constant.
//!
//! An element of degree 1 is linear on triangles: its four knots are the corners of a quadrilateral, whose
//! diagonals cross, or one is in the triangle of the others; to that point, the *apex*, each edge of the hull
//! makes a triangle (`linear_simplex`). Functions are products with linear factors, so that their second
//! derivatives there are constant. Those of a function are the sums over all of its elements, almost
//! everywhere: where it has an edge, along collinear knots, there are none.

use super::Basis;
use crate::bases::elements::{Share, hull_edges};
use crate::bases::linear_simplex::slope;
use spmesh_geometry::predicates::{Point2, area};

/// Second derivatives of some functions, as far as they come from one element, on a triangle.
#[derive(Debug, Clone)]
pub(crate) struct Bend {
    /// Counterclockwise.
    pub(crate) corners: [Point2; 3],
    /// By x twice, by x and y, by y twice; in order of functions.
    pub(crate) hessians: Vec<(u32, [f64; 3])>,
}

impl Basis {
    /// The second derivatives of all functions as sums of constants on triangles. Domain: degree 2.
    pub(crate) fn bends(&self) -> impl Iterator<Item = Bend> {
        debug_assert_eq!(self.degree, 2);
        (0..self.elements.len()).flat_map(move |element| {
            let knots = self.elements.knots(element).iter().map(|&id| self.points[id as usize]);
            let knots: Vec<Point2> = knots.collect();
            let edges = hull_edges(&knots);
            let apex = apex(&knots, &edges);
            edges.into_iter().filter_map(move |edge| {
                let corners = [edge[0], edge[1], apex?];
                let slope = slope(&knots, edge)?;
                let gradient = gradient_of_area(edge).map(|part| part * slope);
                let is_flat = area(corners[0], corners[1], corners[2]) <= 0.0;
                (!is_flat).then(|| Bend { corners, hessians: self.hessians(element, gradient) })
            })
        })
    }

    /// Positions of knots by id.
    pub(crate) fn knots(&self) -> &[Point2] {
        &self.points
    }

    /// The corners of the domain, counterclockwise, in plain arithmetic; none if it is empty.
    pub fn domain_corners(&self) -> Vec<Point2> {
        if self.domain.is_empty { Vec::new() } else { self.domain.corners(&self.points) }
    }

    fn hessians(&self, element: usize, gradient: Point2) -> Vec<(u32, [f64; 3])> {
        let mut hessians: Vec<(u32, [f64; 3])> = Vec::with_capacity(3);
        for share in self.elements.shares(element) {
            let slope = self.slope(share);
            let bend = [
                2.0 * slope[0] * gradient[0],
                slope[0] * gradient[1] + slope[1] * gradient[0],
                2.0 * slope[1] * gradient[1],
            ];
            match hessians.last_mut() {
                Some((function, sum)) if *function == share.function => {
                    *sum = [0, 1, 2].map(|place| sum[place] + bend[place]);
                }
                _ => hessians.push((share.function, bend)),
            }
        }
        hessians
    }

    fn slope(&self, share: &Share) -> Point2 {
        gradient_of_area(share.edge.map(|id| self.points[id as usize])).map(|part| part * share.factor)
    }
}

/// The point that is a corner of all triangles.
fn apex(knots: &[Point2], edges: &[[Point2; 2]]) -> Option<Point2> {
    if edges.len() == 3 {
        let mut rest = knots.to_vec();
        for edge in edges {
            let at = rest.iter().position(|&knot| knot == edge[0])?;
            rest.swap_remove(at);
        }
        return rest.first().copied();
    }
    let &[p, q] = edges.first()?;
    let r = edges.iter().find(|edge| edge[0] == q)?[1];
    let s = edges.iter().find(|edge| edge[0] == r)?[1];
    let (of_p, of_r) = (area(p, q, s), area(r, s, q));
    let share = of_p / (of_p + of_r);
    Some([0, 1].map(|axis| p[axis] + share * (r[axis] - p[axis])))
}

/// The gradient of `area(x, a, b)` by x.
fn gradient_of_area([a, b]: [Point2; 2]) -> Point2 {
    [0.5 * (a[1] - b[1]), 0.5 * (b[0] - a[0])]
}
