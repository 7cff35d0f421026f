//! Exact decisions about the points of one set in space, fast enough for hundreds of sets, and the proof that
//! tetrahedra are the canonical ones. Shares no code with the library.
//!
//! A decision is made in `f64` where the error bound allows, in 128 bits where the points are small integers times a
//! power of two, and by [`super::tetrahedra`] where neither is so.

use super::exact::times_2_1074;
use super::tetrahedra::{self, ExactPoint3, as_set};
use num_bigint::BigInt;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::{Add, Mul, Sub};

/// A point of space.
pub type Point = [f64; 3];

/// A corner of a tetrahedron: its number and 0, 1, 2 or 3.
pub type Corner = (usize, usize);

/// A tetrahedron to be proved: indices of its points, and the corners that are across from its own.
pub type Claim = ([usize; 4], [Option<Corner>; 4]);

/// Distinct points.
pub struct Space {
    /// Times a power of two.
    points: Vec<Point>,
    /// Differences to the first point, times a power of two.
    small: Option<Vec<[i64; 3]>>,
    exact: OnceCell<Vec<ExactPoint3>>,
}

/// Largest difference of integers whose in-sphere determinant fits in 128 bits: with squares of lengths up to 3 * 2^48
/// and volumes up to 6 * 2^72, the sum of four products is below 2^127.
const SMALL: i64 = 1 << 24;

trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}
impl Number for f64 {}
impl Number for i128 {}

