//! The weighted points, and what is decided about simplices of them.
//!
//! Points in a plane, on a line or at one place have no tetrahedra. As few points are added as it takes to
//! span the space. The flat of the given points then touches the convex hull of all in a face. So the regular
//! tetrahedralization of all contains that of the given points, in which none is hidden that was not before,
//! whatever the weights of the others are.

use std::borrow::Cow;
use std::cmp::Ordering;

use super::double::Double;
use super::orthosphere::{Fraction, Site, conflict, power};
use super::value::Value;
use crate::tess3::exact::{Approximate, Number};
use num_bigint::BigInt;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::predicates::exact_integers::decompose;

/// Fills up the vertices of a simplex with fewer than four.
pub(super) const NONE: u32 = u32::MAX;

/// The vertices of a simplex: increasing, then [`NONE`].
pub(super) type Simplex = [u32; 4];

pub(super) fn dimension(simplex: &Simplex) -> usize {
    vertices(simplex).len() - 1
}

pub(super) fn vertices(simplex: &Simplex) -> &[u32] {
    &simplex[..simplex.iter().position(|&vertex| vertex == NONE).unwrap_or(4)]
}

/// Points with weights.
#[derive(Debug)]
pub(super) struct Sites<'p> {
    points: &'p [Point3],
    weights: Option<&'p [f64]>,
    /// All coordinates are multiples of 2 to the power of this, and weights of its square.
    exponent: i32,
}

impl<'p> Sites<'p> {
    pub(super) fn new(points: &'p [Point3], weights: Option<&'p [f64]>) -> Self {
        let of_points = points.iter().flatten().filter_map(|&coordinate| last_bit(coordinate)).min();
        let of_weights =
            weights.iter().flat_map(|weights| weights.iter()).filter_map(|&weight| last_bit(weight));
        let of_weights = of_weights.min().map(|bit| bit.div_euclid(2));
        let exponent = of_points.into_iter().chain(of_weights).min().unwrap_or(0);
        Sites { points, weights, exponent }
    }

    /// Fractions are in 4 to the power of this.
    pub(super) fn exponent(&self) -> i32 {
        self.exponent
    }

    /// Whether there is a point of this index.
    pub(super) fn has(&self, index: u32) -> bool {
        (index as usize) < self.points.len()
    }

    pub(super) fn is_weighted(&self) -> bool {
        self.weights.is_some()
    }

    /// The power of the orthocentre of a simplex.
    pub(super) fn value(&self, simplex: &Simplex) -> Value {
        let vertices = vertices(simplex);
        if let &[vertex] = vertices {
            return Value::exactly(0.0 - self.weight(vertex));
        }
        let sites = vertices.iter().map(|&vertex| self.site(vertex, Double::exactly));
        let fast = power(&collected(sites)[..vertices.len()]);
        Value::of_doubles(&fast).unwrap_or_else(|| Value::of_fraction(&self.fraction(simplex), self.exponent))
    }

    /// The exact power of the orthocentre of a simplex, in 4 to the power of [`Sites::exponent`].
    pub(super) fn fraction(&self, simplex: &Simplex) -> Fraction<BigInt> {
        let sites: Vec<Site<BigInt>> = vertices(simplex).iter().map(|&vertex| self.exact(vertex)).collect();
        match &sites[..] {
            [site] => Fraction { numerator: -&site.weight, denominator: BigInt::from(1) },
            sites => power(sites),
        }
    }

    /// Whether a vertex is in conflict with the least orthosphere of a simplex.
    pub(super) fn is_in_conflict(&self, simplex: &[u32], other: u32) -> bool {
        let sites = simplex.iter().map(|&vertex| self.site(vertex, Approximate::exactly));
        let fast = conflict(&collected(sites)[..simplex.len()], &self.site(other, Approximate::exactly));
        if fast.value.abs() > fast.error {
            return fast.value < 0.0;
        }
        let sites: Vec<Site<BigInt>> = simplex.iter().map(|&vertex| self.exact(vertex)).collect();
        conflict(&sites, &self.exact(other)) < BigInt::ZERO
    }

    /// Compares two simplices by their values, of which the rounded ones are given.
    pub(super) fn compare(&self, [a, b]: [&Simplex; 2], rounded: [&Value; 2]) -> Ordering {
        let order = rounded[0].rounded_order(rounded[1]);
        let [less, greater] = if order == Ordering::Greater { [rounded[1], rounded[0]] } else { rounded };
        if a == b {
            Ordering::Equal
        } else if less.is_in_doubt(greater) {
            self.fraction(a).compare(&self.fraction(b))
        } else {
            order
        }
    }

    fn weight(&self, vertex: u32) -> f64 {
        self.weights.as_ref().map_or(0.0, |weights| weights[vertex as usize])
    }

    fn site<T: Number>(&self, vertex: u32, number: impl Fn(f64) -> T) -> Site<T> {
        Site { at: self.points[vertex as usize].map(&number), weight: number(self.weight(vertex)) }
    }

    fn exact(&self, vertex: u32) -> Site<BigInt> {
        let at = self.points[vertex as usize].map(|coordinate| multiple(coordinate, self.exponent));
        Site { at, weight: multiple(self.weight(vertex), 2 * self.exponent) }
    }
}

/// Up to four sites, the last of them repeated.
fn collected<T: Clone>(mut sites: impl Iterator<Item = Site<T>>) -> [Site<T>; 4] {
    let mut last = None;
    std::array::from_fn(|_| {
        last = sites.next().or(last.take());
        last.clone().expect("a simplex has a vertex")
    })
}

/// Exponent of the lowest bit of a number that is set; none in zero.
fn last_bit(number: f64) -> Option<i32> {
    let (significand, exponent) = decompose(number);
    (significand != 0).then(|| exponent + significand.trailing_zeros() as i32)
}

/// A number as a multiple of 2 to the power of `exponent`, which its lowest bit is not below.
fn multiple(number: f64, exponent: i32) -> BigInt {
    let (significand, own) = decompose(number);
    match usize::try_from(own - exponent) {
        _ if significand == 0 => BigInt::ZERO,
        Ok(shift) => BigInt::from(significand) << shift,
        Err(_) => BigInt::from(significand >> exponent.abs_diff(own)),
    }
}

/// The tetrahedralization of the points and of as few others as possible, which come after them.
pub(super) fn tetrahedralize(points: &[Point3], weights: Option<&[f64]>) -> Result<Tetrahedralization> {
    let mut kernel = Kernel::new();
    let mut mesh = Tetrahedralization::default();
    for axes in AXES {
        let mut all = points.to_vec();
        all.extend(axes.iter().map(|&axis| aside(points[0], axis)));
        let done = match weights {
            None => kernel.triangulate(Cow::Owned(all), &mut mesh),
            Some(weights) => {
                let weights: Vec<f64> = weights.iter().copied().chain(axes.iter().map(|_| 0.0)).collect();
                kernel.triangulate_weighted(Cow::Owned(all), &weights, &mut mesh)
            }
        };
        done.map_err(Error::of_computation)?;
        if !mesh.tetrahedra().is_empty() {
            break;
        }
    }
    Ok(mesh)
}

/// Axes along which points are added: first one point, then two, then three.
const AXES: [&[usize]; 7] = [&[0], &[1], &[2], &[0, 1], &[1, 2], &[0, 2], &[0, 1, 2]];

/// Another point on a line along an axis, exactly.
fn aside(mut point: Point3, axis: usize) -> Point3 {
    let coordinate = &mut point[axis];
    *coordinate = if *coordinate == 0.0 { 1.0 } else { -*coordinate };
    point
}
