//! The thin-plate energy of splines: the integral of f_xx^2 + 2 f_xy^2 + f_yy^2 over the domain.
//!
//! Second derivatives count where they exist. Functions may have edges along creases, linear elements and
//! collinear knots, and on the borders between grids. Folds there have no energy, which is the purpose of
//! creases. (The same holds along any edge between two knots that are pulled apart: an edge that cuts off a
//! corner of the border lets the corner fold, and then functions other than planes have zero energy.)
//!
//! For degree 2 the matrix is exact except for rounding and for triangles that are almost flat: second
//! derivatives are constants on triangles (`bases::basis::bends`), and the intersection of two triangles is a
//! polygon with an area. For other degrees the matrix is a quadrature on parts of the triangles of a Delaunay
//! triangulation of the knots. It is not exact, because functions have other borders than these triangles.

use super::overlaps::{self, Rectangle};
use super::polygon::{self, Clipper, Polygon};
use super::rows::Rows;
use super::symmetric::Symmetric;
use crate::bases::{Basis, Scratch};
use spmesh_core::error::{Error, Result};
use spmesh_geometry::delaunay2;
use spmesh_geometry::predicates::Point2;

/// Triangles whose area is less than this part of the square of their longest side are left out. Three knots
/// that are on a line except for rounding errors make second derivatives so great, on so little area, that
/// their energy cannot be computed; it is the energy of a fold.
const AREA_MIN: f64 = 1e-6;
/// Each triangle of knots is divided into the square of this number of triangles for quadrature.
const DIVISIONS: usize = 4;
/// A rule of degree 4 on triangles: barycentric coordinate of two of three points, and weight (Dunavant
/// 1985).
const RULE: [(f64, f64); 2] = [
    (0.445_948_490_915_964_9, 0.223_381_589_678_011_47),
    (0.091_576_213_509_770_74, 0.109_951_743_655_321_87),
];

/// The matrix E of the thin-plate energy: a spline with coefficients c has the energy c'Ec.
///
/// Units: those of c squared over an area.
///
/// Cost: for degree 2, about 100 polygons per function.
///
/// # Errors
/// A degree without second derivatives; a domain without an area.
pub fn thin_plate(basis: &Basis) -> Result<Symmetric> {
    if basis.degree() < 2 {
        let what = format!("splines of degree {} cannot be smoothed: degree 2 can", basis.degree());
        return Err(Error::usage(what));
    }
    let domain = basis.domain_corners();
    if polygon::area(&domain) <= 0.0 {
        return Err(Error::usage(
            "the domain of the knots has no area: pull the knots of their border apart",
        ));
    }
    let mut rows = Rows::new(basis.len(), 1);
    if basis.degree() == 2 {
        add_exact(basis, &domain, &mut rows);
    } else {
        add_quadrature(basis, &domain, &mut rows)?;
    }
    Ok(Symmetric::of_rows(&rows, |_| true))
}

/// Second derivatives that are constant on a polygon.
struct Plateau {
    polygon: Polygon,
    hessians: Vec<(u32, [f64; 3])>,
}

fn add_exact(basis: &Basis, domain: &[Point2], rows: &mut Rows) {
    let mut clipper = Clipper::default();
    let origin = domain[0];
    let local = |point: Point2| [point[0] - origin[0], point[1] - origin[1]];
    let plateaus: Vec<Plateau> = basis
        .bends()
        .filter(|bend| !is_flat(&bend.corners))
        .filter_map(|bend| {
            let is_inside = bend.corners.iter().all(|&corner| basis.is_in_domain(corner));
            let whole = if is_inside { &bend.corners } else { clipper.common(&bend.corners, domain) };
            let polygon: Polygon = whole.iter().map(|&point| local(point)).collect();
            (polygon.len() > 2).then_some(Plateau { polygon, hessians: bend.hessians })
        })
        .collect();
    for plateau in &plateaus {
        let size = polygon::area(&plateau.polygon);
        for (place, first) in plateau.hessians.iter().enumerate() {
            plateau.hessians[place..].iter().for_each(|second| add(rows, first, second, size));
        }
    }
    let boxes: Vec<Rectangle> = plateaus.iter().map(|plateau| rectangle(&plateau.polygon)).collect();
    overlaps::for_each_pair(&boxes, &mut |a, b| {
        let (a, b) = (&plateaus[a as usize], &plateaus[b as usize]);
        let size = polygon::area(clipper.common(&a.polygon, &b.polygon));
        if size <= 0.0 {
            return;
        }
        for first in &a.hessians {
            for second in &b.hessians {
                // Off the diagonal, an entry stands for both orders of two functions; on the diagonal, both
                // orders are one function.
                let factor = if first.0 == second.0 { 2.0 } else { 1.0 };
                add(rows, first, second, factor * size);
            }
        }
    });
}

