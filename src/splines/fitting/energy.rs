//! The thin-plate energy of splines: the integral of f_xx^2 + 2 f_xy^2 + f_yy^2 over the domain.
//!
//! Second derivatives count where they exist. Functions may have edges along creases, linear elements and
//! collinear knots, and on the borders between grids. Folds there have no energy, which is the purpose of
//! creases. (The same holds along any edge between two knots that are pulled apart: an edge that cuts off a
//! corner of the border lets the corner fold, and then functions other than planes have zero energy.)
//!
//! The matrix is a sum of weights above zero times products of the second derivatives that all functions have
//! at one place. So it is positive semidefinite except for the rounding errors of the sum, which are small
//! against the diagonal, wherever knots are.
//!
//! For degree 2 the matrix is exact except for rounding and for triangles that are almost flat: second
//! derivatives are constant in the cells between knot lines (`bases::basis::bends`). For other degrees the
//! matrix is a quadrature on parts of the triangles of a Delaunay triangulation of the knots. It is not
//! exact, because functions have other borders than these triangles.
//!
//! The bending energy of the control mesh sees more:
//! The thin-plate energy does not see folds, linear dependences of functions, or functions too small to have
//! an area. Splines of degrees 0 and 1 have no thin-plate energy. The control mesh has the coefficients as
//! elevations at the triangulated Greville sites. Its bending depends on every coefficient, and is zero only
//! for linear functions.

use super::cells;
use super::normal_equations::Rows;
use super::overlaps::{self, Rectangle};
use super::polygon::{self, Clipper, Polygon};
use super::symmetric::Symmetric;
use crate::bases::{Basis, Bend, Scratch};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{self, Triangle, Triangulation};
use spmesh_delaunay::predicates::{Point2, area, lexicographic};

/// The area of triangles is left out if it is less than this part of the square of their longest side. Three
/// knots that are on a line except for rounding errors make second derivatives so great, on so little area,
/// that their energy cannot be computed; it is the energy of a fold.
const AREA_MIN: f64 = 1e-6;
/// Parts of triangles in the domain are left out if they are less than this part of the triangle. Triangles
/// outside of the domain often have sides on its border, and rounding leaves a part of them inside. Functions
/// that are zero in the domain would get energies from such parts.
const PART_MIN: f64 = 1e-12;
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
    let triangles = triangles(basis)?;
    let mut rows = Rows::new(basis.len(), 1);
    if basis.degree() == 2 {
        add_exact(basis, &triangles, &mut rows);
    } else {
        add_quadrature(basis, &triangles, &mut rows);
    }
    Ok(Symmetric::of_rows(&rows, |_| true))
}

/// The triangles of a Delaunay triangulation of the knots.
fn triangles(basis: &Basis) -> Result<Vec<[Point2; 3]>> {
    check_domain(basis)?;
    let mesh = delaunay2::triangulate(basis.knots()).map_err(Error::of_computation)?;
    let corners = |triangle: &Triangle| triangle.vertices.map(|id| basis.knots()[id as usize]);
    Ok(mesh.triangles().iter().map(corners).collect())
}

/// Calls `visit` with the triangles of a Delaunay triangulation of the knots, and their parts in the domain.
pub(super) fn for_each_triangle(basis: &Basis, mut visit: impl FnMut(&[Point2; 3], &[Point2])) -> Result<()> {
    let mut clipper = Clipper::default();
    for triangle in triangles(basis)? {
        visit(&triangle, in_domain(basis, &triangle, &mut clipper));
    }
    Ok(())
}

/// Refuses knots over which no splines are whole.
pub(super) fn check_domain(basis: &Basis) -> Result<()> {
    if polygon::area(&basis.domain_corners()) > 0.0 {
        return Ok(());
    }
    Err(Error::usage("the domain of the knots has no area: use more knots, or repeat those of the border"))
}

/// Adds the energy of quadratic functions, triangle by triangle of the Delaunay triangulation of the knots.
/// Lines between knots that cross a triangle divide it into cells, in which second derivatives are constant.
fn add_exact(basis: &Basis, triangles: &[[Point2; 3]], rows: &mut Rows) {
    let bends: Vec<Bend> = basis.bends().collect();
    let mut clipper = Clipper::default();
    for (triangle, near) in triangles.iter().zip(bends_near(&bends, triangles)) {
        let whole = in_domain(basis, triangle, &mut clipper).to_vec();
        let near: Vec<&Bend> = near.into_iter().map(|at| &bends[at as usize]).collect();
        add_cells(whole, triangle[0], &near, rows);
    }
}

/// For each triangle, the bends whose boxes meet its box.
fn bends_near(bends: &[Bend], triangles: &[[Point2; 3]]) -> Vec<Vec<u32>> {
    let all = bends.iter().map(|bend| &bend.corners).chain(triangles);
    let boxes: Vec<Rectangle> = all.map(|corners| rectangle(corners)).collect();
    let mut near = vec![Vec::new(); triangles.len()];
    let is_bend = |at: u32| (at as usize) < bends.len();
    overlaps::for_each_pair(&boxes, &mut |a, b| {
        if is_bend(a) && !is_bend(b) {
            near[b as usize - bends.len()].push(a);
        }
    });
    // Sums must not depend on the order of the search.
    near.iter_mut().for_each(|some| some.sort_unstable());
    near
}

