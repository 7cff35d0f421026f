//! Spheres and hyperplanes through points, generic in the arithmetic.

pub(super) use spmesh_delaunay::predicates::forms::{Magnitude, Number};
use spmesh_delaunay::predicates::forms::{minor, times};

/// Squared length.
#[inline(always)]
pub(super) fn lift<T: Number>(v: &[T; 4]) -> T {
    dot(v, v)
}

#[inline(always)]
pub(super) fn dot<T: Number>(p: &[T; 4], q: &[T; 4]) -> T {
    times(&p[0], &q[0]) + times(&p[1], &q[1]) + (times(&p[2], &q[2]) + times(&p[3], &q[3]))
}

/// p - o.
#[inline(always)]
pub(super) fn difference<T: Number>(p: [T; 4], o: &[T; 4]) -> [T; 4] {
    let [x, y, z, t] = p;
    [x - o[0].clone(), y - o[1].clone(), z - o[2].clone(), t - o[3].clone()]
}

/// The sphere through the origin and four vectors: (n, m) such that n . x + m |x|^2 is zero on it.
///
/// m is the determinant of the vectors. If it is positive, points inside have negative values. The value of a
/// point is the in-sphere determinant up to its sign: a polynomial of degree 6 in the coordinates (thesis
/// 3.6.2).
#[inline(always)]
pub(super) fn sphere<T: Number>(vectors: [[T; 4]; 4]) -> ([T; 4], T) {
    lifted_sphere(vectors.each_ref().map(|v| (v, lift(v))))
}

/// [`sphere`] through the origin and four vectors with their squared lengths.
#[inline(always)]
pub(super) fn lifted_sphere<T: Number>([a, b, c, d]: [(&[T; 4], T); 4]) -> ([T; 4], T) {
    let (a, b, c, d) = (row(a), row(b), row(c), row(d));
    let (p, q) = (pairs(&a, &b), pairs(&c, &d));
    let m = expansion(&p, &q, [0, 1, 2, 4, 5, 7]);
    // The lift replaces a coordinate; moving it to the end changes the sign for y and t.
    let x = expansion(&p, &q, [4, 5, 6, 7, 8, 9]); // y z t l
    let minus_y = opposite_expansion(&q, &p, [1, 2, 3, 7, 8, 9]); // x z t l
    let z = expansion(&p, &q, [0, 2, 3, 5, 6, 9]); // x y t l
    let minus_t = opposite_expansion(&q, &p, [0, 1, 3, 4, 6, 8]); // x y z l
    ([x, minus_y, z, minus_t], m)
}

#[inline(always)]
fn row<T: Number>((v, lift): (&[T; 4], T)) -> [T; 5] {
    let [x, y, z, t] = v.clone();
    [x, y, z, t, lift]
}

/// The 2x2 determinants of two rows for pairs of columns: xy, xz, xt, xl, yz, yt, yl, zt, zl, tl.
#[inline(always)]
fn pairs<T: Number>(p: &[T; 5], q: &[T; 5]) -> [T; 10] {
    [
        minor(p, q, 0, 1),
        minor(p, q, 0, 2),
        minor(p, q, 0, 3),
        minor(p, q, 0, 4),
        minor(p, q, 1, 2),
        minor(p, q, 1, 3),
        minor(p, q, 1, 4),
        minor(p, q, 2, 3),
        minor(p, q, 2, 4),
        minor(p, q, 3, 4),
    ]
}

/// Laplace's expansion of a determinant of four rows along two of them, for columns i, j, k, l, whose pairs
/// have the numbers ij, ik, il, jk, jl, kl. It is symmetric in the two pairs of rows.
#[inline(always)]
fn expansion<T: Number>(p: &[T; 10], q: &[T; 10], [ij, ik, il, jk, jl, kl]: [usize; 6]) -> T {
    (times(&p[ij], &q[kl]) + times(&p[kl], &q[ij])) - (times(&p[ik], &q[jl]) + times(&p[jl], &q[ik]))
        + (times(&p[il], &q[jk]) + times(&p[jk], &q[il]))
}

/// Minus [`expansion`]. A difference to zero would not do: [`Magnitude`] has no negative numbers.
#[inline(always)]
fn opposite_expansion<T: Number>(p: &[T; 10], q: &[T; 10], [ij, ik, il, jk, jl, kl]: [usize; 6]) -> T {
    (times(&p[ik], &q[jl]) + times(&p[jl], &q[ik]))
        - (times(&p[ij], &q[kl]) + times(&p[kl], &q[ij]))
        - (times(&p[il], &q[jk]) + times(&p[jk], &q[il]))
}

/// The vector n such that n . x is the determinant of three vectors and x.
#[inline(always)]
pub(super) fn normal<T: Number>([a, b, c]: [&[T; 4]; 3]) -> [T; 4] {
    let minors = |i: usize, j: usize, k: usize| {
        times(&a[i], &minor(b, c, j, k)) - times(&a[j], &minor(b, c, i, k)) + times(&a[k], &minor(b, c, i, j))
    };
    let opposite_minors = |i: usize, j: usize, k: usize| {
        times(&a[j], &minor(b, c, i, k)) - times(&a[i], &minor(b, c, j, k)) - times(&a[k], &minor(b, c, i, j))
    };
    [opposite_minors(1, 2, 3), minors(0, 2, 3), opposite_minors(0, 1, 3), minors(0, 1, 2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_reference::laplace::determinant;

    #[test]
    fn expansions_are_determinants() {
        let vectors = [[1, 2, -3, 4], [0, 5, 1, -2], [7, -1, 2, 3], [-4, 3, 6, 1]];
        let x = [3, -5, 2, 8];
        let (n, m) = sphere(vectors);
        assert_eq!(m, determinant(vectors));
        assert!(vectors.iter().all(|v| dot(&n, v) + m * lift(v) == 0), "the sphere is through its points");
        let lifted = |v: [i64; 4]| [v[0], v[1], v[2], v[3], lift(&v)];
        let [a, b, c, d] = vectors;
        assert_eq!(dot(&n, &x) + m * lift(&x), determinant([a, b, c, d, x].map(lifted)));
        assert_eq!(dot(&normal([&a, &b, &c]), &x), determinant([a, b, c, x]));
    }
}
