//! The membrane energy of splines: the integral of f_x^2 + f_y^2 over the domain.
//!
//! Surfaces of least membrane energy follow observations more closely than thin plates, with peaks at them.
//! A sum of both energies makes *splines in tension*: thin plates for waves shorter than a certain length,
//! and membranes for longer ones (Franke 1985; Mitasova and Mitas 1993).

use super::energy::{for_each_triangle, is_flat};
use super::polygon;
use super::rows::Rows;
use super::symmetric::Symmetric;
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
