//! Interpolation of rows of values.

use crate::arrays::{array_of_rows, numbers, room_for};
use crate::mesh::{Dimensions, Mesh, in_pieces};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use spmesh_delaunay::delaunay2::Triangulation;
use spmesh_delaunay::delaunay2::interpolation::{Linear, NaturalNeighbours};
use spmesh_delaunay::simplex::weighted_sum;
use spmesh_delaunay::{batch, delaunay3};

/// The natural neighbours of many targets: starts, points, weights.
type Neighbours<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Mesh {
    /// Values at targets by linear interpolation, in rows; the row `fill` where there are none. Nobody may
    /// write to `values` meanwhile.
    fn linear<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'_, f64>,
        fill: Vec<f64>,
        targets: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        match &self.dimensions {
            Dimensions::Two(mesh) => self.interpolate(
                py,
                (&values, &fill),
                &targets,
                || Linear::new(mesh),
                |linear, target, sum| linear.weights(target).map(|weights| sum(&weights)),
            ),
            Dimensions::Three(mesh) => self.interpolate(
                py,
                (&values, &fill),
                &targets,
                || delaunay3::Linear::new(mesh),
                |linear, target, sum| linear.weights(target).map(|weights| sum(&weights)),
            ),
        }
    }

    /// Values at targets by natural neighbours, as of `linear`.
    fn natural<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'_, f64>,
        fill: Vec<f64>,
        targets: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mesh = self.plane()?;
        self.interpolate(
            py,
            (&values, &fill),
            &targets,
            || NaturalNeighbours::new(mesh),
            |natural, target, sum| natural.weights(target).map(sum),
        )
    }

    /// The natural neighbours of targets with their weights: where those of each target start, points,
    /// weights.
    fn natural_weights<'py>(
        &self,
        py: Python<'py>,
        targets: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Neighbours<'py>> {
        let mesh = self.plane()?;
        let (mut starts, mut points, mut weights) = (vec![0i64], Vec::new(), Vec::new());
        in_pieces(py, self.threads, &targets, |targets| {
            let mut found: Vec<Vec<(u32, f64)>> = vec![Vec::new(); targets.len()];
            batch::answer(
                self.threads,
                targets,
                &mut found,
                1,
                || NaturalNeighbours::new(mesh),
                |natural, target, found| {
                    found[0].extend_from_slice(natural.weights(target).unwrap_or_default());
                },
            );
            for of_target in found {
                points.extend(of_target.iter().map(|&(point, _)| point.cast_signed()));
                weights.extend(of_target.iter().map(|&(_, weight)| weight));
                starts.push(points.len() as i64);
            }
        })?;
        Ok((starts.into_pyarray(py), points.into_pyarray(py), weights.into_pyarray(py)))
    }
}

impl Mesh {
    fn plane(&self) -> PyResult<&Triangulation> {
        match &self.dimensions {
            Dimensions::Two(mesh) => Ok(mesh),
            Dimensions::Three(_) => Err(PyValueError::new_err("natural neighbours are those of the plane")),
        }
    }

    /// Sums of the values in the weights of each target. `weigh` gives the weights to the function that it
    /// gets.
    fn interpolate<'py, const D: usize, S>(
        &self,
        py: Python<'py>,
        (values, fill): (&PyReadonlyArray2<'_, f64>, &[f64]),
        targets: &PyReadonlyArray2<'_, f64>,
        begin: impl Fn() -> S + Sync,
        weigh: impl Fn(&mut S, [f64; D], &mut dyn FnMut(&[(u32, f64)])) -> Option<()> + Sync,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = values.shape()[1];
        if values.shape()[0] != self.points_len() || fill.len() != width {
            return Err(PyValueError::new_err(
                "values: one row for each point is needed, and as long a row to fill",
            ));
        }
        let values = numbers(values)?;
        let mut all = room_for(width * targets.shape()[0])?;
        in_pieces(py, self.threads, targets, |targets: &[[f64; D]]| {
            let start = all.len();
            all.extend(fill.iter().cycle().take(width * targets.len()));
            batch::answer(self.threads, targets, &mut all[start..], width, &begin, |state, target, sums| {
                weigh(state, target, &mut |weights| {
                    for (column, sum) in sums.iter_mut().enumerate() {
                        *sum = weighted_sum(weights, |vertex| values[vertex as usize * width + column]);
                    }
                });
            });
        })?;
        array_of_rows(py, all, width)
    }
}
