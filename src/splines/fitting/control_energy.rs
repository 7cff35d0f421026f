//! The bending energy of the control mesh of a spline.
//!
//! The thin-plate energy does not see folds, linear dependences of functions, or functions too small to have
//! an area. Splines of degrees 0 and 1 have no thin-plate energy. The control mesh has the coefficients as
//! elevations at the triangulated Greville sites. Its bending depends on every coefficient, and is zero only
//! for linear functions.

use super::energy::thin_plate;
use super::normal_equations::Rows;
use super::polygon;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{self, Triangulation};
use spmesh_delaunay::predicates::{Point2, area};

/// The share of the control mesh in [`bending`], small enough that creases can fold where observations
/// require it.
const SHARE: f64 = 1e-3;

/// The matrix of an energy that is zero only for linear functions. From degree 2 on, it is the thin-plate
/// energy plus a thousandth of [`control_bending`]; below, it is [`control_bending`].
///
/// Units: those of [`thin_plate`].
///
/// # Errors
/// Those of [`thin_plate`] and [`control_bending`].
pub fn bending(basis: &Basis) -> Result<Symmetric> {
    let control = control_bending(basis)?;
    if basis.degree() < 2 { Ok(control) } else { Ok(thin_plate(basis)?.plus(SHARE, &control)) }
}

/// The matrix of the bending of the control mesh: the sum over inner edges of d^2 / L^2. Here d is the
/// vertical distance between the diagonals of the quadrilateral at the edge where they cross, and L^2 is the
/// sum of their squared lengths. With L^2 as an area, this is like the square of a second derivative times
/// the area. But the quadrilateral itself may be arbitrarily flat, as it often is at sites along the border.
///
/// Functions with the same Greville site have their coefficients tied to each other.
///
/// Units: one over an area.
///
/// # Errors
/// Usage, if all Greville sites are on one line.
pub fn control_bending(basis: &Basis) -> Result<Symmetric> {
    let sites: Vec<Point2> = (0..basis.len()).map(|function| basis.greville(function)).collect();
    let mesh = delaunay2::triangulate(&sites).map_err(Error::of_computation)?;
    if mesh.triangles().is_empty() {
        return Err(Error::usage("all Greville sites of the functions are on one line: use more knots"));
    }
    let mut rows = Rows::new(basis.len(), 1);
    for_each_hinge(&mesh, |corners| {
        let [p, q, r, s] = corners.map(|id| sites[id as usize]);
        // The affine dependence of four points: the factor of each is the signed area of the others.
        let dependence = [area(q, r, s), -area(p, r, s), area(p, q, s), -area(p, q, r)];
        let half = 0.5 * dependence.iter().map(|share| share.abs()).sum::<f64>();
        let diagonals = polygon::square_of_side(p, q) + polygon::square_of_side(r, s);
        add_square(&mut rows, corners, dependence.map(|share| share / half), 1.0 / diagonals);
    });
    let of_function = polygon::area(&basis.domain_corners()).max(f64::MIN_POSITIVE) / basis.len() as f64;
    for &pair in &mesh.duplicates {
        add_square(&mut rows, pair, [1.0, -1.0], 1.0 / of_function);
    }
    Ok(Symmetric::of_rows(&rows, |_| true))
}

/// Calls `visit` for each inner edge with its ends, and with the vertices to the left and to the right of it.
fn for_each_hinge(mesh: &Triangulation, mut visit: impl FnMut([u32; 4])) {
    for (number, triangle) in mesh.triangles().iter().enumerate() {
        for side in 0..3 {
            let Some(beyond) = triangle.neighbour(side).filter(|beyond| (beyond.triangle as usize) > number)
            else {
                continue;
            };
            let at = |corner: usize| triangle.vertices[corner % 3];
            let other = mesh.triangles()[beyond.triangle as usize].vertices[beyond.corner as usize];
            visit([at(side + 1), at(side + 2), at(side), other]);
        }
    }
}

/// Adds `factor` times the square of the sum of `shares[i]` times the coefficient of `functions[i]`.
fn add_square<const N: usize>(rows: &mut Rows, functions: [u32; N], shares: [f64; N], factor: f64) {
    for (i, &first) in functions.iter().enumerate() {
        for (j, &second) in functions.iter().enumerate() {
            if first <= second {
                rows.add(first as usize, 0, factor, &[(second, shares[i] * shares[j])]);
            }
        }
    }
}
