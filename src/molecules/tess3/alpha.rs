//! The alpha complex: which simplices have an empty circumscribed sphere that is small enough.
//!
//! A simplex of the triangulation belongs to the complex of radius R if a sphere of radius R or less passes
//! through all its vertices and has no point inside. Its least circumscribed sphere has its centre in the
//! flat that the simplex spans. If no point lies inside that sphere (a Gabriel simplex), the radius of the
//! sphere decides. Otherwise the smallest empty sphere of the simplex is also the smallest empty sphere of a
//! coface with one more vertex, and the simplex belongs to the complex if one of these cofaces does. A
//! tetrahedron has one sphere only. For a simplex of the triangulation, the adjacent vertices decide whether
//! its least sphere is empty. Points on a sphere are not inside it, and a radius of exactly R is small
//! enough; both are decided exactly, for R as written by the user.
//!
//! Source: Edelsbrunner and Mücke, "Three-dimensional alpha shapes", 1994.

use std::fmt;
use std::str::FromStr;

use super::exact::Approximate;
use super::spheres::{
    edge_fits, is_in_sphere_of_edge, is_in_sphere_of_triangle, tetrahedron_fits, triangle_fits,
};
use num_bigint::BigInt;
use spmesh_delaunay::delaunay3::{Ring, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;

/// An alpha complex of a tetrahedralization.
#[derive(Debug)]
pub struct AlphaComplex<'m> {
    mesh: &'m Tetrahedralization,
    /// In the unit of the mesh's coordinates.
    radius: Radius,
    /// A bit per tetrahedron: whether it belongs to the complex.
    tetrahedra: Vec<u64>,
}

impl<'m> AlphaComplex<'m> {
    /// The complex of a radius in the unit of the mesh's coordinates.
    ///
    /// Cost: a few sphere equations and one bit of memory per tetrahedron.
    pub fn new(mesh: &'m Tetrahedralization, radius: Radius) -> Self {
        let fits =
            |vertices: &[u32; 4]| tetrahedron_fits(vertices.map(|v| mesh.vertices()[v as usize].at), &radius);
        let tetrahedra = mesh
            .tetrahedra()
            .chunks(64)
            .map(|chunk| chunk.iter().rev().fold(0, |bits, t| bits << 1 | u64::from(fits(&t.vertices))));
        let tetrahedra = tetrahedra.collect();
        AlphaComplex { mesh, radius, tetrahedra }
    }

    /// Whether tetrahedron `t` belongs to the complex.
    #[inline]
    pub fn has_tetrahedron(&self, t: usize) -> bool {
        self.tetrahedra[t / 64] >> (t % 64) & 1 == 1
    }

    /// A bit for each tetrahedron: tetrahedron `t` has bit `t % 64` of word `t / 64`.
    pub fn into_bits(self) -> Vec<u64> {
        self.tetrahedra
    }

    /// Number of tetrahedra of the complex.
    pub fn tetrahedra(&self) -> u64 {
        self.tetrahedra.iter().map(|bits| u64::from(bits.count_ones())).sum()
    }

    /// Whether an edge belongs to the complex, given its surroundings.
    pub(super) fn has_edge(&self, ring: &Ring) -> bool {
        let [a, b] = ring.ends.map(|v| self.point(v));
        if !edge_fits([a, b], &self.radius) {
            return false;
        }
        let is_inside = |&v: &u32| is_in_sphere_of_edge([a, b, self.point(v)], &self.radius);
        !ring.link.iter().any(is_inside)
            || ring.tetrahedra.iter().any(|&t| self.has_triangle_at(t, ring.ends))
    }

    /// Whether one of the two triangles of tetrahedron `t` at an edge belongs to the complex.
    fn has_triangle_at(&self, t: u32, edge: [u32; 2]) -> bool {
        let vertices = self.mesh.tetrahedra()[t as usize].vertices;
        let sides = (0..4).filter(|&side| !edge.contains(&vertices[side]));
        self.has_tetrahedron(t as usize) || sides.into_iter().any(|side| self.has_triangle(t, side))
    }

