//! Exact predicates for the points of one set in space, fast enough for hundreds of sets, and a proof that
//! tetrahedra are the canonical ones. Shares no code with the library.
//!
//! Predicates are evaluated in `f64` if the error bound allows. Otherwise they use 128-bit integers if the
//! points are small integers times a power of two, and arbitrary precision if not.

use super::exact::{sign, times_2_1074};
use super::exact3::ExactPoint;
use super::tetrahedra::{as_set, exact_points};
use num_bigint::BigInt;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::{Add, Mul, Sub};

/// A point in space.
pub type Point = [f64; 3];

/// A corner of a tetrahedron: the index of the tetrahedron, and 0, 1, 2 or 3.
pub type Corner = (usize, usize);

/// A tetrahedron to be proved: indices of its points, and the neighbours' corners opposite to its own.
pub type Claim = ([usize; 4], [Option<Corner>; 4]);

/// Distinct points.
pub struct Space {
    /// The points, scaled by a power of two.
    points: Vec<Point>,
    /// Differences to the first point, scaled to integers.
    small: Option<Vec<[i128; 3]>>,
    exact: OnceCell<Vec<ExactPoint>>,
}

/// Largest difference of integers for which the in-sphere determinant fits in 128 bits: squared lengths are
/// at most 3 * 2^48 and volumes at most 6 * 2^72, so the sum of four products is below 2^127.
const SMALL: i128 = 1 << 24;

trait Number: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}
impl Number for f64 {}
impl Number for i128 {}
impl Number for BigInt {}

fn minus<T: Number>(p: &[T; 3], q: &[T; 3]) -> [T; 3] {
    [0, 1, 2].map(|i| p[i].clone() - q[i].clone())
}

fn dot<T: Number>(p: &[T; 3], q: &[T; 3]) -> T {
    let [x, y, z] = [0, 1, 2].map(|i| p[i].clone() * q[i].clone());
    x + y + z
}

fn cross<T: Number>(p: &[T; 3], q: &[T; 3]) -> [T; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| p[i].clone() * q[j].clone() - p[j].clone() * q[i].clone())
}

/// det(b - a, c - a, d - a).
fn orientation<T: Number>([a, b, c, d]: [&[T; 3]; 4]) -> T {
    dot(&minus(b, a), &cross(&minus(c, a), &minus(d, a)))
}

/// The in-sphere determinant, positive if e is inside the sphere of the positive tetrahedron abcd.
fn insphere<T: Number>([a, b, c, d, e]: [&[T; 3]; 5]) -> T {
    let [a, b, c, d] = [a, b, c, d].map(|p| minus(p, e));
    let (ab, cd) = (cross(&a, &b), cross(&c, &d));
    (dot(&a, &a) * dot(&b, &cd) - dot(&b, &b) * dot(&a, &cd))
        + (dot(&c, &c) * dot(&d, &ab) - dot(&d, &d) * dot(&c, &ab))
}

/// Whether neither products with this squared length nor their errors overflow or underflow.
fn is_ordinary(square: f64) -> bool {
    (1e-100..1e100).contains(&square)
}

/// The sign of a value whose error is at most `error`, unless it is uncertain.
fn certain(value: f64, error: f64) -> Option<i32> {
    (value.abs() > error).then_some(if value > 0.0 { 1 } else { -1 })
}

/// The magnitudes of the products sum to at most 2/sqrt(3) times the product of the lengths, and each product
/// has 8 roundings of 2^-53, so the error is at most 1.1e-15 times the product of the lengths.
fn filtered_orientation(points: [&Point; 4]) -> Option<i32> {
    let [a, b, c, d] = points;
    let squares = [b, c, d].map(|p| minus(p, a)).map(|p| dot(&p, &p));
    squares.into_iter().all(is_ordinary).then_some(())?;
    certain(orientation(points), 3e-15 * (squares[0].sqrt() * squares[1].sqrt() * squares[2].sqrt()))
}

