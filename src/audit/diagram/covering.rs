//! Proves that the cells cover their hull once: exactly one cell contains a test point.

use super::sites::Sites;
use super::space::Independent;
use super::violation::{Claim, Violation};
use spmesh_stream::model::cells4::Point4;

/// A point `o` inside of a cell, and the cells that do not contain it.
///
/// It is a vertex of the cell moved towards four others, infinitely less towards each than towards the one
/// before. So it is in no hyperplane through given points, and lies on the side of the first of these five
/// vertices that is not in the hyperplane.
///
/// Memory: a byte per cell.
#[derive(Debug, Default)]
pub(super) struct Covering {
    five: [u32; 5],
    is_outside: Vec<bool>,
}

impl Covering {
    pub(super) fn new(
        cells: usize,
        sites: &mut Sites,
        points: &[Point4],
        vertices: &[u32],
        number: usize,
    ) -> Result<Self, Violation> {
        let Some(four) = sites.ask(vertices, &Independent) else {
            let message = format!("all vertices of cell {number} lie in a hyperplane");
            return Err(Violation::new(Claim::Spheres, message).of_cells(&[number]).at(points, vertices));
        };
        let [b, c, d, e] = four.map(|i| vertices[i + 1]);
        Ok(Covering { five: [vertices[0], b, c, d, e], is_outside: vec![false; cells] })
    }

    /// Checks that all points lie in a hyperplane, as they must if there are no cells.
    pub(super) fn check_flat(sites: &mut Sites, points: &[Point4]) -> Result<(), Violation> {
        let all: Vec<u32> = (0..).take(points.len()).collect();
        let Some(four) = sites.ask(&all, &Independent) else { return Ok(()) };
        let message = "there are no cells, but the points do not lie in a hyperplane";
        let five: Vec<u32> = std::iter::once(0).chain(four.map(|i| i as u32 + 1)).collect();
        Err(Violation::new(Claim::Covering, message).at(points, &five))
    }

    /// The five points that stand for `o`.
    pub(super) fn inside(&self) -> [u32; 5] {
        self.five
    }

    /// Records on which side of a facet `o` lies. At a facet of the boundary, it must be the side of the
    /// cell.
    pub(super) fn pass(
        &mut self,
        near: usize,
        far: Option<usize>,
        is_near: bool,
        points: &[Point4],
        facet: &[u32],
    ) -> Result<(), Violation> {
        match (is_near, far) {
            (true, Some(far)) => self.is_outside[far] = true,
            (true, None) => (),
            (false, _) => self.is_outside[near] = true,
        }
        if is_near || far.is_some() {
            return Ok(());
        }
        let message = format!("the boundary is not convex: other cells lie beyond its facet of cell {near}");
        let violation = Violation::new(Claim::Boundary, message).of_cells(&[near]);
        Err(violation.at(points, facet).at(points, &self.five))
    }

    /// Checks that exactly one cell contains `o`.
    pub(super) fn check<'a>(
        &self,
        points: &[Point4],
        vertices: impl Fn(usize) -> &'a [u32],
    ) -> Result<(), Violation> {
        let mut around = self.is_outside.iter().enumerate().filter(|(_, is_outside)| !**is_outside);
        let (Some((one, _)), Some((other, _))) = (around.next(), around.next()) else { return Ok(()) };
        let message = format!("cells {one} and {other} overlap");
        let violation = Violation::new(Claim::Covering, message).of_cells(&[one, other]);
        Err(violation.at(points, vertices(one)).at(points, vertices(other)))
    }
}
