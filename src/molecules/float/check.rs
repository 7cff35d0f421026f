//! Exact signs and values, to count the errors of rounded arithmetic with.

use super::mesh::{faraway_corner, finite_facet};
use super::sphere::difference;
use super::stats::Stats;
use spmesh_delaunay::delaunay3::Vertex;
use spmesh_delaunay::predicates::{
    FiniteFloatPredicates, FiniteFloatPredicates3, Point3, Predicates2, Predicates3, Sign,
};

/// Integer differences below this have in-sphere determinants below 2^125.
const INTEGER_LIMIT: f64 = 8_388_608.0;

/// Exact orientation of a tetrahedron.
pub(super) fn orient3d(a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
    FiniteFloatPredicates3::default().orient3d(a, b, c, d)
}

/// Whether three points are on a line.
pub(super) fn are_collinear(a: Point3, b: Point3, c: Point3) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| {
        let [a, b, c] = [a, b, c].map(|p| [p[i], p[j]]);
        FiniteFloatPredicates::default().orient2d(a, b, c) == Sign::Zero
    })
}

/// Compares the value of a sphere, or half-space, at `p` with the exact one.
#[cold]
#[inline(never)]
pub(super) fn check(vertices: &[Vertex], corners: &[u32; 4], p: Point3, value: f64, stats: &mut Stats) {
    let point = |corner: usize| vertices[corners[corner] as usize].at;
    let exact = if let Some(corner) = faraway_corner(corners) {
        let [o, a, b] = finite_facet(corner).map(point);
        orient3d(o, a, b, p)
    } else {
        let [a, b, c, d] = [0, 1, 2, 3].map(point);
        stats.rounded += u64::from(is_rounded([a, b, c, d], p, value));
        FiniteFloatPredicates3::default().insphere(a, b, c, d, p)
    };
    if exact == Sign::Zero {
        stats.wrong_zeros += u64::from(value != 0.0);
    } else {
        // A NaN has no right sign.
        stats.wrong_signs += u64::from(value.is_nan() || Sign::of(value) != exact);
    }
}

/// Whether `value` is not the in-sphere determinant of points with integer coordinates that are near each
/// other.
fn is_rounded([o, a, b, c]: [Point3; 4], p: Point3, value: f64) -> bool {
    let is_integer = |p: Point3| p.iter().all(|x| x.trunc() == *x);
    let differences = [a, b, c, p].map(|q| difference(q, o));
    let is_small = |d: &Point3| d.iter().all(|x| x.abs() < INTEGER_LIMIT);
    if ![o, a, b, c, p].into_iter().all(is_integer) || !differences.iter().all(is_small) {
        return false;
    }
    let [a, b, c, d] = differences.map(|d| d.map(|x| x as i128));
    let dot = |p: [i128; 3], q: [i128; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let det = |p: [i128; 3], q: [i128; 3], r: [i128; 3]| {
        dot(p, [q[1] * r[2] - q[2] * r[1], q[2] * r[0] - q[0] * r[2], q[0] * r[1] - q[1] * r[0]])
    };
    let exact = dot(a, a) * det(d, b, c) + dot(b, b) * det(d, c, a) + dot(c, c) * det(d, a, b)
        - dot(d, d) * det(a, b, c);
    value as i128 != exact
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::float::sphere::Sphere;

    #[test]
    fn values_of_small_integers_are_not_rounded_and_those_of_great_ones_are() {
        let tetrahedron = [[0.0, 0.0, 0.0], [7.0, 1.0, 0.0], [3.0, 5.0, 1.0], [1.0, 2.0, 9.0]];
        for (scale, expected) in [(1.0, false), (100.0, false), (65_537.0, true)] {
            let [o, a, b, c] = tetrahedron.map(|p| p.map(|x: f64| x * scale));
            let p = [scale * 5.0, scale * 3.0 + 1.0, scale * 2.0 - 1.0];
            let value = Sphere::through(o, a, b, c).value(o, p);
            assert_eq!(is_rounded([o, a, b, c], p, value), expected, "{scale}");
        }
        let [o, a, b, c] = tetrahedron.map(|p| p.map(|x: f64| x * 0.5));
        assert!(!is_rounded([o, a, b, c], [1.0; 3], 1e300), "unknown for coordinates that are not integers");
    }
}