/// As for the orientation, with four volumes times a squared length each: 17 roundings and 8/sqrt(3) give
/// 9e-15.
fn filtered_insphere(points: [&Point; 5]) -> Option<i32> {
    let [a, b, c, d, e] = points;
    let squares = [a, b, c, d].map(|p| minus(p, e)).map(|p| dot(&p, &p));
    squares.into_iter().all(is_ordinary).then_some(())?;
    let greatest = squares.into_iter().fold(0.0, f64::max);
    certain(insphere(points), 3e-14 * greatest * greatest * greatest.sqrt())
}

impl Space {
    /// Predicates for `points`, which must be finite.
    pub fn new(points: &[Point]) -> Space {
        let points = ordinary(points);
        Space { small: small(&points), points, exact: OnceCell::new() }
    }

    fn exact(&self) -> &[ExactPoint] {
        self.exact.get_or_init(|| exact_points(&self.points))
    }

    /// Sign of det(b - a, c - a, d - a).
    pub fn orientation(&self, corners: [usize; 4]) -> i32 {
        if let Some(sign) = filtered_orientation(corners.map(|i| &self.points[i])) {
            return sign;
        }
        match &self.small {
            Some(small) => orientation(corners.map(|i| &small[i])).signum() as i32,
            None => sign(&orientation(corners.map(|i| &self.exact()[i]))),
        }
    }

    /// Sign of the in-sphere determinant, positive if e is inside the sphere of the positive tetrahedron
    /// abcd. The canonical perturbation makes it nonzero for distinct points.
    pub fn insphere(&self, corners: [usize; 4], e: usize) -> i32 {
        let [a, b, c, d] = corners;
        let five = [a, b, c, d, e];
        if let Some(sign) = filtered_insphere(five.map(|i| &self.points[i])) {
            return sign;
        }
        let unperturbed = match &self.small {
            Some(small) => insphere(five.map(|i| &small[i])).signum() as i32,
            None => sign(&insphere(five.map(|i| &self.exact()[i]))),
        };
        if unperturbed == 0 { self.tie(corners, e) } else { unperturbed }
    }

    /// The sign for a zero determinant: the first point by descending rank whose lift has a nonzero
    /// coefficient decides.
    fn tie(&self, corners: [usize; 4], e: usize) -> i32 {
        let [a, b, c, d] = corners;
        let mut ranked = [a, b, c, d, e];
        ranked.sort_by(|&i, &j| self.points[j].partial_cmp(&self.points[i]).expect("finite"));
        let coefficient = |i: usize| match corners.iter().position(|&corner| corner == i) {
            None => -1,
            Some(place) => {
                let mut replaced = corners;
                replaced[place] = e;
                self.orientation(replaced)
            }
        };
        ranked.into_iter().map(coefficient).find(|&sign| sign != 0).unwrap_or(0)
    }

    /// The canonical Delaunay tetrahedra by definition, in the form of [`as_set`]: every four points, tried
    /// against every fifth. No tetrahedra if all points lie in a plane.
    pub fn tetrahedra(&self) -> Vec<[u32; 4]> {
        let count = self.points.len();
        let mut found = Vec::new();
        for a in 0..count {
            for b in a + 1..count {
                for c in b + 1..count {
                    for d in c + 1..count {
                        let positive = match self.orientation([a, b, c, d]) {
                            0 => continue,
                            1 => [a, b, c, d],
                            _ => [a, b, d, c],
                        };
                        let mut others = (0..count).filter(|e| !positive.contains(e));
                        if others.all(|e| self.insphere(positive, e) < 0) {
                            found.push(positive.map(|v| v as u32));
                        }
                    }
                }
            }
        }
        as_set(found)
    }

