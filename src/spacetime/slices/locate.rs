//! Finds the cell of a site.

use super::faces::Faces;
use crate::diagram4::orient4d;
use spmesh_stream::model::cells4::{Cells4, Point4};
use spmesh_stream::model::diagram4::Diagram4;

/// Finds cells by walking from the one that was found last.
#[derive(Debug)]
pub struct Locator<'a> {
    points: &'a [Point4],
    cells: &'a Cells4,
    current: usize,
    /// Cells visited so far.
    pub visited: u64,
}

impl<'a> Locator<'a> {
    /// Starts at the first cell.
    pub fn new(diagram: &'a Diagram4) -> Self {
        Locator { points: &diagram.points, cells: &diagram.cells, current: 0, visited: 0 }
    }

    /// The number of a finite cell that contains the site, inside or on its border; `None` outside the convex
    /// hull.
    ///
    /// Domain: finite coordinates. The signs are exact, so the walk ends: across a facet, the site has less
    /// power with respect to the sphere of the next cell, because the points of equal power are the
    /// hyperplane of the facet. So no cell is visited twice. Sites on the border of the hull are inside.
    ///
    /// Cost: a few microseconds per visited cell.
    pub fn locate(&mut self, site: Point4) -> Option<usize> {
        if self.cells.is_empty() || self.cells.get(0).is_infinite {
            return None;
        }
        loop {
            self.visited += 1;
            let Some(beyond) = self.beyond(site) else { return Some(self.current) };
            if self.cells.get(beyond).is_infinite {
                return None;
            }
            self.current = beyond;
        }
    }

    /// The cell across a facet of the current one that separates it from the site.
    fn beyond(&self, site: Point4) -> Option<usize> {
        let faces = Faces::of_cell(self.cells, self.current);
        let neighbours = self.cells.get(self.current).neighbours;
        let at = |vertex: u32| self.points[vertex as usize];
        let separates = |facet: usize| {
            faces.frame(facet).is_some_and(|(four, apex)| {
                let [a, b, c, d] = four.map(at);
                let (own, other) = (orient4d([a, b, c, d, at(apex)]), orient4d([a, b, c, d, site]));
                own as i8 * other as i8 == -1
            })
        };
        (0..neighbours.len()).find(|&facet| separates(facet)).map(|facet| neighbours[facet] as usize)
    }
}