    /// Whether the triangle opposite to corner `side` of a tetrahedron belongs to the complex.
    fn has_triangle(&self, t: u32, side: usize) -> bool {
        let tetrahedron = &self.mesh.tetrahedra()[t as usize];
        let [a, b, c] = [1, 2, 3].map(|i| self.point(tetrahedron.vertices[(side + i) % 4]));
        if !triangle_fits([a, b, c], &self.radius) {
            return false;
        }
        let beyond = tetrahedron.neighbour(side);
        let other = beyond.map(|corner| {
            self.mesh.tetrahedra()[corner.tetrahedron as usize].vertices[corner.corner as usize]
        });
        let mut opposite = [Some(tetrahedron.vertices[side]), other].into_iter().flatten();
        let is_inside = |v: u32| is_in_sphere_of_triangle([a, b, c, self.point(v)], &self.radius);
        self.has_tetrahedron(t as usize)
            || beyond.is_some_and(|corner| self.has_tetrahedron(corner.tetrahedron as usize))
            || !opposite.any(is_inside)
    }

    fn point(&self, v: u32) -> Point3 {
        self.mesh.vertices()[v as usize].at
    }
}

/// Largest exponent of ten: beyond it nothing fits the range of coordinates.
const EXPONENT_MAX: i32 = 400;

/// Maximum length of the number, in characters.
const LEN_MAX: usize = 400;

/// A positive radius, exactly: the quotient of two integers.
#[derive(Debug, Clone, PartialEq)]
pub struct Radius {
    numerator: BigInt,
    denominator: BigInt,
    /// The radius as an f64, rounded a few times.
    approximate: f64,
}

impl Radius {
    /// The same radius in steps of `scale`, which stands for the shortest decimal that is rounded to it.
    pub fn in_steps(&self, scale: f64) -> Radius {
        let scale_in_digits: Radius = scale.to_string().parse().expect("a scale is a positive number");
        Radius {
            numerator: &self.numerator * scale_in_digits.denominator,
            denominator: &self.denominator * scale_in_digits.numerator,
            approximate: self.approximate / scale,
        }
    }

    /// Squares of numerator and denominator, rounded.
    pub(super) fn approximate_squares(&self) -> [Approximate; 2] {
        let radius = Approximate {
            value: self.approximate,
            error: self.approximate * 4.0 * f64::EPSILON + f64::MIN_POSITIVE,
        };
        [radius * radius, Approximate::exactly(1.0)]
    }

    /// Squares of numerator and denominator of the radius in units of 2^unit.
    pub(super) fn squares_in(&self, unit: i32) -> [BigInt; 2] {
        let shift = 2 * unit.unsigned_abs() as usize;
        let squares = [&self.numerator * &self.numerator, &self.denominator * &self.denominator];
        let [numerator, denominator] = squares;
        if unit < 0 { [numerator << shift, denominator] } else { [numerator, denominator << shift] }
    }
}

/// The value, rounded.
impl fmt::Display for Radius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.approximate)
    }
}

impl FromStr for Radius {
    type Err = String;

    /// A positive decimal number, with or without exponent.
    fn from_str(text: &str) -> Result<Radius, String> {
        let refused = || format!("{text:?} is not a positive number like 2.8");
        let approximate: f64 = text.parse().map_err(|_| refused())?;
        if !(approximate > 0.0 && approximate.is_finite() && text.len() <= LEN_MAX) {
            return Err(refused());
        }
        let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let exponent: i32 = exponent.parse().map_err(|_| refused())?;
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let numerator: BigInt = format!("{whole}{fraction}").parse().map_err(|_| refused())?;
        let exponent = exponent.saturating_sub(fraction.len() as i32);
        if exponent.abs() > EXPONENT_MAX {
            return Err(refused());
        }
        let power = BigInt::from(10).pow(exponent.unsigned_abs());
        let one = BigInt::from(1);
        let [numerator, denominator] =
            if exponent < 0 { [numerator, power] } else { [numerator * power, one] };
        Ok(Radius { numerator, denominator, approximate })
    }
}
