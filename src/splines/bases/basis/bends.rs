//! Second derivatives of quadratic functions, as constants on triangles.
//!
//! An element of degree 1 is linear on triangles. Its four knots are either the corners of a quadrilateral,
//! whose diagonals cross, or one knot is in the triangle of the others. The crossing, or the inner knot, is
//! the *apex*: each edge of the hull makes a triangle with it (`linear_simplex`). Functions are products of
//! elements with linear factors, so their second derivatives are constant on these triangles. The second
//! derivatives of a function are the sums over all its elements almost everywhere; on its edges, along
//! collinear knots, they do not exist.

use super::Basis;
use crate::bases::elements::{Share, hull_edges};
use crate::bases::linear_simplex::slope;
use spmesh_delaunay::predicates::{Point2, area};

/// The contributions of one element to the second derivatives of its functions, on a triangle.
#[derive(Debug, Clone)]
pub(crate) struct Bend {
    /// Counterclockwise.
    pub(crate) corners: [Point2; 3],
    /// The lines along the sides, each through two knots, with the triangle on their left. Neighbours have
    /// lines with equal ends, whatever the rounding of the apex.
    pub(crate) sides: [[Point2; 2]; 3],
    /// By x twice, by x and y, by y twice; in order of functions.
    pub(crate) hessians: Vec<(u32, [f64; 3])>,
}

impl Basis {
    /// The contributions of all elements to second derivatives, triangle by triangle. Domain: degree 2.
    pub(crate) fn bends(&self) -> impl Iterator<Item = Bend> {
        debug_assert_eq!(self.degree, 2);
        (0..self.elements.len()).flat_map(move |element| {
            let knots = self.elements.knots(element).iter().map(|&id| self.points[id as usize]);
            let knots: Vec<Point2> = knots.collect();
            let edges = hull_edges(&knots);
            let apex = apex(&knots, &edges);
            edges.clone().into_iter().filter_map(move |edge| {
                let corners = [edge[0], edge[1], apex?];
                let beyond = |corner: Point2| if edges.len() == 4 { opposite(&edges, corner) } else { apex };
                let sides = [edge, [edge[1], beyond(edge[1])?], [beyond(edge[0])?, edge[0]]];
                let slope = slope(&knots, edge)?;
                let gradient = gradient_of_area(edge).map(|part| part * slope);
                let is_flat = area(corners[0], corners[1], corners[2]) <= 0.0;
                (!is_flat).then(|| Bend { corners, sides, hessians: self.hessians(element, gradient) })
            })
        })
    }

    /// Positions of knots by id.
    pub(crate) fn knots(&self) -> &[Point2] {
        &self.points
    }

    /// The corners of the domain, counterclockwise, in plain arithmetic; none if the domain is empty.
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

/// The corner of a quadrilateral opposite to a corner: the line between them passes through the apex.
fn opposite(edges: &[[Point2; 2]], corner: Point2) -> Option<Point2> {
    let next = |corner: Point2| edges.iter().find(|edge| edge[0] == corner).map(|edge| edge[1]);
    next(next(corner)?)
}

/// The point that all triangles of an element have as a corner.
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

/// The gradient of `area(x, a, b)` with respect to x.
fn gradient_of_area([a, b]: [Point2; 2]) -> Point2 {
    [0.5 * (a[1] - b[1]), 0.5 * (b[0] - a[0])]
}
