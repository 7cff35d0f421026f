//! Circumscribed spheres of edges, triangles and tetrahedra: their sizes, and whether they are empty.
//!
//! In the formulas the first point is the origin. The centre of the sphere through 0, b, c, d is n / 2 D with
//! n = b² (c × d) + c² (d × b) + d² (b × c) and D = det(b, c, d). The centre of the least sphere through 0,
//! b, c is (β b + γ c) / 2 W with β = c² (b² - bc), γ = b² (c² - bc) and W = (b × c)².

use num_bigint::BigInt;

use super::alpha::Radius;
use super::exact::{
    Approximate, Number, Polynomial, Vector, cross, difference, dot, root_of_quotient, sign, square, sum,
    times,
};
use spmesh_delaunay::predicates::exact_integers::integers_and_unit;
use spmesh_delaunay::predicates::{Point3, Sign};

/// n and D of a tetrahedron.
fn sphere<T: Number>([a, b, c, d]: &[Vector<T>; 4]) -> (Vector<T>, T) {
    let sides = [difference(b, a), difference(c, a), difference(d, a)];
    let lifts = [square(&sides[0]), square(&sides[1]), square(&sides[2])];
    orthosphere(&sides, &lifts)
}

/// n and D of a tetrahedron of b, c, d and the origin, given their lifts: b², c² and d², less the weights if
/// there are any.
pub(super) fn orthosphere<T: Number>(
    [b, c, d]: &[Vector<T>; 3],
    [of_b, of_c, of_d]: &[T; 3],
) -> (Vector<T>, T) {
    let (bc, cd, db) = (cross(b, c), cross(c, d), cross(d, b));
    let n = sum(&sum(&times(of_b, &cd), &times(of_c, &db)), &times(of_d, &bc));
    (n, dot(b, &cd))
}

pub(super) fn twice<T: Number>(value: T) -> T {
    value.clone() + value
}

pub(super) fn four_times<T: Number>(value: T) -> T {
    twice(twice(value))
}

/// (2 D R)² - n²: not negative if the circumscribed sphere of a tetrahedron has at most the radius R.
struct TetrahedronFits;

impl Polynomial<4> for TetrahedronFits {
    fn value<T: Number>(points: [Vector<T>; 4], [numerator, denominator]: &[T; 2]) -> T {
        let (n, determinant) = sphere(&points);
        let room = four_times(determinant.clone() * determinant) * numerator.clone();
        room - square(&n) * denominator.clone()
    }
}

/// 4 W R² - b² c² (b - c)²: not negative if the least sphere through a triangle has at most the radius R.
struct TriangleFits;

impl Polynomial<3> for TriangleFits {
    fn value<T: Number>([a, b, c]: [Vector<T>; 3], [numerator, denominator]: &[T; 2]) -> T {
        let (b, c) = (difference(&b, &a), difference(&c, &a));
        let room = four_times(square(&cross(&b, &c))) * numerator.clone();
        room - square(&b) * square(&c) * square(&difference(&b, &c)) * denominator.clone()
    }
}

/// 4 R² - b²: not negative if the least sphere through an edge has at most the radius R.
struct EdgeFits;

impl Polynomial<2> for EdgeFits {
    fn value<T: Number>([a, b]: [Vector<T>; 2], [numerator, denominator]: &[T; 2]) -> T {
        four_times(numerator.clone()) - square(&difference(&b, &a)) * denominator.clone()
    }
}

/// W d² - β bd - γ cd: negative if d lies inside of the least sphere through a triangle.
struct OutsideOfTriangle;

impl Polynomial<4> for OutsideOfTriangle {
    fn value<T: Number>([a, b, c, d]: [Vector<T>; 4], _: &[T; 2]) -> T {
        let (b, c, d) = (difference(&b, &a), difference(&c, &a), difference(&d, &a));
        let (b_square, c_square, bc) = (square(&b), square(&c), dot(&b, &c));
        let beta = c_square.clone() * (b_square.clone() - bc.clone());
        let gamma = b_square * (c_square - bc);
        square(&cross(&b, &c)) * square(&d) - beta * dot(&b, &d) - gamma * dot(&c, &d)
    }
}

/// (a - c) (b - c): negative if c lies inside of the least sphere through an edge.
struct OutsideOfEdge;

impl Polynomial<3> for OutsideOfEdge {
    fn value<T: Number>([a, b, c]: [Vector<T>; 3], _: &[T; 2]) -> T {
        dot(&difference(&a, &c), &difference(&b, &c))
    }
}

/// Whether the circumscribed sphere of a tetrahedron has at most the given radius.
pub(super) fn tetrahedron_fits(points: [Point3; 4], radius: &Radius) -> bool {
    sign::<TetrahedronFits, 4>(points, radius) != Sign::Negative
}

/// Whether the least sphere through a triangle has at most the given radius.
pub(super) fn triangle_fits(points: [Point3; 3], radius: &Radius) -> bool {
    sign::<TriangleFits, 3>(points, radius) != Sign::Negative
}

/// Whether the least sphere through an edge has at most the given radius.
pub(super) fn edge_fits(points: [Point3; 2], radius: &Radius) -> bool {
    sign::<EdgeFits, 2>(points, radius) != Sign::Negative
}

/// Whether the fourth point lies inside of the least sphere through the other three.
pub(super) fn is_in_sphere_of_triangle(points: [Point3; 4], radius: &Radius) -> bool {
    sign::<OutsideOfTriangle, 4>(points, radius) == Sign::Negative
}

/// Whether the third point lies inside of the least sphere through the other two.
pub(super) fn is_in_sphere_of_edge(points: [Point3; 3], radius: &Radius) -> bool {
    sign::<OutsideOfEdge, 3>(points, radius) == Sign::Negative
}

/// Radius of the circumscribed sphere and volume of a tetrahedron, in the unit of the coordinates.
///
/// Domain: not flat. Accurate to some ten digits, however thin the tetrahedron is.
pub fn measure(points: [Point3; 4]) -> Measure {
    let (n, determinant) = sphere(&points.map(|point| point.map(Approximate::exactly)));
    let n_square = square(&n);
    if n_square.is_accurate() && determinant.is_accurate() {
        let determinant = determinant.value.abs();
        return Measure {
            circumradius: n_square.value.sqrt() / (2.0 * determinant),
            volume: determinant / 6.0,
        };
    }
    measure_exactly(points)
}

#[cold]
fn measure_exactly(points: [Point3; 4]) -> Measure {
    let (points, unit) = integers_and_unit(points);
    let (n, determinant) = sphere(&points);
    let square_of_determinant = &determinant * &determinant;
    if square_of_determinant == BigInt::from(0) {
        return Measure { circumradius: f64::INFINITY, volume: 0.0 };
    }
    let (radius, radius_exponent) = root_of_quotient(&square(&n), &four_times(square_of_determinant.clone()));
    let (volume, volume_exponent) = root_of_quotient(&square_of_determinant, &BigInt::from(36));
    Measure {
        circumradius: radius * power_of_two(radius_exponent / 2 + unit),
        volume: volume * power_of_two(volume_exponent / 2 + 3 * unit),
    }
}

/// Two to the power of `exponent`; 0 or infinity if that is out of range.
fn power_of_two(exponent: i32) -> f64 {
    let half = exponent / 2;
    2f64.powi(half) * 2f64.powi(exponent - half)
}

/// Measures of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Radius of the circumscribed sphere.
    pub circumradius: f64,
    /// Volume.
    pub volume: f64,
}
