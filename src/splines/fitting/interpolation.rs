//! Interpolation at Greville sites: one value for each function.

use super::mesh::Mesh;
use crate::bases::{Basis, Scratch};
use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_delaunay::predicates::Point2;

/// The greatest condition that leaves correct digits: equations beyond are treated as singular.
const CONDITION_MAX: f64 = 1e14;
/// Steps of the estimate of a norm; it nearly always converges in two.
const STEPS: usize = 5;
/// Up to this number of functions, the condition in the 2-norm is computed; this takes a full matrix.
const FULL_MAX: usize = 2_000;

/// The square equations of interpolation, factored.
pub struct Interpolation<'a> {
    basis: &'a Basis,
    /// For each site, the functions that are alive there with their values, concatenated.
    offsets: Vec<usize>,
    functions: Vec<usize>,
    values: Vec<f64>,
    /// Factors of the transposed matrix, whose columns are sites.
    factors: Lu<usize, f64>,
}

impl<'a> Interpolation<'a> {
    /// The equations of a basis.
    ///
    /// Cost: a sparse LU factorisation.
    ///
    /// # Errors
    /// Two sites at one place, a function that is zero at all sites, or functions that depend on each other
    /// at the sites, each with its place; not enough memory.
    pub fn new(basis: &'a Basis) -> Result<Interpolation<'a>> {
        let (mut offsets, mut functions, mut values) = (vec![0], Vec::new(), Vec::new());
        let mut scratch = Scratch::default();
        for site in 0..basis.len() {
            for &(function, value) in basis.at(basis.greville(site), &mut scratch) {
                functions.push(function as usize);
                values.push(value);
            }
            offsets.push(functions.len());
        }
        check_sites(basis, &functions, &values).map_err(|error| narrow(basis).unwrap_or(error))?;
        let count = basis.len();
        let pattern = SymbolicSparseColMatRef::new_checked(count, count, &offsets, None, &functions);
        let singular = || {
            let what = "functions depend on each other at Greville sites: use least squares, or move knots";
            narrow(basis).unwrap_or_else(|| Error::usage(what))
        };
        let symbolic = SymbolicLu::try_new(pattern).map_err(|_| too_large(count))?;
        let matrix = SparseColMatRef::new(pattern, &values);
        let factors = Lu::try_new_with_symbolic(symbolic, matrix).map_err(|_| singular())?;
        let interpolation = Interpolation { basis, offsets, functions, values, factors };
        interpolation.check_condition().map_err(|error| narrow(basis).unwrap_or(error))?;
        Ok(interpolation)
    }

    /// Coefficients of the spline that has a function's values at Greville sites.
    ///
    /// # Errors
    /// A value that is not finite, with its place.
    pub fn of_function(&self, mut f: impl FnMut(Point2) -> f64) -> Result<Vec<f64>> {
        self.of_values(&(0..self.basis.len()).map(|site| f(self.basis.greville(site))).collect::<Vec<f64>>())
    }

    /// Coefficients of the spline that has these values at Greville sites, in the order of functions.
    ///
    /// # Errors
    /// Another number of values than functions; a value that is not finite, with its place.
    pub fn of_values(&self, values: &[f64]) -> Result<Vec<f64>> {
        if values.len() != self.basis.len() {
            let (found, needed) = (values.len(), self.basis.len());
            return Err(Error::usage(format!("{found} values for {needed} functions: one each is needed")));
        }
        if let Some(bad) = values.iter().position(|value| !value.is_finite()) {
            let [x, y] = self.basis.greville(bad);
            let what = format!("value is not finite: {}", values[bad]);
            return Err(Error::malformed(what).at(format!("site {x} {y}")));
        }
        let mut coefficients = self.solve(values.to_vec());
        // One step of refinement, because partial pivoting may lose a digit or two.
        let product = self.times(&coefficients);
        let residual = values.iter().zip(product).map(|(value, found)| value - found).collect();
        coefficients.iter_mut().zip(self.solve(residual)).for_each(|(c, step)| *c += step);
        Ok(coefficients)
    }

    /// Coefficients of the spline that interpolates a mesh at Greville sites: its values are those of the
    /// function that is linear on the triangles of the mesh and has these values at its points.
    ///
    /// # Errors
    /// Another number of values than points; sites outside of the hull of the points, with their number and
    /// the place of the first one; a value that is not finite.
    pub fn of_points(&self, mesh: &Mesh, values: &[f64]) -> Result<Vec<f64>> {
        if values.len() != mesh.points().len() {
            let (found, needed) = (values.len(), mesh.points().len());
            return Err(Error::usage(format!("{found} values for {needed} points: one each is needed")));
        }
        let mut near = 0;
        let sites: Vec<Point2> = (0..self.basis.len()).map(|site| self.basis.greville(site)).collect();
        let found: Vec<Option<f64>> =
            sites.iter().map(|&site| mesh.interpolate(values, site, &mut near)).collect();
        let mut outside = sites.iter().zip(&found).filter(|(_, value)| value.is_none());
        if let Some(([x, y], _)) = outside.next() {
            let what = format!(
                "{} of {} Greville sites are outside of the hull of the points: use least squares, or knots \
                 inside",
                outside.count() + 1,
                sites.len()
            );
            return Err(Error::usage(what).at(format!("site {x} {y}")));
        }
        self.of_values(&found.into_iter().flatten().collect::<Vec<f64>>())
    }

    /// Estimate of the condition of the equations in the 1-norm. It is a lower bound, and rarely less than a
    /// third of the exact value.
    ///
    /// Source: Hager 1984; Higham, "Accuracy and Stability of Numerical Algorithms", 2002, algorithm 15.1.
    pub fn condition_1(&self) -> f64 {
        self.norm() * self.inverse_norm().0
    }

    /// The condition in the 2-norm, from all singular values; `None` for more than 2,000 functions.
    pub fn condition_2(&self) -> Option<f64> {
        let count = self.basis.len();
        if count > FULL_MAX {
            return None;
        }
        let mut full = Mat::<f64>::zeros(count, count);
        for site in 0..count {
            self.row(site).for_each(|(function, value)| full[(site, function)] = value);
        }
        let singular = full.singular_values().ok()?;
        Some(singular.first()? / singular.last()?)
    }

    fn row(&self, site: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.offsets[site]..self.offsets[site + 1];
        self.functions[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        (0..x.len()).map(|site| self.row(site).map(|(function, value)| value * x[function]).sum()).collect()
    }

    fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let count = x.len();
        let column = MatMut::from_column_major_slice_mut(&mut x, count, 1);
        self.factors.solve_transpose_in_place_with_conj(Conj::No, column);
        x
    }

    fn solve_transposed(&self, mut x: Vec<f64>) -> Vec<f64> {
        let count = x.len();
        let column = MatMut::from_column_major_slice_mut(&mut x, count, 1);
        self.factors.solve_in_place_with_conj(Conj::No, column);
        x
    }

    /// The 1-norm of the matrix: the greatest absolute column sum.
    fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.basis.len()];
        self.functions.iter().zip(&self.values).for_each(|(&function, value)| sums[function] += value.abs());
        sums.into_iter().fold(0.0, f64::max)
    }

    /// Estimate of the 1-norm of the inverse, and the function with the greatest coefficient in the column
    /// that attains it.
    fn inverse_norm(&self) -> (f64, usize) {
        let count = self.basis.len();
        let mut x = vec![1.0 / count as f64; count];
        let mut best = (0.0, 0);
        for step in 0..STEPS {
            let y = self.solve(x);
            let norm: f64 = y.iter().map(|value| value.abs()).sum();
            if !norm.is_finite() {
                return (f64::INFINITY, y.iter().position(|value| !value.is_finite()).unwrap_or(0));
            }
            if step > 0 && norm <= best.0 {
                break;
            }
            best = (norm, greatest(&y));
            let z = self.solve_transposed(y.iter().map(|value| value.signum()).collect());
            let place = greatest(&z);
            x = vec![0.0; count];
            x[place] = 1.0;
        }
        // Higham's second vector, for matrices whose norm the first steps underestimate.
        let last = (count.max(2) - 1) as f64;
        let alternating = |i: usize| (1.0 + i as f64 / last) * if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let y = self.solve((0..count).map(alternating).collect());
        let norm = y.iter().map(|value| value.abs()).sum::<f64>() * 2.0 / (3.0 * count as f64);
        if norm > best.0 { (norm, greatest(&y)) } else { best }
    }

    fn check_condition(&self) -> Result<()> {
        let (inverse, function) = self.inverse_norm();
        let condition = self.norm() * inverse;
        if condition < CONDITION_MAX {
            return Ok(());
        }
        let [x, y] = self.basis.greville(function);
        let what = format!(
            "functions depend on each other at Greville sites (condition {condition:.0e}): use least \
             squares, or move knots"
        );
        Err(Error::usage(what).at(format!("site {x} {y}")))
    }
}

