//! The canonical Delaunay tetrahedralization by definition: every four points, tried against every fifth, in
//! arbitrary precision. Shares no code with the library. Cost: O(n^5), for up to about 60 points.
//!
//! The perturbation is written out: the lift of the point of rank r in lexicographic order is raised by
//! epsilon^(n - r). The in-sphere determinant is then a polynomial in infinitesimals of decreasing size. Its
//! sign is the sign of its first nonzero coefficient: the determinant itself, or the cofactor of the lift of
//! the largest point whose cofactor is nonzero.

use num_bigint::BigInt;

use super::exact::{sign, times_2_1074};
use super::exact3::{self, ExactPoint, orientation};

/// The points as integers, scaled by the power of two that makes at least one coordinate odd.
pub fn exact_points(points: &[[f64; 3]]) -> Vec<ExactPoint> {
    let integers = exact3::exact_points(points);
    let zeros = integers.as_flattened().iter().filter_map(BigInt::trailing_zeros).min().unwrap_or(0);
    integers.into_iter().map(|p| p.map(|c| c >> zeros)).collect()
}

fn minus(p: &ExactPoint, q: &ExactPoint) -> ExactPoint {
    [0, 1, 2].map(|i| &p[i] - &q[i])
}

fn cross(u: &ExactPoint, v: &ExactPoint) -> ExactPoint {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| &u[i] * &v[j] - &u[j] * &v[i])
}

pub fn dot(u: &ExactPoint, v: &ExactPoint) -> BigInt {
    &u[0] * &v[0] + &u[1] * &v[1] + &u[2] * &v[2]
}

/// det(b - a, c - a, d - a): six times the volume.
pub fn volume([a, b, c, d]: [&ExactPoint; 4]) -> BigInt {
    dot(&minus(b, a), &cross(&minus(c, a), &minus(d, a)))
}

/// A point with its weight.
type Weighted<'a> = (&'a ExactPoint, &'a BigInt);

/// The sphere of a positive tetrahedron, with weights the orthosphere. A point is inside, on or outside the
/// sphere if `side` is positive, zero or negative.
struct Sphere<'a> {
    origin: &'a ExactPoint,
    weight: &'a BigInt,
    normal: ExactPoint,
    volume: BigInt,
}

impl<'a> Sphere<'a> {
    /// `volume * lift = normal * (p - a)` holds for the four points, by Cramer's rule; the lift of p is |p -
    /// a|^2, less what p is heavier than a.
    fn of([(a, weight), b, c, d]: [Weighted<'a>; 4]) -> Self {
        let [over_b, over_c, over_d] = [b, c, d].map(|(p, w)| {
            let p = minus(p, a);
            dot(&p, &p) - w + weight
        });
        let [b, c, d] = [b, c, d].map(|(p, _)| minus(p, a));
        let (bc, cd, db) = (cross(&b, &c), cross(&c, &d), cross(&d, &b));
        let normal = [0, 1, 2].map(|i| &over_b * &cd[i] + &over_c * &db[i] + &over_d * &bc[i]);
        Sphere { origin: a, weight, normal, volume: dot(&b, &cd) }
    }

    fn side(&self, (p, weight): Weighted<'_>) -> i32 {
        let p = minus(p, self.origin);
        sign(&(dot(&self.normal, &p) - &self.volume * (dot(&p, &p) - weight + self.weight)))
    }
}

/// The side of e if it is on the sphere: the sign of the first nonzero cofactor by descending rank.
fn tie([a, b, c, d, e]: [&ExactPoint; 5]) -> i32 {
    let mut cofactors = [
        (a, volume([e, b, c, d])),
        (b, volume([a, e, c, d])),
        (c, volume([a, b, e, d])),
        (d, volume([a, b, c, e])),
        (e, -volume([a, b, c, d])),
    ];
    cofactors.sort_by(|(p, _), (q, _)| q.cmp(p));
    cofactors.iter().map(|(_, cofactor)| sign(cofactor)).find(|&sign| sign != 0).unwrap_or(0)
}

/// Canonical Delaunay tetrahedra of distinct points, in the form of [`as_set`]. No tetrahedra if all points
/// lie in a plane.
pub fn tetrahedra(points: &[[f64; 3]]) -> Vec<[u32; 4]> {
    by_definition(&exact_points(points), &vec![BigInt::ZERO; points.len()])
}

/// Canonical regular tetrahedra of distinct points with weights, in the form of [`as_set`].
pub fn regular(points: &[[f64; 3]], weights: &[f64]) -> Vec<[u32; 4]> {
    // 2^1074 squared.
    let weights: Vec<BigInt> = weights.iter().map(|&weight| times_2_1074(weight) << 1074).collect();
    by_definition(&exact3::exact_points(points), &weights)
}

fn by_definition(exact: &[ExactPoint], weights: &[BigInt]) -> Vec<[u32; 4]> {
    let count = exact.len();
    let mut found = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            for c in b + 1..count {
                for d in c + 1..count {
                    let positive = match orientation([a, b, c, d].map(|i| &exact[i])) {
                        0 => continue,
                        1 => [a, b, c, d],
                        _ => [a, b, d, c],
                    };
                    if is_empty(exact, weights, positive) {
                        found.push(positive.map(|v| v as u32));
                    }
                }
            }
        }
    }
    as_set(found)
}

fn is_empty(points: &[ExactPoint], weights: &[BigInt], tetrahedron: [usize; 4]) -> bool {
    let [a, b, c, d] = tetrahedron.map(|i| &points[i]);
    let sphere = Sphere::of(tetrahedron.map(|i| (&points[i], &weights[i])));
    let others = (0..points.len()).filter(|e| !tetrahedron.contains(e));
    others.into_iter().all(|e| match sphere.side((&points[e], &weights[e])) {
        0 => {
            let side = tie([a, b, c, d, &points[e]]);
            assert_ne!(side, 0, "the perturbation decides");
            side < 0
        }
        side => side < 0,
    })
}

/// A tetrahedron as vertex indices in increasing order, with the last two exchanged if the orientation
/// requires it.
pub fn normalised(tetrahedron: [u32; 4]) -> [u32; 4] {
    let mut sorted = tetrahedron;
    let mut is_odd = false;
    for end in (1..4).rev() {
        for i in 0..end {
            if sorted[i] > sorted[i + 1] {
                sorted.swap(i, i + 1);
                is_odd = !is_odd;
            }
        }
    }
    if is_odd {
        sorted.swap(2, 3);
    }
    sorted
}

/// Tetrahedra as a sorted set.
pub fn as_set(tetrahedra: impl IntoIterator<Item = [u32; 4]>) -> Vec<[u32; 4]> {
    let mut set: Vec<[u32; 4]> = tetrahedra.into_iter().map(normalised).collect();
    set.sort_unstable();
    set
}