fn minus<T: Number>(p: [T; 3], q: [T; 3]) -> [T; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

fn dot<T: Number>(p: [T; 3], q: [T; 3]) -> T {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

fn volume<T: Number>(p: [T; 3], q: [T; 3], r: [T; 3]) -> T {
    dot(p, [q[1] * r[2] - q[2] * r[1], q[2] * r[0] - q[0] * r[2], q[0] * r[1] - q[1] * r[0]])
}

/// det(b - a, c - a, d - a).
fn orientation<T: Number>([a, b, c, d]: [[T; 3]; 4]) -> T {
    volume(minus(b, a), minus(c, a), minus(d, a))
}

/// The in-sphere determinant, positive if e is inside of the positive tetrahedron abcd.
fn insphere<T: Number>([a, b, c, d, e]: [[T; 3]; 5]) -> T {
    let [a, b, c, d] = [minus(a, e), minus(b, e), minus(c, e), minus(d, e)];
    (dot(a, a) * volume(b, c, d) - dot(b, b) * volume(a, c, d))
        + (dot(c, c) * volume(a, b, d) - dot(d, d) * volume(a, b, c))
}

/// Where neither products nor their errors over- or underflow.
fn is_ordinary(square: f64) -> bool {
    (1e-100..1e100).contains(&square)
}

/// The sign of a value that errs by at most `error`.
fn certain(value: f64, error: f64) -> Option<i32> {
    (value.abs() > error).then(|| if value > 0.0 { 1 } else { -1 })
}

/// The sum of the magnitudes of the products is at most 2/sqrt(3) times the product of the lengths, and 8 roundings
/// of 2^-53 each go into every one: 1.1e-15 times the lengths.
fn filtered_orientation([a, b, c, d]: [Point; 4]) -> Option<i32> {
    let [p, q, r] = [minus(b, a), minus(c, a), minus(d, a)];
    let squares = [dot(p, p), dot(q, q), dot(r, r)];
    squares.into_iter().all(is_ordinary).then_some(())?;
    certain(volume(p, q, r), 3e-15 * (squares[0].sqrt() * squares[1].sqrt() * squares[2].sqrt()))
}

/// As for the orientation, four volumes, each times a square: 17 roundings, 8/sqrt(3), 9e-15.
fn filtered_insphere(points: [Point; 5]) -> Option<i32> {
    let [a, b, c, d, e] = points;
    let squares = [a, b, c, d].map(|p| dot(minus(p, e), minus(p, e)));
    squares.into_iter().all(is_ordinary).then_some(())?;
    let greatest = squares.into_iter().fold(0.0, f64::max);
    certain(insphere(points), 3e-14 * greatest * greatest * greatest.sqrt())
}

impl Space {
    /// Decisions about `points`, which are finite.
    pub fn new(points: &[Point]) -> Space {
        let points = ordinary(points);
        Space { small: small(&points), points, exact: OnceCell::new() }
    }

    fn exact(&self) -> &[ExactPoint3] {
        self.exact.get_or_init(|| tetrahedra::exact_points(&self.points))
    }

    /// Sign of det(b - a, c - a, d - a).
    pub fn orientation(&self, corners: [usize; 4]) -> i32 {
        if let Some(sign) = filtered_orientation(corners.map(|i| self.points[i])) {
            return sign;
        }
        match &self.small {
            Some(small) => orientation(corners.map(|i| small[i].map(i128::from))).signum() as i32,
            None => tetrahedra::orientation(corners.map(|i| &self.exact()[i])),
        }
    }

    /// Sign of the in-sphere determinant, positive if e is inside of the positive tetrahedron abcd; never zero for
    /// distinct points, by the canonical perturbation.
    pub fn insphere(&self, corners: [usize; 4], e: usize) -> i32 {
        let [a, b, c, d] = corners;
        let five = [a, b, c, d, e];
        if let Some(sign) = filtered_insphere(five.map(|i| self.points[i])) {
            return sign;
        }
        match &self.small {
            Some(small) => match insphere(five.map(|i| small[i].map(i128::from))).signum() as i32 {
                0 => self.tie(corners, e),
                sign => sign,
            },
            None => tetrahedra::insphere_perturbed(five.map(|i| &self.exact()[i])),
        }
    }

    /// Of the points by descending rank the first decides whose lift makes a difference.
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

    /// The canonical Delaunay tetrahedra by definition, as [`as_set`] has them: every four points, tried against every
    /// fifth. None if all points lie in a plane.
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

    /// Proves that the claimed tetrahedra are the canonical Delaunay tetrahedra of the points, or says why not. In
    /// O(n) for each facet of the hull.
    ///
    /// All are positive, and what is across from each other has its facet in common. Facets without another tetrahedron
    /// have all points on their inner side: so the number of tetrahedra around a place changes nowhere within the hull,
    /// and it is 1 at one place. So they fill the hull. Neighbours are locally Delaunay: the lifted points are convex
    /// across all facets, hence convex.
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
        for (t, (corners, across)) in claims.iter().enumerate() {
            for side in 0..4 {
                let Some((u, other_side)) = across[side] else {
                    let beyond = |e: usize| {
                        let mut replaced = *corners;
                        replaced[side] = e;
                        !corners.contains(&e) && self.orientation(replaced) < 0
                    };
                    if let Some(e) = (0..self.points.len()).find(|&e| beyond(e)) {
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

    /// Whether the center of tetrahedron `of` is in a tetrahedron. If it is in the plane of a facet, an infinitesimal step
    /// towards corner 0 of `of` decides, then one towards corner 1, then corner 2.
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
        let center: ExactPoint3 =
            [0, 1, 2].map(|axis| of.iter().map(|&i| &self.exact()[i][axis]).sum::<BigInt>());
        let (corners, steps) = (corners.map(times_4), [of[0], of[1], of[2]].map(times_4));
        (0..4).all(|side| {
            let seen_from = |p: &ExactPoint3| {
                let mut replaced = [&corners[0], &corners[1], &corners[2], &corners[3]];
                replaced[side] = p;
                tetrahedra::orientation(replaced)
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

/// The points times a power of two that makes the greatest coordinate about 1, unless that takes bits away.
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

/// The points as integers relative to the first, if they are small.
fn small(points: &[Point]) -> Option<Vec<[i64; 3]>> {
    let numbers = points.as_flattened();
    let least = numbers.iter().filter(|c| **c != 0.0).map(|c| exponent_of_last_bit(*c)).min().unwrap_or(0);
    // Cheap to see, and almost always so if they are not small: coordinates above 2^60 units.
    if numbers.iter().any(|c| c.abs() / 2f64.powi(60) > 2f64.powi(least)) || least < -1000 {
        return None;
    }
    let unit = 2f64.powi(least);
    let integers: Vec<[i64; 3]> = points.iter().map(|p| p.map(|c| (c / unit) as i64)).collect();
    let first = integers.first().copied().unwrap_or_default();
    let differences: Vec<[i64; 3]> =
        integers.iter().map(|p| [0, 1, 2].map(|axis| p[axis] - first[axis])).collect();
    // Differences of two differences are twice as large.
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