fn is_flat(corners: &[Point2; 3]) -> bool {
    let square = |i: usize| polygon::square_of_side(corners[i], corners[(i + 1) % 3]);
    polygon::area(corners).abs() < AREA_MIN * square(0).max(square(1)).max(square(2))
}

/// Adds the product of the second derivatives of two functions, where these are constant on an area of
/// `size`.
fn add(rows: &mut Rows, first: &(u32, [f64; 3]), second: &(u32, [f64; 3]), size: f64) {
    let ((i, a), (j, b)) = (first, second);
    let product = a[0] * b[0] + 2.0 * a[1] * b[1] + a[2] * b[2];
    rows.add(*i.min(j) as usize, 0, size, &[(*i.max(j), product)]);
}

fn rectangle(polygon: &[Point2]) -> Rectangle {
    let bound = |pick: fn(f64, f64) -> f64, start: f64| {
        [0, 1].map(|axis| polygon.iter().map(|corner| corner[axis]).fold(start, pick))
    };
    [bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY)]
}

fn add_quadrature(basis: &Basis, domain: &[Point2], rows: &mut Rows) -> Result<()> {
    let mesh = delaunay2::triangulate(basis.knots())?;
    let (mut clipper, mut scratch) = (Clipper::default(), Scratch::default());
    for triangle in mesh.triangles() {
        let corners = triangle.vertices.map(|id| basis.knots()[id as usize]);
        let inside = clipper.common(&corners, domain);
        for edge in inside.get(1..).unwrap_or_default().windows(2) {
            for_each_node([inside[0], edge[0], edge[1]], &mut |x, weight| {
                let jets = basis.jets_at(x, &mut scratch);
                for (place, (first, of_first)) in jets.iter().enumerate() {
                    for (second, of_second) in &jets[place..] {
                        add(rows, &(*first, of_first.hessian), &(*second, of_second.hessian), weight);
                    }
                }
            });
        }
    }
    Ok(())
}

/// The nodes of quadrature in a triangle, with weights.
fn for_each_node([a, b, c]: [Point2; 3], visit: &mut impl FnMut(Point2, f64)) {
    let side = 1.0 / DIVISIONS as f64;
    let size = polygon::area(&[a, b, c]) * side * side;
    let at = |u: f64, v: f64| [0, 1].map(|axis| a[axis] + u * (b[axis] - a[axis]) + v * (c[axis] - a[axis]));
    for (i, j) in (0..DIVISIONS).flat_map(|i| (0..DIVISIONS - i).map(move |j| (i as f64, j as f64))) {
        for (u, v, weight) in nodes() {
            visit(at((i + u) * side, (j + v) * side), size * weight);
            if i + j + 2.0 <= DIVISIONS as f64 {
                visit(at((i + 1.0 - u) * side, (j + 1.0 - v) * side), size * weight);
            }
        }
    }
}

fn nodes() -> impl Iterator<Item = (f64, f64, f64)> {
    RULE.into_iter().flat_map(|(share, weight)| {
        let rest = 1.0 - 2.0 * share;
        [(share, share, weight), (share, rest, weight), (rest, share, weight)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_for_degree_4() {
        let triangle = [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
        let integral = |f: &dyn Fn(Point2) -> f64| {
            let mut sum = 0.0;
            for_each_node(triangle, &mut |x, weight| sum += weight * f(x));
            sum
        };
        // On this triangle, the integral of x^i y^j is 2^(i + 1) i! j! / (i + j + 2)!.
        for (f, expected) in [
            (&(|_| 1.0) as &dyn Fn(Point2) -> f64, 1.0),
            (&|[x, _]| x.powi(4), 32.0 * 24.0 / 720.0),
            (&|[x, y]| x * x * y * y, 8.0 * 4.0 / 720.0),
            (&|[_, y]| y.powi(3), 2.0 * 6.0 / 120.0),
        ] {
            assert!((integral(f) - expected).abs() < 1e-14);
        }
    }
}