/// The part of a triangle in the domain; empty if it is only the error of rounding.
fn in_domain<'a>(basis: &Basis, corners: &'a [Point2; 3], clipper: &'a mut Clipper) -> &'a [Point2] {
    if corners.iter().all(|&corner| basis.is_in_domain(corner)) {
        return corners;
    }
    let part = clipper.right_of(corners, basis.domain_lines());
    if polygon::area(part) > PART_MIN * polygon::area(corners) { part } else { &[] }
}

/// Adds the energy in a polygon, in which `near` may bend. Coordinates relative to `origin` have the least
/// rounding errors.
fn add_cells(polygon: Polygon, origin: Point2, near: &[&Bend], rows: &mut Rows) {
    let local = |point: Point2| [point[0] - origin[0], point[1] - origin[1]];
    let polygon: Polygon = polygon.into_iter().map(local).collect();
    // Of the others, some side has the whole polygon on its right. Their lines need not divide it.
    let is_left_of = |side: [Point2; 2]| {
        let [p, q] = side.map(local);
        polygon.iter().any(|&corner| polygon::twice_area(p, q, corner) > 0.0)
    };
    let near: Vec<&Bend> =
        near.iter().copied().filter(|bend| bend.sides.into_iter().all(is_left_of)).collect();
    let mut lines: Vec<[Point2; 2]> = near.iter().flat_map(|bend| bend.sides).map(from_left).collect();
    let order = |a: &[Point2; 2], b: &[Point2; 2]| lexicographic(a[0], b[0]).then(lexicographic(a[1], b[1]));
    lines.sort_unstable_by(order);
    lines.dedup();
    let number = |side| lines.partition_point(|line| order(line, &from_left(side)).is_lt());
    let bounds = |bend: &&Bend| bend.sides.map(|side| (number(side), side == from_left(side)));
    let bounds: Vec<[(usize, bool); 3]> = near.iter().map(bounds).collect();
    let here: Vec<[Point2; 2]> = lines.iter().map(|line| line.map(local)).collect();
    let mut hessians = Vec::new();
    cells::for_each_cell(polygon, &here, &mut |cell, is_left| {
        let covers = |bounds: &[(usize, bool); 3]| bounds.iter().all(|&(line, side)| is_left[line] == side);
        let covering = near.iter().zip(&bounds).filter(|(_, bounds)| covers(bounds)).map(|(bend, _)| bend);
        hessians.clear();
        for bend in covering {
            if is_flat(&bend.corners) {
                return;
            }
            hessians.extend_from_slice(&bend.hessians);
        }
        sum_by_function(&mut hessians);
        add_products(rows, &hessians, polygon::area(cell));
    });
}

/// A line through two points, directed from the left one.
fn from_left([p, q]: [Point2; 2]) -> [Point2; 2] {
    if lexicographic(p, q).is_le() { [p, q] } else { [q, p] }
}

fn sum_by_function(hessians: &mut Vec<(u32, [f64; 3])>) {
    // Stable, so that sums do not depend on the way of sorting.
    hessians.sort_by_key(|&(function, _)| function);
    hessians.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        if is_same {
            (0..3).for_each(|place| kept.1[place] += next.1[place]);
        }
        is_same
    });
}

pub(super) fn is_flat(corners: &[Point2; 3]) -> bool {
    let square = |i: usize| polygon::square_of_side(corners[i], corners[(i + 1) % 3]);
    polygon::area(corners).abs() < AREA_MIN * square(0).max(square(1)).max(square(2))
}

/// Adds the products of the second derivatives of functions at one place, in order of functions.
fn add_products(rows: &mut Rows, hessians: &[(u32, [f64; 3])], weight: f64) {
    let mut products = Vec::with_capacity(hessians.len());
    for (at, (first, a)) in hessians.iter().enumerate() {
        products.clear();
        let product = |b: &[f64; 3]| a[0] * b[0] + 2.0 * a[1] * b[1] + a[2] * b[2];
        products.extend(hessians[at..].iter().map(|(second, b)| (*second, product(b))));
        rows.add(*first as usize, 0, weight, &products);
    }
}

fn rectangle(polygon: &[Point2]) -> Rectangle {
    let bound = |pick: fn(f64, f64) -> f64, start: f64| {
        [0, 1].map(|axis| polygon.iter().map(|corner| corner[axis]).fold(start, pick))
    };
    [bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY)]
}

fn add_quadrature(basis: &Basis, triangles: &[[Point2; 3]], rows: &mut Rows) {
    let (mut clipper, mut scratch, mut hessians) = (Clipper::default(), Scratch::default(), Vec::new());
    for triangle in triangles {
        let inside = in_domain(basis, triangle, &mut clipper).to_vec();
        for edge in inside.get(1..).unwrap_or_default().windows(2) {
            for_each_node([inside[0], edge[0], edge[1]], &mut |x, weight| {
                let jets = basis.jets_at(x, &mut scratch).iter();
                hessians.clear();
                hessians.extend(jets.map(|(function, jet)| (*function, jet.hessian)));
                // Rounding may turn a part of almost no area over.
                add_products(rows, &hessians, weight.max(0.0));
            });
        }
    }
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
    for &pair in mesh.duplicates() {
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
