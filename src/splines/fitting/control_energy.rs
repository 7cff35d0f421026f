//! The bending energy of the control mesh of a spline.
//!
//! The thin-plate energy is blind where splines can be folded, for functions that depend on each other, and
//! for those too small to have an area; and splines of degree 0 and 1 have none. The control mesh has the
//! coefficients as elevations at the triangulated Greville sites. It depends on every coefficient, and is
//! flat only for linear functions.

use super::energy::thin_plate;
use super::polygon;
use super::rows::Rows;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_core::error::{Error, Result};
use spmesh_geometry::delaunay2::{self, Triangulation};
use spmesh_geometry::predicates::{Point2, area};

/// The share of the control mesh in [`bending`]: so little that creases can fold where observations require
/// it.
const SHARE: f64 = 1e-3;

/// The matrix of an energy that determines all splines but linear functions: the thin-plate energy, from
/// degree 2 on, with a thousandth of [`control_bending`]; and that itself below.
///
/// Units: those of [`thin_plate`].
///
/// # Errors
/// Those of [`thin_plate`] and [`control_bending`].
pub fn bending(basis: &Basis) -> Result<Symmetric> {
    let control = control_bending(basis)?;
    if basis.degree() < 2 { Ok(control) } else { Ok(thin_plate(basis)?.plus(SHARE, &control)) }
}

/// The matrix of how much the control mesh bends: the sum over inner edges of d^2 / L^2, where d is by how
/// much the diagonals of the quadrilateral at the edge miss each other, and L^2 the sum of their squares.
/// With L^2 as an area, that is like the square of a second derivative times the area; but the quadrilateral
/// itself may be as flat as it likes, which sites along the border often make it.
///
/// Coefficients of functions with one Greville site are tied to each other.
///
/// Units: one over an area.
///
/// # Errors
/// Usage, if all Greville sites are on one line.
pub fn control_bending(basis: &Basis) -> Result<Symmetric> {
    let sites: Vec<Point2> = (0..basis.len()).map(|function| basis.greville(function)).collect();
    let mesh = delaunay2::triangulate(&sites)?;
    if mesh.triangles().is_empty() {
        return Err(Error::usage("all Greville sites of the functions are on one line: use more knots"));
    }
    let mut rows = Rows::new(basis.len(), 1);
    for_each_hinge(&mesh, |corners| {
        let [p, q, r, s] = corners.map(|id| sites[id as usize]);
        // The affine dependence of four points: area of the others each, with signs.
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

/// Adds `factor` times the square of a sum of coefficients with factors of their own.
fn add_square<const N: usize>(rows: &mut Rows, functions: [u32; N], shares: [f64; N], factor: f64) {
    for (i, &first) in functions.iter().enumerate() {
        for (j, &second) in functions.iter().enumerate() {
            if first <= second {
                rows.add(first as usize, 0, factor, &[(second, shares[i] * shares[j])]);
            }
        }
    }
}
