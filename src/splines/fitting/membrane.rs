//! The membrane energy of splines: the integral of f_x^2 + f_y^2 over the domain.
//!
//! Surfaces of least membrane energy follow observations more closely than thin plates, with peaks at them.
//! A sum of both energies makes *splines in tension*: thin plates for waves shorter than a certain length,
//! and membranes for longer ones (Franke 1985; Mitasova and Mitas 1993).
//!
//! The membrane energy of a plane depends on its slope, but a slope says nothing about how rough a surface
//! is. So the energy of a spline is the least one after subtraction of a linear function. If the columns of X
//! are the slopes x and y, and S = X'EX, its matrix is E - EX S^-1 X'E. That matrix is full, but it differs
//! from E by rank 2: solutions and determinants follow from those with E (Sherman, Morrison and Woodbury).

use super::cholesky::Factor;
use super::energy::{for_each_triangle, is_flat};
use super::normal_equations::Rows;
use super::polygon;
use super::symmetric::Symmetric;
use super::trend::linear_functions;
use crate::bases::{Basis, Scratch};
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;

/// Barycentric coordinates of the three nodes of a rule of degree 2 on triangles. Each has a third of the
/// area as weight (Strang and Fix 1973).
const NEAR: f64 = 2.0 / 3.0;
const FAR: f64 = 1.0 / 6.0;

/// The matrix M of the membrane energy: a spline with coefficients c has the energy c'Mc.
///
/// It is a quadrature on quarters of the triangles of a Delaunay triangulation of the knots: exact for
/// polynomials of degree 2, and close to the integral for other splines, whose gradients bend inside of these
/// triangles. A sum of squares, it is positive semidefinite, and zero for constants.
///
/// Units: those of c squared.
///
/// Cost: 24 evaluations of gradients per knot.
///
/// # Errors
/// A domain without an area.
pub fn membrane(basis: &Basis) -> Result<Symmetric> {
    let mut rows = Rows::new(basis.len(), 1);
    let mut scratch = Scratch::default();
    for_each_triangle(basis, |whole, inside| {
        // As narrow as rounding errors, it would make a fold stiff.
        if is_flat(whole) {
            return;
        }
        for edge in inside.get(1..).unwrap_or_default().windows(2) {
            let corners = [inside[0], edge[0], edge[1]];
            // Rounding may turn a part of almost no area over.
            let weight = polygon::area(&corners).max(0.0) / 12.0;
            for node in quarters(corners).into_iter().flat_map(nodes) {
                add_products(&mut rows, basis, node, weight, &mut scratch);
            }
        }
    })?;
    Ok(Symmetric::of_rows(&rows, |_| true))
}

/// The triangles between the corners and the middles of the sides.
fn quarters([a, b, c]: [Point2; 3]) -> [[Point2; 3]; 4] {
    let middle = |p: Point2, q: Point2| [0, 1].map(|axis| 0.5 * (p[axis] + q[axis]));
    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

fn nodes(corners: [Point2; 3]) -> [Point2; 3] {
    let share = |node: usize, corner: usize| if node == corner { NEAR } else { FAR };
    [0, 1, 2]
        .map(|node| [0, 1].map(|axis| (0..3).map(|corner| share(node, corner) * corners[corner][axis]).sum()))
}

/// Adds the products of the gradients of all functions at one place.
fn add_products(rows: &mut Rows, basis: &Basis, place: Point2, weight: f64, scratch: &mut Scratch) {
    let jets = basis.jets_at(place, scratch);
    let mut products = Vec::with_capacity(jets.len());
    for (at, (first, a)) in jets.iter().enumerate() {
        let product = |b: [f64; 2]| a.gradient[0] * b[0] + a.gradient[1] * b[1];
        products.clear();
        products.extend(jets[at..].iter().map(|(second, b)| (*second, product(b.gradient))));
        rows.add(*first as usize, 0, weight, &products);
    }
}

/// The part of an energy that linear functions have.
#[derive(Debug)]
pub(super) struct LinearPart {
    /// The columns of EX.
    products: [Vec<f64>; 2],
    /// X'EX.
    gram: [[f64; 2]; 2],
}

/// A linear part together with factored equations F = N + lambda E.
pub(super) struct Correction<'a> {
    part: &'a LinearPart,
    lambda: f64,
    /// The columns of F^-1 EX.
    solved: [Vec<f64>; 2],
    /// S - lambda X'E F^-1 EX.
    rest: [[f64; 2]; 2],
}

