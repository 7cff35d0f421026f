//! Subdivides cells into simplices that agree on both sides of every face.

use foldhash::{HashMap, HashMapExt};

use super::faces::Faces;
use crate::diagram4::orient4d;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Sign;
use spmesh_stream::model::cells4::{Cells4, Point4};

/// How a face that is no simplex is subdivided. Both rules depend on the vertices of the face only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Each face is the cone from its lexicographically greatest vertex to those of its faces that do not
    /// have it: the vertex is *pulled*. No points are added.
    Pulled,
    /// Each face that is no simplex is the cone from its barycentre, the mean of its vertices, to all of its
    /// faces. The value there is the mean of the values. Unlike the barycentric subdivision proper this
    /// leaves simplices whole, which makes fewer of them (192 instead of 384 for a cube of four dimensions).
    /// All faces of a simplex are simplices, so both sides of a face agree. Unlike pulling, it favours no
    /// direction.
    Barycentric,
}

/// The simplices of subdivided cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subdivision {
    /// The points of the diagram, then the barycentres of faces.
    pub points: Vec<Point4>,
    /// Values of all of them, if those of the diagram have values.
    pub values: Option<Vec<f64>>,
    /// Numbers of points (a, b, c, d, e) with det(b - a, c - a, d - a, e - a) > 0.
    pub simplices: Vec<[u32; 5]>,
    /// Simplices left out because rounded barycentres make them flat. Means of 2, 4, 8 and 16 integers of
    /// moderate size are exact, so that there are none.
    pub flat: u64,
}

/// Subdivides the finite cells that `is_wanted` picks by their vertices.
///
/// Domain: the cells of a Delaunay diagram of the points. Coordinates of barycentres are rounded. If that
/// inverts a very thin simplex, it is written with positive orientation anyway, and overlaps its neighbours
/// by the rounding error.
///
/// Cost: a few microseconds for a cell of 16 vertices, a quarter of a microsecond per simplex.
///
/// # Errors
/// Usage, if there are too many points or simplices to number them in 32 bits.
pub fn subdivide(
    points: &[Point4],
    values: Option<&[f64]>,
    cells: &Cells4,
    rule: Rule,
    is_wanted: impl Fn(&[u32]) -> bool,
) -> Result<Subdivision> {
    let mut work = Work::new(points.to_vec(), values.map(<[f64]>::to_vec), rule);
    for (number, cell) in cells.iter().enumerate().filter(|(_, cell)| !cell.is_infinite) {
        if is_wanted(cell.vertices) {
            work.face(&Faces::of_cell(cells, number))?;
        }
    }
    Ok(work.done)
}

/// The simplices of one cell, barycentric, numbered from its own vertices on.
pub(super) fn subdivide_one(
    points: &[Point4],
    values: &[f64],
    cells: &Cells4,
    number: usize,
) -> Result<Subdivision> {
    let mut cell = Faces::of_cell(cells, number);
    let all = std::mem::take(&mut cell.vertices);
    let local = |vertex: &mut u32| *vertex = all.binary_search(vertex).unwrap_or(0) as u32;
    cell.vertices = (0..all.len() as u32).collect();
    cell.lower.iter_mut().flatten().for_each(local);
    let points = all.iter().map(|&vertex| points[vertex as usize]).collect();
    let values = all.iter().map(|&vertex| values[vertex as usize]).collect();
    let mut work = Work::new(points, Some(values), Rule::Barycentric);
    work.face(&cell)?;
    Ok(work.done)
}

struct Work {
    rule: Rule,
    done: Subdivision,
    /// Apexes of the cones over the current face.
    apexes: Vec<u32>,
    /// Barycentres by the vertices of the face.
    barycentres: HashMap<Vec<u32>, u32>,
}

impl Work {
    fn new(points: Vec<Point4>, values: Option<Vec<f64>>, rule: Rule) -> Work {
        let done = Subdivision { points, values, ..Subdivision::default() };
        Work { rule, done, apexes: Vec::new(), barycentres: HashMap::new() }
    }

    /// Adds the cones over a face.
    fn face(&mut self, face: &Faces) -> Result<()> {
        if face.is_simplex() {
            return self.simplex(&face.vertices);
        }
        let apex = match self.rule {
            Rule::Pulled => face.vertices[face.vertices.len() - 1],
            Rule::Barycentric => self.barycentre(&face.vertices)?,
        };
        self.apexes.push(apex);
        for number in 0..face.lower.len() {
            // The pulled vertex is the greatest, so a face that has it has it last.
            if face.lower[number].last() != Some(&apex) {
                self.face(&face.face(number))?;
            }
        }
        self.apexes.pop();
        Ok(())
    }

    fn simplex(&mut self, base: &[u32]) -> Result<()> {
        let mut simplex = [0; 5];
        simplex.iter_mut().zip(self.apexes.iter().chain(base)).for_each(|(corner, &vertex)| *corner = vertex);
        match orient4d(simplex.map(|vertex| self.done.points[vertex as usize])) {
            Sign::Zero => {
                self.done.flat += 1;
                return Ok(());
            }
            Sign::Negative => simplex.swap(3, 4),
            Sign::Positive => {}
        }
        if self.done.simplices.len() >= u32::MAX as usize {
            return Err(Error::usage("2^32 simplices or more: too many to number them"));
        }
        self.done.simplices.push(simplex);
        Ok(())
    }

    fn barycentre(&mut self, vertices: &[u32]) -> Result<u32> {
        if let Some(&number) = self.barycentres.get(vertices) {
            return Ok(number);
        }
        let number = u32::try_from(self.done.points.len());
        let number = number.map_err(|_| Error::usage("2^32 points or more with barycentres"))?;
        let Subdivision { points, values, .. } = &mut self.done;
        let centre = std::array::from_fn(|axis| mean(vertices, |vertex| points[vertex as usize][axis]));
        points.push(centre);
        if let Some(values) = values {
            values.push(mean(vertices, |vertex| values[vertex as usize]));
        }
        self.barycentres.insert(vertices.to_vec(), number);
        Ok(number)
    }
}

/// The mean of numbers, in the order of the vertices so that it is the same in every cell; exact if all are
/// equal.
fn mean(vertices: &[u32], number: impl Fn(u32) -> f64) -> f64 {
    let first = number(vertices[0]);
    // Halves, so that differences of finite numbers do not overflow.
    let sum: f64 = vertices.iter().map(|&vertex| number(vertex) * 0.5 - first * 0.5).sum();
    first + sum / (vertices.len() as f64 * 0.5)
}
