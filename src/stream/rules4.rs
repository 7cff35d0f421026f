//! The rules of four-dimensional streams that span blocks; the reader, the text twin and the writer share
//! them.

use super::event::Totals;
use super::kind::Kind;
use super::points4::Points4;
use crate::model::cells4::{Cell4, Cells4, Point4};
use spmesh_base::error::{Error, Result};

/// State against which later blocks are checked; only streams of four dimensions are checked.
#[derive(Debug)]
pub(super) struct Rules4 {
    kind: Kind,
    /// The last point, if points must be sorted.
    last: Option<Point4>,
    /// The greatest number of a neighbour so far.
    neighbour_max: Option<u32>,
}

impl Rules4 {
    pub(super) fn new(kind: Kind) -> Self {
        Rules4 { kind, last: None, neighbour_max: None }
    }

    /// Checks and counts points: they are finite, and sorted if the stream holds cells.
    pub(super) fn points(&mut self, points: &Points4, totals: &mut Totals) -> Result<()> {
        for &point in &points.points {
            self.point(point)?;
        }
        let count = if self.kind.has_vertices() { &mut totals.vertices } else { &mut totals.points };
        *count += points.points.len() as u64;
        Ok(())
    }

    /// Checks the next point.
    pub(super) fn point(&mut self, point: Point4) -> Result<()> {
        if let Some(value) = point.iter().find(|value| !value.is_finite()) {
            return Err(Error::malformed(format!("coordinate {value} is not finite")));
        }
        if self.kind == Kind::Cells4 {
            // All points are comparable, because coordinates are finite; -0 equals 0.
            if self.last.is_some_and(|last| last.partial_cmp(&point) != Some(std::cmp::Ordering::Less)) {
                return Err(Error::malformed(format!(
                    "point {point:?} does not follow the one before it in the order of x, y, z, t"
                )));
            }
            self.last = Some(point);
        }
        Ok(())
    }

    /// Checks and counts cells.
    pub(super) fn cells(&mut self, cells: &Cells4, totals: &mut Totals) -> Result<()> {
        cells.iter().try_for_each(|cell| self.cell(cell, totals))
    }

    /// Checks and counts a cell.
    pub(super) fn cell(&mut self, cell: Cell4, totals: &mut Totals) -> Result<()> {
        check_cell(cell, totals.vertices)?;
        self.neighbour_max = self.neighbour_max.max(cell.neighbours.last().copied());
        totals.simplices += 1;
        Ok(())
    }

    /// Checks and counts simplices: each has five different points.
    pub(super) fn simplices(&mut self, simplices: &[[u32; 5]], totals: &mut Totals) -> Result<()> {
        for simplex in simplices {
            if let Some(vertex) = simplex.iter().find(|&&vertex| u64::from(vertex) >= totals.vertices) {
                return Err(Error::malformed(format!("simplex uses vertex {vertex} of {}", totals.vertices)));
            }
            if (1..5).any(|i| simplex[..i].contains(&simplex[i])) {
                return Err(Error::malformed(format!("simplex {simplex:?} uses a vertex twice")));
            }
        }
        totals.simplices += simplices.len() as u64;
        Ok(())
    }

    /// Checks that all neighbours are among the cells counted in `totals`.
    pub(super) fn check_end(&self, totals: &Totals) -> Result<()> {
        match self.neighbour_max {
            Some(neighbour) if u64::from(neighbour) >= totals.simplices => Err(Error::malformed(format!(
                "END: a cell has the neighbour {neighbour} of {} cells",
                totals.simplices
            ))),
            _ => Ok(()),
        }
    }
}

/// Checks the number of vertices of a cell; `points` points came before.
///
/// # Errors
/// Malformed, if they are too few for a cell, or more than the points.
pub fn check_vertex_count(is_infinite: bool, vertices: u64, points: u64) -> Result<()> {
    let (sort, vertices_min) = if is_infinite { ("an infinite", 4) } else { ("a finite", 5) };
    if vertices < vertices_min {
        return Err(Error::malformed(format!(
            "{sort} cell of {vertices} vertices, expected at least {vertices_min}"
        )));
    }
    if vertices > points {
        return Err(Error::malformed(format!("{sort} cell of {vertices} vertices, but {points} points")));
    }
    Ok(())
}

/// Checks the number of neighbours of a cell: the cell has no more facets, by the upper bound theorem for
/// polytopes of four dimensions. The faraway point counts as a vertex.
///
/// # Errors
/// Malformed, if there are more neighbours than facets.
pub fn check_neighbour_count(is_infinite: bool, vertices: u64, neighbours: u64) -> Result<()> {
    let corners = vertices + u64::from(is_infinite);
    let facets_max = corners.saturating_mul(corners.saturating_sub(3)) / 2;
    if neighbours <= facets_max {
        return Ok(());
    }
    Err(Error::malformed(format!(
        "cell of {vertices} vertices and {neighbours} neighbours, which can have {facets_max} facets at most"
    )))
}

/// Checks one cell; `points` points came before.
pub(super) fn check_cell(cell: Cell4, points: u64) -> Result<()> {
    let Cell4 { is_infinite, vertices, neighbours } = cell;
    check_vertex_count(is_infinite, vertices.len() as u64, points)?;
    check_neighbour_count(is_infinite, vertices.len() as u64, neighbours.len() as u64)?;
    if !is_increasing(vertices) || vertices.last().is_some_and(|&vertex| u64::from(vertex) >= points) {
        return Err(Error::malformed(format!(
            "the vertices of a cell are not increasing numbers of {points} points"
        )));
    }
    if !is_increasing(neighbours) {
        return Err(Error::malformed("the neighbours of a cell are not increasing"));
    }
    Ok(())
}

fn is_increasing(numbers: &[u32]) -> bool {
    numbers.windows(2).all(|pair| pair[0] < pair[1])
}