/// Coefficients without the linear function that has most of their energy.
pub(super) fn without_linear(basis: &Basis, energy: &Symmetric, coefficients: &[f64]) -> Vec<f64> {
    let LinearPart { products, gram: [[a, b], [c, d]] } = LinearPart::of(basis, energy);
    let [p, q] = products.each_ref().map(|product| dot(product, coefficients));
    let determinant = a * d - b * c;
    let shares = [(d * p - b * q) / determinant, (a * q - c * p) / determinant];
    let [_, x, y] = linear_functions(basis);
    let linear = x.iter().zip(&y).map(|(x, y)| shares[0] * x + shares[1] * y);
    coefficients.iter().zip(linear).map(|(c, linear)| c - linear).collect()
}

/// What the inverse of equations without the linear part has more than F^-1: columns C and a matrix R for
/// which it is CRC'.
#[derive(Debug)]
pub(super) struct OfLinear {
    /// The columns of F^-1 EX.
    pub(super) columns: [Vec<f64>; 2],
    /// `lambda` times the inverse of the rest.
    pub(super) rest: [[f64; 2]; 2],
}

impl LinearPart {
    pub(super) fn of(basis: &Basis, energy: &Symmetric) -> LinearPart {
        let [_, slopes @ ..] = linear_functions(basis);
        let products = slopes.each_ref().map(|slope| energy.times(slope));
        let gram = slopes.each_ref().map(|slope| products.each_ref().map(|product| dot(slope, product)));
        LinearPart { products, gram }
    }

    pub(super) fn correction(&self, factor: &Factor, lambda: f64) -> Correction<'_> {
        let solved = self.products.each_ref().map(|product| factor.solve(product));
        let rest =
            [0, 1].map(|i| [0, 1].map(|j| self.gram[i][j] - lambda * dot(&self.products[i], &solved[j])));
        Correction { part: self, lambda, solved, rest }
    }
}

impl Correction<'_> {
    /// What the inverse has more than F^-1.
    pub(super) fn of_inverse(&self) -> OfLinear {
        let [[a, b], [c, d]] = self.rest;
        let part = self.lambda / (a * d - b * c);
        OfLinear { columns: self.solved.clone(), rest: [[part * d, -part * b], [-part * c, part * a]] }
    }

    /// Turns a solution with F into that of the equations without the linear part.
    pub(super) fn apply(&self, solution: &mut [f64]) {
        let [[a, b], [c, d]] = self.rest;
        let [p, q] = self.part.products.each_ref().map(|product| self.lambda * dot(product, solution));
        let determinant = a * d - b * c;
        let shares = [(d * p - b * q) / determinant, (a * q - c * p) / determinant];
        for (share, column) in shares.into_iter().zip(&self.solved) {
            solution.iter_mut().zip(column).for_each(|(x, step)| *x += share * step);
        }
    }

    /// The logarithm of the determinant of the equations without the linear part, less that of F, plus that
    /// of S.
    pub(super) fn log_determinant(&self) -> f64 {
        let [[a, b], [c, d]] = self.rest;
        (a * d - b * c).ln()
    }
}

/// Three functions at sites that span a large triangle, and the logarithm of the determinant of the values of
/// linear functions there.
pub(super) fn corners(basis: &Basis) -> (Vec<usize>, f64) {
    let [_, x, y] = linear_functions(basis);
    let greatest = |size: &dyn Fn(usize) -> f64| {
        (0..basis.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(0)
    };
    let a = greatest(&|at| -x[at] - y[at]);
    let b = greatest(&|at| (x[at] - x[a]).hypot(y[at] - y[a]));
    let area = |at: usize| ((x[b] - x[a]) * (y[at] - y[a]) - (y[b] - y[a]) * (x[at] - x[a])).abs();
    let c = greatest(&area);
    (vec![a, b, c], area(c).ln())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
