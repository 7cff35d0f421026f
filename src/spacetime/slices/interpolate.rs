//! Finds the cell of a site, and interpolates values in it: linear on the simplices of the barycentric
//! subdivision, continuous everywhere.

use super::NO_VALUES;
use super::faces::Faces;
use super::subdivide::{Subdivision, subdivide_one};
use crate::diagram4::orient4d;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::{Cells4, Point4};
use spmesh_stream::model::diagram4::Diagram4;

/// Interpolates the values of a diagram.
///
/// The function is linear on simplices that are cells, and on those of [`super::Rule::Barycentric`] in
/// others. So it is continuous and takes the values of the points exactly. It reproduces linear functions up
/// to rounding.
#[derive(Debug)]
pub struct Interpolator<'a> {
    diagram: &'a Diagram4,
    values: &'a [f64],
    locator: Locator<'a>,
    /// The cell of the last site, and its simplices.
    last: Option<(usize, Subdivision)>,
}

impl<'a> Interpolator<'a> {
    /// An interpolator of this diagram.
    ///
    /// # Errors
    /// Usage, if the points have no values.
    pub fn new(diagram: &'a Diagram4) -> Result<Self> {
        let Some(values) = diagram.values.as_deref() else {
            return Err(Error::usage(NO_VALUES));
        };
        Ok(Interpolator { diagram, values, locator: Locator::new(diagram), last: None })
    }

    /// The value at a site: `None` outside the convex hull of the points, NaN where it depends on an unknown
    /// value.
    ///
    /// Domain: finite coordinates.
    ///
    /// Cost: the walk from the last site, and about 30 nanoseconds per simplex of the cell. Fastest for sites
    /// in spatial order.
    ///
    /// # Errors
    /// Usage, if a cell has too many vertices.
    pub fn value(&mut self, site: Point4) -> Result<Option<f64>> {
        let site = site.map(|x| x + 0.0);
        let order = |point: &Point4| point.partial_cmp(&site).unwrap_or(std::cmp::Ordering::Less);
        if let Ok(vertex) = self.diagram.points.binary_search_by(order) {
            return Ok(Some(self.values[vertex]));
        }
        let Some(cell) = self.locator.locate(site) else { return Ok(None) };
        let pieces = match self.last.take() {
            Some((last, pieces)) if last == cell => pieces,
            _ => subdivide_one(&self.diagram.points, self.values, &self.diagram.cells, cell)?,
        };
        let value = value_in(&pieces, site);
        self.last = Some((cell, pieces));
        Ok(Some(value))
    }
}

/// The value in the simplex whose least barycentric coordinate of the site is greatest: the one that contains
/// the site up to rounding.
fn value_in(pieces: &Subdivision, site: Point4) -> f64 {
    let mut best = (f64::NEG_INFINITY, [0; 5], [0.0; 5]);
    for &simplex in &pieces.simplices {
        let weights = weights(simplex.map(|vertex| pieces.points[vertex as usize]), site);
        let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
        if least > best.0 && weights.iter().all(|weight| weight.is_finite()) {
            best = (least, simplex, weights);
        }
    }
    let (_, simplex, weights) = best;
    let value = |corner: usize| pieces.values.as_ref().map_or(f64::NAN, |v| v[simplex[corner] as usize]);
    let heaviest = (0..5).max_by(|&i, &j| weights[i].total_cmp(&weights[j])).unwrap_or(0);
    // Differences reproduce constants. Values of weight zero are skipped, as they may be NaN.
    let others = (0..5).filter(|&corner| corner != heaviest && weights[corner] != 0.0);
    let base = value(heaviest);
    base + others.map(|corner| weights[corner] * (value(corner) - base)).sum::<f64>()
}

/// Barycentric coordinates by Cramer's rule; not finite for a simplex that is flat to f64.
fn weights(corners: [Point4; 5], site: Point4) -> [f64; 5] {
    let [origin, rest @ ..] = corners;
    let from = |p: Point4| -> Point4 { std::array::from_fn(|axis| p[axis] * 0.5 - origin[axis] * 0.5) };
    let rows = rest.map(from);
    // A power of two, so that products of four are in range, whatever the units.
    let greatest = rows.iter().flatten().fold(0.0f64, |greatest, x| greatest.max(x.abs()));
    let unit = 2f64.powi((1023 - (greatest.to_bits() >> 52) as i32).clamp(-1022, 1023));
    let rows = rows.map(|row| row.map(|x| x * unit));
    let site = from(site).map(|x| x * unit);
    let replaced = |corner: usize| {
        let mut rows = rows;
        rows[corner] = site;
        determinant(rows)
    };
    let volume = determinant(rows);
    let [b, c, d, e] = [0, 1, 2, 3].map(|corner| replaced(corner) / volume);
    [1.0 - (b + c + (d + e)), b, c, d, e]
}

fn determinant([p, q, r, s]: [Point4; 4]) -> f64 {
    let minor = |u: &Point4, v: &Point4, i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    minor(&p, &q, 0, 1) * minor(&r, &s, 2, 3) - minor(&p, &q, 0, 2) * minor(&r, &s, 1, 3)
        + minor(&p, &q, 0, 3) * minor(&r, &s, 1, 2)
        + minor(&p, &q, 1, 2) * minor(&r, &s, 0, 3)
        - minor(&p, &q, 1, 3) * minor(&r, &s, 0, 2)
        + minor(&p, &q, 2, 3) * minor(&r, &s, 0, 1)
}

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