impl std::fmt::Debug for Interpolation<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Interpolation").field("functions", &self.basis.len()).finish_non_exhaustive()
    }
}

/// Coefficients of the spline that has a function's values at Greville sites.
///
/// # Errors
/// Those of [`Interpolation::new`] and [`Interpolation::of_function`].
pub fn interpolate(basis: &Basis, f: impl FnMut(Point2) -> f64) -> Result<Vec<f64>> {
    Interpolation::new(basis)?.of_function(f)
}

/// Refuses functions that are zero at all sites, and coincident sites, before factors are divided by zero.
fn check_sites(basis: &Basis, functions: &[usize], values: &[f64]) -> Result<()> {
    let mut is_alive = vec![false; basis.len()];
    let alive = functions.iter().zip(values).filter(|&(_, &value)| value != 0.0);
    alive.for_each(|(&function, _)| is_alive[function] = true);
    let at = |site: usize| {
        let [x, y] = basis.greville(site);
        format!("site {x} {y}")
    };
    if let Some(dead) = is_alive.iter().position(|&is_alive| !is_alive) {
        return Err(Error::usage(format!(
            "function {dead} is zero at all Greville sites: use least squares, or move knots"
        ))
        .at(at(dead)));
    }
    let sites: Vec<Point2> = (0..basis.len()).map(|site| basis.greville(site)).collect();
    let firsts = spmesh_delaunay::delaunay2::distinct(&sites);
    match firsts.iter().enumerate().find(|&(site, &first)| site != first as usize) {
        Some((site, first)) => Err(Error::usage(format!(
            "functions {first} and {site} have one Greville site: collect the functions of knots at one place"
        ))
        .at(at(site))),
        None => Ok(()),
    }
}

/// The error for functions whose knots are on one line except for rounding, if there are any: their sites are
/// no farther apart than rounding errors, and may be outside of their supports.
fn narrow(basis: &Basis) -> Option<Error> {
    let narrow = basis.narrow();
    let [x, y] = basis.greville(*narrow.first()?);
    let what = format!(
        "{} of {} functions have knots that are on one line except for rounding, so values at Greville sites \
         do not determine them: use least squares, or move these knots off the line",
        narrow.len(),
        basis.len()
    );
    Some(Error::usage(what).at(format!("site {x} {y}")))
}

fn greatest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs())).unwrap_or(0)
}

fn too_large(functions: usize) -> Error {
    let what = format!("not enough memory to interpolate with {functions} functions: use fewer knots");
    Error::new(ErrorKind::Memory, what)
}