    /// Proves that the claimed tetrahedra are the canonical Delaunay tetrahedra of the points, or says why
    /// not. Cost: O(n + h^2) for h facets of the hull.
    ///
    /// All tetrahedra are positive, and neighbours share a facet. So the number of tetrahedra that cover a
    /// place changes only at open facets. All vertices of open facets lie on the inner side of every open
    /// facet, so these facets form the convex hull of their vertices. Outside of it the number is 0, so all
    /// points are inside. Inside of it the number is constant, and it is 1 because it is 1 at one place. So
    /// the tetrahedra fill the hull. Neighbours are locally Delaunay: the lifted points are convex across
    /// every facet, hence convex.
    pub fn prove(&self, claims: &[Claim]) -> Result<(), String> {
        if claims.is_empty() {
            return if self.is_flat() { Ok(()) } else { Err("there are no tetrahedra".into()) };
        }
        self.prove_corners(claims)?;
        self.prove_facets(claims)?;
        let [a, b, c, d] = claims[0].0;
        let around = claims.iter().filter(|claim| self.is_around_center(claim.0, [a, b, c, d])).count();
        if around == 1 { Ok(()) } else { Err(format!("tetrahedron 0 is covered {around} times")) }
    }

    fn prove_corners(&self, claims: &[Claim]) -> Result<(), String> {
        let mut is_used = vec![false; self.points.len()];
        for (t, (corners, _)) in claims.iter().enumerate() {
            if corners.iter().any(|&v| v >= self.points.len()) {
                return Err(format!("tetrahedron {t} has no such points: {corners:?}"));
            }
            if self.orientation(*corners) <= 0 {
                return Err(format!("tetrahedron {t} is flat or inverted: {corners:?}"));
            }
            corners.iter().for_each(|&v| is_used[v] = true);
        }
        match is_used.iter().position(|is_used| !is_used) {
            Some(v) => Err(format!("point {v} is no vertex: {:?}", self.points[v])),
            None => Ok(()),
        }
    }

    fn prove_facets(&self, claims: &[Claim]) -> Result<(), String> {
        let hull = vertices_of_open_facets(claims);
        for (t, (corners, across)) in claims.iter().enumerate() {
            for side in 0..4 {
                let Some((u, other_side)) = across[side] else {
                    let beyond = |e: usize| {
                        let mut replaced = *corners;
                        replaced[side] = e;
                        !corners.contains(&e) && self.orientation(replaced) < 0
                    };
                    if let Some(e) = hull.iter().find(|&&e| beyond(e)) {
                        return Err(format!(
                            "point {e} is beyond side {side} of {t}, {corners:?}, on the hull"
                        ));
                    }
                    continue;
                };
                let Some((others, back)) = claims.get(u) else {
                    return Err(format!("there is no tetrahedron {u}, across side {side} of {t}"));
                };
                if other_side > 3 || back[other_side] != Some((t, side)) {
                    return Err(format!("side {side} of {t} and side {other_side} of {u} are not mutual"));
                }
                let mut facet = *corners;
                facet[side] = others[other_side];
                let mut same = [facet, *others];
                same.iter_mut().for_each(|corners| corners.sort_unstable());
                if same[0] != same[1] || facet[side] == corners[side] {
                    return Err(format!("{t}, {corners:?}, and {u}, {others:?}, do not share the facet"));
                }
                if self.orientation(facet) >= 0 {
                    return Err(format!("{t}, {corners:?}, and {u}, {others:?}, are on the same side"));
                }
                if t < u && self.insphere(*corners, others[other_side]) >= 0 {
                    return Err(format!("{t}, {corners:?}, and {u}, {others:?}, are not locally Delaunay"));
                }
            }
        }
        Ok(())
    }

    /// Whether a tetrahedron contains the centre of tetrahedron `of`. If the centre is in the plane of a
    /// facet, an infinitesimal step towards corner 0 of `of` decides, then a step towards corner 1, then
    /// corner 2.
    fn is_around_center(&self, corners: [usize; 4], of: [usize; 4]) -> bool {
        let is_apart = |axis: usize| {
            let [p, q] = [corners, of].map(|corners| corners.map(|i| self.points[i][axis]));
            let is_less = |p: [f64; 4], q: [f64; 4]| p.iter().all(|p| q.iter().all(|q| p <= q));
            is_less(p, q) || is_less(q, p)
        };
        if (0..3).any(is_apart) {
            return false;
        }
        let times_4 = |i: usize| self.exact()[i].clone().map(|c| c * BigInt::from(4));
        let center: ExactPoint =
            [0, 1, 2].map(|axis| of.iter().map(|&i| &self.exact()[i][axis]).sum::<BigInt>());
        let (corners, steps) = (corners.map(times_4), [of[0], of[1], of[2]].map(times_4));
        (0..4).all(|side| {
            let seen_from = |p: &ExactPoint| {
                let mut replaced = [&corners[0], &corners[1], &corners[2], &corners[3]];
                replaced[side] = p;
                sign(&orientation(replaced))
            };
            let signs = [&center].into_iter().chain(&steps).map(seen_from);
            signs.into_iter().find(|&sign| sign != 0).unwrap_or(0) > 0
        })
    }

