//! Triangulations of the plane and of space as one class of Python.

use crate::arrays::{array_of, room_for, rows, signed};
use crate::waiting::wait_for;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyOverflowError, PyValueError};
use pyo3::prelude::*;
use spmesh_delaunay::{Error, delaunay2, delaunay3, parallel};
use std::borrow::Cow;
use std::num::NonZeroUsize;

/// Targets that each thread is asked for between two looks at signals.
const TARGETS: usize = 1 << 20;

/// Rows that a thread writes in one go.
const ROWS: usize = 1 << 16;

/// A triangulation.
#[pyclass(frozen, module = "spmesh._native")]
pub(crate) struct Mesh {
    pub(crate) dimensions: Dimensions,
    pub(crate) threads: NonZeroUsize,
}

pub(crate) enum Dimensions {
    Two(delaunay2::Triangulation),
    Three(delaunay3::Tetrahedralization),
}
use Dimensions::{Three, Two};

fn error_of(error: Error) -> PyErr {
    match error {
        Error::TooManyPoints { .. } | Error::TooManyTetrahedra(_) => {
            PyOverflowError::new_err(error.to_string())
        }
        _ => PyValueError::new_err(format!("points: {error}")),
    }
}

#[pymethods]
impl Mesh {
    /// Triangulates an array of two or three columns.
    #[new]
    #[pyo3(signature = (points, threads, progress=None))]
    fn new(
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        threads: NonZeroUsize,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Mesh> {
        // Points are copied, as other threads of Python may write to the array meanwhile.
        let count = points.shape()[0];
        let dimensions = if let Some(points) = rows::<f64, 2>(&points)? {
            let points = points.to_vec();
            wait_for(py, count, progress, |watch| {
                let mut kernel = delaunay2::Kernel::new();
                kernel.watch = Some(watch);
                delaunay2::Triangulation::by(&mut kernel, points).map(Two)
            })
        } else if let Some(points) = rows::<f64, 3>(&points)? {
            let points = points.to_vec();
            wait_for(py, count, progress, |watch| {
                let mut kernel = delaunay3::Kernel::new();
                kernel.threads = threads;
                kernel.watch = Some(watch);
                let mut mesh = delaunay3::Tetrahedralization::default();
                kernel.triangulate(Cow::Owned(points), &mut mesh)?;
                drop(kernel);
                mesh.sort();
                Ok(Three(mesh))
            })
        } else {
            return Err(PyValueError::new_err("points have 2 or 3 columns"));
        };
        Ok(Mesh { dimensions: dimensions?.map_err(error_of)?, threads })
    }

    /// Vertices of each simplex.
    fn simplices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        match &self.dimensions {
            Two(mesh) => {
                let row = |number: usize| mesh.triangles()[number].vertices.map(signed);
                self.rows_of(py, mesh.triangles().len(), row)
            }
            Three(mesh) => {
                let at = |vertex: u32| signed(mesh.vertices()[vertex as usize].index);
                let row = |number: usize| mesh.tetrahedra()[number].vertices.map(at);
                self.rows_of(py, mesh.tetrahedra().len(), row)
            }
        }
    }

    /// Neighbours of each simplex, opposite to its vertices.
    fn neighbors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        let or_none = |number: Option<u32>| number.map_or(-1, signed);
        match &self.dimensions {
            Two(mesh) => {
                let row = |number: usize| mesh.neighbours(number as u32).map(or_none);
                self.rows_of(py, mesh.triangles().len(), row)
            }
            Three(mesh) => {
                let row = |number: usize| mesh.neighbours(number as u32).map(or_none);
                self.rows_of(py, mesh.tetrahedra().len(), row)
            }
        }
    }

    /// Facets of the hull.
    fn hull<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        match &self.dimensions {
            Two(mesh) => array_of(py, mesh.hull().map(|facet| facet.map(signed)).collect()),
            Three(mesh) => array_of(py, mesh.hull().map(|facet| facet.map(signed)).collect()),
        }
    }

    /// Points left out, each with the equal one that is a vertex.
    fn duplicates<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        let duplicates = match &self.dimensions {
            Two(mesh) => mesh.duplicates(),
            Three(mesh) => &mesh.duplicates,
        };
        array_of(py, duplicates.iter().map(|pair| pair.map(signed)).collect())
    }

    /// The simplex that contains each target, or -1.
    fn locate<'py>(
        &self,
        py: Python<'py>,
        targets: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<i32>>> {
        let mut found: Vec<i32> = room_for(targets.shape()[0])?;
        match &self.dimensions {
            Two(mesh) => in_pieces(py, self.threads, &targets, |targets| {
                found.extend(mesh.locate_all(targets, self.threads).into_iter().map(signed))
            })?,
            Three(mesh) => in_pieces(py, self.threads, &targets, |targets| {
                found.extend(mesh.locate_all(targets, self.threads).into_iter().map(signed))
            })?,
        }
        Ok(found.into_pyarray(py))
    }
}

impl Mesh {
    /// Number of points, duplicates included.
    pub(crate) fn points_len(&self) -> usize {
        match &self.dimensions {
            Two(mesh) => mesh.points().len(),
            Three(mesh) => mesh.vertices().len() + mesh.duplicates.len(),
        }
    }

    /// An array with a row for each simplex, made on all threads.
    fn rows_of<'py, const N: usize>(
        &self,
        py: Python<'py>,
        count: usize,
        row: impl Fn(usize) -> [i32; N] + Sync,
    ) -> Bound<'py, PyArray2<i32>> {
        let mut rows = vec![[0; N]; count];
        py.detach(|| {
            let pieces = rows.chunks_mut(ROWS).enumerate();
            parallel::for_each(self.threads, pieces, |(piece, rows)| {
                rows.iter_mut().enumerate().for_each(|(place, to)| *to = row(piece * ROWS + place));
            });
        });
        array_of(py, rows)
    }
}

/// Gives `work` all targets in pieces, without the lock of the interpreter, and looks for signals in between.
pub(crate) fn in_pieces<const D: usize>(
    py: Python<'_>,
    threads: NonZeroUsize,
    targets: &PyReadonlyArray2<'_, f64>,
    mut work: impl FnMut(&[[f64; D]]) + Send,
) -> PyResult<()> {
    let Some(targets) = rows::<f64, D>(targets)? else {
        return Err(PyValueError::new_err(format!("targets have {D} columns, as points")));
    };
    for piece in targets.chunks(TARGETS.saturating_mul(threads.get())) {
        // Other threads of Python may write to the array meanwhile.
        let piece = piece.to_vec();
        py.detach(|| work(&piece));
        py.check_signals()?;
    }
    Ok(())
}