    /// Whether all points lie in a plane.
    fn is_flat(&self) -> bool {
        let count = self.points.len();
        let is_line = |i: usize| {
            let exact = self.exact();
            let [p, q] = [1, i].map(|k| [0, 1, 2].map(|axis| &exact[k][axis] - &exact[0][axis]));
            [[1, 2], [2, 0], [0, 1]].into_iter().all(|[j, k]| &p[j] * &q[k] == &p[k] * &q[j])
        };
        match (2..count).find(|&i| !is_line(i)) {
            None => true,
            Some(i) => (2..count).all(|j| j == i || self.orientation([0, 1, i, j]) == 0),
        }
    }
}

fn vertices_of_open_facets(claims: &[Claim]) -> Vec<usize> {
    let open = claims.iter().flat_map(|(corners, across)| {
        (0..4)
            .filter(|&side| across[side].is_none())
            .flat_map(move |side| (0..4).filter(move |&i| i != side).map(|i| corners[i]))
    });
    let mut vertices: Vec<usize> = open.collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// The points times a power of two that makes the greatest coordinate about 1, unless the scaling is inexact.
fn ordinary(points: &[Point]) -> Vec<Point> {
    let greatest = points.as_flattened().iter().fold(0.0, |greatest: f64, c| greatest.max(c.abs()));
    let exponent = if greatest > 0.0 { greatest.log2() as i32 } else { 0 };
    let scaled = |p: &Point, exponent: i32| {
        p.map(|c| c * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2))
    };
    let ordinary: Vec<Point> = points.iter().map(|p| scaled(p, -exponent)).collect();
    let is_exact = ordinary.iter().zip(points).all(|(p, q)| scaled(p, exponent) == *q);
    if is_exact { ordinary } else { points.to_vec() }
}

/// The points as integers relative to the first point, if these are small.
fn small(points: &[Point]) -> Option<Vec<[i128; 3]>> {
    let numbers = points.as_flattened();
    let least = numbers.iter().filter(|c| **c != 0.0).map(|c| exponent_of_last_bit(*c)).min().unwrap_or(0);
    // A cheap test that finds almost all sets that are not small: coordinates above 2^60 units.
    if numbers.iter().any(|c| c.abs() / 2f64.powi(60) > 2f64.powi(least)) || least < -1000 {
        return None;
    }
    let unit = 2f64.powi(least);
    let integers: Vec<[i128; 3]> = points.iter().map(|p| p.map(|c| (c / unit) as i128)).collect();
    let first = integers.first().copied().unwrap_or_default();
    let differences: Vec<[i128; 3]> =
        integers.iter().map(|p| [0, 1, 2].map(|axis| p[axis] - first[axis])).collect();
    // The differences between these differences can be twice as large.
    differences.as_flattened().iter().all(|d| d.abs() <= SMALL / 2).then_some(differences)
}

/// The exponent of the last bit of a finite number that is not zero.
fn exponent_of_last_bit(value: f64) -> i32 {
    times_2_1074(value).trailing_zeros().expect("not zero") as i32 - 1074
}

/// The distinct points, and the index of the first equal point for each.
pub fn distinct(points: &[Point]) -> (Vec<Point>, Vec<usize>) {
    let mut places = HashMap::new();
    let mut kept = Vec::new();
    let first: Vec<usize> = (0..points.len())
        .map(|i| {
            let bits = points[i].map(|c| (c + 0.0).to_bits());
            *places.entry(bits).or_insert_with(|| {
                kept.push(points[i]);
                i
            })
        })
        .collect();
    (kept, first)
}
