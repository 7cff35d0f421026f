//! Orientation and in-sphere in space.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use num_bigint::BigInt;

use super::dyadic::{Wide, differences, integers, small_differences};
use super::{Decided, ROUNDING, decide, decided, plane, power_of_two};

/// A position in space, in stored coordinates. All three are finite.
pub(crate) type Xyz = [f64; 3];

/// Whether det(b - a, c - a, d - a) is positive (`Greater`), negative (`Less`) or zero (`Equal`): seen from
/// `d`, the triangle `a`, `b`, `c` is counterclockwise, clockwise, or flat.
pub(crate) fn orientation(a: Xyz, b: Xyz, c: Xyz, d: Xyz) -> Decided {
    decided(filtered_orientation(a, b, c, d), || exact_orientation(a, b, c, d))
}

/// Whether `e` lies inside (`Greater`), outside (`Less`) or on (`Equal`) the sphere of the positive
/// tetrahedron `a`, `b`, `c`, `d`.
pub(crate) fn in_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz, e: Xyz) -> Decided {
    decided(filtered_in_sphere(a, b, c, d, e), || exact_in_sphere(a, b, c, d, e))
}

/// Whether `e`, which lies on the sphere of the positive tetrahedron `a`, `b`, `c`, `d`, counts as inside or
/// outside after the symbolic perturbation: every lift x² + y² + z² is raised by an infinitesimal, and the
/// lifts of lexicographically larger points by infinitely more.
///
/// The in-sphere determinant is linear in the lifts, so that the largest point whose coefficient is not zero
/// decides. The coefficient of a vertex of the tetrahedron is the orientation of the tetrahedron with the
/// vertex replaced by `e`; the coefficient of `e` is minus the orientation of the tetrahedron, which is not
/// zero.
pub(crate) fn in_raised_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz, e: Xyz) -> Ordering {
    let mut by_rank =
        [(a, [e, b, c, d]), (b, [a, e, c, d]), (c, [a, b, e, d]), (d, [a, b, c, e]), (e, [b, a, c, d])];
    by_rank.sort_by(|(p, _), (q, _)| lexicographic(*q, *p));
    by_rank
        .iter()
        .map(|&(_, [p, q, r, s])| orientation(p, q, r, s).sign)
        .find(|&sign| sign != Ordering::Equal)
        .unwrap_or(Ordering::Equal)
}

/// Whether `a`, `b` and `c` lie on a line: they do in all three projections.
pub(crate) fn are_collinear(a: Xyz, b: Xyz, c: Xyz) -> bool {
    normal_signs(a, b, c).all(|sign| sign == Ordering::Equal)
}

/// Whether the side from which the triangle `a`, `b`, `c` is counterclockwise faces the direction (1, e, e²)
/// for any infinitesimal e: whether the first nonzero component of its normal is positive.
pub(crate) fn faces_ahead(a: Xyz, b: Xyz, c: Xyz) -> bool {
    facing(a, b, c) == Ordering::Greater
}

/// The sign of [`faces_ahead`]: `Less` for the opposite direction, `Equal` if the points lie on a line.
pub(crate) fn facing(a: Xyz, b: Xyz, c: Xyz) -> Ordering {
    normal_signs(a, b, c).find(|&sign| sign != Ordering::Equal).unwrap_or(Ordering::Equal)
}

/// Centre and radius of a sphere that contains the sphere of a tetrahedron; `None` if rounding hides it.
///
/// Relative to `d`, the centre is (|a|² b x c + |b|² c x a + |c|² a x b) / (2 det(a, b, c)). Numerator and
/// determinant are sums of products of at most five factors, with relative errors below 16 `ROUNDING` of the
/// products of norms; `slack` counts 64 of them, relative to the determinant.
pub(crate) fn enclosing_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz) -> Option<(Xyz, f64)> {
    let vectors = [a, b, c].map(|p| [p[0] - d[0], p[1] - d[1], p[2] - d[2]]);
    let squares = vectors.map(|[x, y, z]| x * x + y * y + z * z);
    let norms = vectors.map(|[x, y, z]: Xyz| x.abs() + y.abs() + z.abs());
    if !squares.iter().all(|square| (power_of_two(-200)..power_of_two(200)).contains(square)) {
        return None;
    }
    let cross =
        |p: Xyz, q: Xyz| [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    let [a, b, c] = vectors;
    let normals = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = a[0] * normals[0][0] + a[1] * normals[0][1] + a[2] * normals[0][2];
    let slack = 64.0 * ROUNDING * norms[0] * norms[1] * norms[2] / determinant.abs();
    let sum = |axis: usize| (0..3).map(|i| squares[i] * normals[i][axis]).sum::<f64>();
    let offset = [0, 1, 2].map(|axis| sum(axis) / (2.0 * determinant));
    let length = (offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]).sqrt();
    // Each square is at most the square of its norm.
    let error = slack * (norms[0] + norms[1] + norms[2] + 2.0 * length);
    let radius = (length + 2.0 * error) * (1.0 + 1e-9);
    let centre = std::array::from_fn(|axis| d[axis] + offset[axis]);
    let rounding = d.iter().map(|x| x.abs()).fold(radius, f64::max) * 4.0 * ROUNDING;
    (slack < 1e-3 && radius.is_finite()).then_some((centre, radius + rounding))
}

/// The signs of the components of (b - a) x (c - a), which are areas in the three projections.
fn normal_signs(a: Xyz, b: Xyz, c: Xyz) -> impl Iterator<Item = Ordering> {
    [[1, 2], [2, 0], [0, 1]].into_iter().map(move |axes| {
        let [a, b, c] = [a, b, c].map(|point| axes.map(|axis: usize| point[axis]));
        plane::orientation(a, b, c).sign
    })
}

/// Order by x, then by y, then by z.
pub(crate) fn lexicographic(p: Xyz, q: Xyz) -> Ordering {
    p.partial_cmp(&q).expect("coordinates are finite")
}

/// det(b - a, c - a, d - a) in plain f64, and the sum of the magnitudes of its six products.
#[inline]
fn estimated_orientation(a: Xyz, b: Xyz, c: Xyz, d: Xyz) -> (f64, f64) {
    let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let (mut determinant, mut magnitude) = (0.0, 0.0);
    for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        let (left, right) = (u[i] * v[j], u[j] * v[i]);
        determinant += w[k] * (left - right);
        magnitude += w[k].abs() * (left.abs() + right.abs());
    }
    (determinant, magnitude)
}

/// The sign of det(b - a, c - a, d - a) that plain f64 arithmetic finds, rounding as it may.
pub(crate) fn float_orientation(a: Xyz, b: Xyz, c: Xyz, d: Xyz) -> Ordering {
    sign_of(estimated_orientation(a, b, c, d).0)
}

/// Each of the six monomials passes at most 8 roundings: three differences, a product and its difference, the
/// product of both and two sums. So the error is below 8.1 `ROUNDING` times the sum of their magnitudes, and
/// that is at most 8.1 `ROUNDING` above its own rounded value; 10 covers both.
///
/// Underflow: a product errs by at most 2^-1075 on top. With a third factor below 2^200 all such errors
/// together stay below 2^-870. What overflows compares false.
fn filtered_orientation(a: Xyz, b: Xyz, c: Xyz, d: Xyz) -> Option<Ordering> {
    let (determinant, magnitude) = estimated_orientation(a, b, c, d);
    let in_range = (0..3).all(|axis| (d[axis] - a[axis]).abs() < FACTOR_OF_FILTER);
    decide(determinant, 10.0 * ROUNDING * magnitude + UNDERFLOW_OF_VOLUME).filter(|_| in_range)
}

/// 2^200.
const FACTOR_OF_FILTER: f64 = power_of_two(200);

/// 2^-800.
const UNDERFLOW_OF_VOLUME: f64 = power_of_two(-800);

/// The in-sphere determinant in plain f64, the sum of the magnitudes of its monomials, and the sum of the
/// lifts.
#[inline]
fn estimated_in_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz, e: Xyz) -> (f64, f64, f64) {
    estimated_lifted([a, b, c, d], e, [0.0; 4])
}

/// The same with lifts that are lowered; then `magnitude` has the magnitudes of both parts of a lift.
#[inline]
pub(super) fn estimated_lifted(abcd: [Xyz; 4], e: Xyz, lowered: [f64; 4]) -> (f64, f64, f64) {
    let vectors = abcd.map(|p| [p[0] - e[0], p[1] - e[1], p[2] - e[2]]);
    let squares = vectors.map(|p| p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    let [a, b, c, d] = vectors;
    let minor = |p: Xyz, q: Xyz| {
        let (left, right) = (p[0] * q[1], p[1] * q[0]);
        (left - right, left.abs() + right.abs())
    };
    let (ab, bc, cd, da) = (minor(a, b), minor(b, c), minor(c, d), minor(d, a));
    let (ac, bd) = (minor(a, c), minor(b, d));
    let [az, bz, cz, dz] = [a[2], b[2], c[2], d[2]];
    // The 3 x 3 minors bcd, cda and so on, each of which is multiplied by the lift of the fourth point.
    let bcd = bz * cd.0 - cz * bd.0 + dz * bc.0;
    let cda = cz * da.0 + dz * ac.0 + az * cd.0;
    let dab = dz * ab.0 + az * bd.0 + bz * da.0;
    let abc = az * bc.0 - bz * ac.0 + cz * ab.0;
    let [az, bz, cz, dz] = [az, bz, cz, dz].map(f64::abs);
    let lifts: [f64; 4] = std::array::from_fn(|i| squares[i] + lowered[i].abs());
    let magnitude = (lifts[0] * (bz * cd.1 + cz * bd.1 + dz * bc.1)
        + lifts[1] * (cz * da.1 + dz * ac.1 + az * cd.1))
        + (lifts[2] * (dz * ab.1 + az * bd.1 + bz * da.1) + lifts[3] * (az * bc.1 + bz * ac.1 + cz * ab.1));
    let [a, b, c, d]: [f64; 4] = std::array::from_fn(|i| squares[i] - lowered[i]);
    let determinant = (a * bcd - b * cda) + (c * dab - d * abc);
    (determinant, magnitude, lifts[0] + lifts[1] + lifts[2] + lifts[3])
}

/// The sign of the in-sphere determinant that plain f64 arithmetic finds, rounding as it may.
pub(crate) fn float_in_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz, e: Xyz) -> Ordering {
    sign_of(estimated_in_sphere(a, b, c, d, e).0)
}

/// Each monomial passes at most 16 roundings: five differences, a square and two sums, a product and its
/// difference, the product with z and two sums, the product of both and two sums. So the error is below 16.1
/// `ROUNDING` times the sum of the magnitudes, and that is at most 16.1 `ROUNDING` above its own rounded
/// value; 18 covers both.
///
/// Underflow: a product errs by at most 2^-1075 on top. With all lifts below 2^400, differences are below
/// 2^200, products of two of them and lifts below 2^402 and minors below 2^604, so that all such errors
/// together stay below 2^-450.
fn filtered_in_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz, e: Xyz) -> Option<Ordering> {
    let (determinant, magnitude, lifts) = estimated_in_sphere(a, b, c, d, e);
    decide(determinant, 18.0 * ROUNDING * magnitude + UNDERFLOW_OF_SPHERE).filter(|_| lifts < LIFT_OF_FILTER)
}

/// 2^400.
pub(super) const LIFT_OF_FILTER: f64 = power_of_two(400);

/// 2^-440.
pub(super) const UNDERFLOW_OF_SPHERE: f64 = power_of_two(-440);

fn sign_of(value: f64) -> Ordering {
    value.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

fn exact_orientation(a: Xyz, b: Xyz, c: Xyz, d: Xyz) -> Ordering {
    let Some([b, c, d, _]) = small_differences([b, c, d, a]) else {
        let [a, b, c, d] = integers([a, b, c, d]);
        return volume(differences([b, c, d], &a)).cmp(&BigInt::ZERO);
    };
    let is_short = [b, c, d].as_flattened().iter().all(|&difference| difference.abs() <= 1 << 41);
    if is_short {
        // A product of three differences has at most 123 bits, the sum of six 126.
        volume([b, c, d].map(|point| point.map(i128::from))).cmp(&0)
    } else {
        volume([b, c, d].map(|point| point.map(Wide::from))).sign()
    }
}

/// The determinant of three rows.
fn volume<T>([u, v, w]: [[T; 3]; 3]) -> T
where
    T: Clone + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let [minor_x, minor_y, minor_z] = cross(&u, &v);
    let [x, y, z] = w;
    x * minor_x + y * minor_y + z * minor_z
}

fn cross<T>(u: &[T; 3], v: &[T; 3]) -> [T; 3]
where
    T: Clone + Sub<Output = T> + Mul<Output = T>,
{
    let minor = |i: usize, j: usize| u[i].clone() * v[j].clone() - u[j].clone() * v[i].clone();
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn exact_in_sphere(a: Xyz, b: Xyz, c: Xyz, d: Xyz, e: Xyz) -> Ordering {
    let Some([a, b, c, d, _]) = small_differences([a, b, c, d, e]) else {
        let [a, b, c, d, e] = integers([a, b, c, d, e]);
        return raised_volumes(differences([a, b, c, d], &e)).cmp(&BigInt::ZERO);
    };
    let is_short = [a, b, c, d].as_flattened().iter().all(|&difference| difference.abs() <= 1 << 24);
    if is_short {
        // A lift is at most 3 * 2^48, a minor 6 * 2^72, so the sum of four products 72 * 2^120.
        raised_volumes([a, b, c, d].map(|point| point.map(i128::from))).cmp(&0)
    } else {
        raised_volumes([a, b, c, d].map(|point| point.map(Wide::from))).sign()
    }
}

/// The in-sphere determinant of four points relative to the fifth: lifts times the volumes of the three
/// others.
fn raised_volumes<T>(points: [[T; 3]; 4]) -> T
where
    T: Clone + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let lifts = points.each_ref().map(square);
    lifted_volumes(points, lifts)
}

pub(super) fn square<T>([x, y, z]: &[T; 3]) -> T
where
    T: Clone + Add<Output = T> + Mul<Output = T>,
{
    x.clone() * x.clone() + y.clone() * y.clone() + z.clone() * z.clone()
}

/// The same for these lifts.
pub(super) fn lifted_volumes<T>([a, b, c, d]: [[T; 3]; 4], [p, q, r, s]: [T; 4]) -> T
where
    T: Clone + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let dot = |u: &[T; 3], v: &[T; 3]| {
        u[0].clone() * v[0].clone() + u[1].clone() * v[1].clone() + u[2].clone() * v[2].clone()
    };
    let (ab, cd) = (cross(&a, &b), cross(&c, &d));
    p * dot(&b, &cd) - q * dot(&a, &cd) + r * dot(&d, &ab) - s * dot(&c, &ab)
}

#[cfg(test)]
mod tests {
    use super::super::random;
    use super::*;

    /// A positive tetrahedron of corners of the unit cube, and another corner.
    const CUBE: [Xyz; 5] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];

    /// Every route of the arithmetic: 128 bits, 320 bits, and big integers.
    #[test]
    fn cospherical_points_are_found_at_every_size() {
        for scale in [1.0, 3.0, 1e7, 1e5 / 3.0, 1e9 / 7.0, 2f64.powi(40) + 1.0, 1e300, 5e-324, 1e-200] {
            let [a, b, c, d, e] = CUBE.map(|point| point.map(|value| value * scale));
            assert_eq!(orientation(a, b, c, d).sign, Ordering::Greater, "{scale}");
            assert_eq!(orientation(a, c, b, d).sign, Ordering::Less, "{scale}");
            assert_eq!(orientation(a, b, c, [e[0], e[1], 0.0]).sign, Ordering::Equal, "{scale}");
            assert_eq!(in_sphere(a, b, c, d, e), Decided { sign: Ordering::Equal, exactly: true }, "{scale}");
            let (below, above) = (e[2].next_down(), e[2].next_up());
            assert_eq!(in_sphere(a, b, c, d, [e[0], e[1], above]).sign, Ordering::Less, "{scale}");
            if scale > 1e-300 {
                assert_eq!(in_sphere(a, b, c, d, [e[0], e[1], below]).sign, Ordering::Greater, "{scale}");
            }
        }
    }

    #[test]
    fn far_offsets_do_not_hide_the_last_bit() {
        let offset = [4_503_599_627_370_496.0, -1e15, 1e14];
        let [a, b, c, d, e] = CUBE.map(|point| [0, 1, 2].map(|i| point[i] * 4.0 + offset[i]));
        assert_eq!(in_sphere(a, b, c, d, e).sign, Ordering::Equal);
        assert_eq!(in_sphere(a, b, c, d, [e[0], e[1], e[2] + 0.25]).sign, Ordering::Less);
        assert_eq!(in_sphere(a, b, c, d, [e[0], e[1], e[2] - 0.25]).sign, Ordering::Greater);
        let [flat, up] = [1e-300, 1e-300f64.next_up()].map(|z| [-1e300, -1e300, -z]);
        assert_eq!(
            orientation([0.0; 3], [1e300, 0.0, 0.0], [1e300, 1e300, 1e-300], flat).sign,
            Ordering::Equal
        );
        assert_eq!(orientation([0.0; 3], [1e300, 0.0, 0.0], [1e300, 1e300, 1e-300], up).sign, Ordering::Less);
    }

    /// At the limit of what is evaluated in 128 bits, and just beyond it.
    #[test]
    fn the_largest_integers_of_each_route_are_right() {
        for bits in [23, 24, 25, 39, 40, 41, 42, 52, 60] {
            let side = 2f64.powi(bits);
            let cube = |[x, y, z]: [f64; 3]| [x, y, z].map(|c| if c > 0.0 { side } else { -side });
            let (a, b, c, d) = (cube([0.0; 3]), cube(CUBE[1]), cube(CUBE[2]), cube(CUBE[3]));
            let e = cube(CUBE[4]);
            assert_eq!(in_sphere(a, b, c, d, e).sign, Ordering::Equal, "{bits}");
            let (inside, outside) = ([e[0], e[1], e[2].next_down()], [e[0], e[1], e[2].next_up()]);
            assert_eq!(exact_in_sphere(a, b, c, d, inside), Ordering::Greater, "{bits}");
            assert_eq!(exact_in_sphere(a, b, c, d, outside), Ordering::Less, "{bits}");
            assert_eq!(exact_orientation(a, b, c, d), Ordering::Greater, "{bits}");
            let (f, g) = (cube([0.0, 1.0, 1.0]), cube([1.0, 1.0, 0.0]));
            assert_eq!(exact_orientation(a, g, d, e), Ordering::Equal, "{bits}");
            assert_eq!(exact_orientation(a, b, f, e), Ordering::Equal, "{bits}");
        }
    }

    /// A filter with a wrong bound would disagree with the integers near zero.
    #[test]
    fn filter_and_integers_agree() {
        let mut random = random(88_172_645_463_325_252);
        let mut decided = [0, 0];
        for round in 0..20_000 {
            let shift = [random(1e3), random(1e3), random(1e3)];
            let [a, b, c, d, e] = [(); 5].map(|()| {
                let (angle, height) = (random(6.2), random(2.0));
                let radius = (1.0 - height * height).sqrt();
                [angle.cos() * radius + shift[0], angle.sin() * radius + shift[1], height + shift[2]]
            });
            let range = [1e-12, 1e-13, 1e-15][round % 3];
            let e = [e[0] + random(range), e[1] + random(range), e[2] + random(range)];
            if let Some(sign) = filtered_in_sphere(a, b, c, d, e) {
                decided[0] += 1;
                assert_eq!(sign, exact_in_sphere(a, b, c, d, e), "{a:?} {b:?} {c:?} {d:?} {e:?}");
            }
            let (s, t) = (random(2.0), random(2.0));
            let flat = [0, 1, 2].map(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]) + random(range));
            if let Some(sign) = filtered_orientation(a, b, c, flat) {
                decided[1] += 1;
                assert_eq!(sign, exact_orientation(a, b, c, flat), "{a:?} {b:?} {c:?} {flat:?}");
            }
        }
        assert!(
            decided.iter().all(|&count| (100..20_000).contains(&count)),
            "{decided:?} reached the filter"
        );
    }

    /// The largest point decides, whichever argument it is. If its coefficient is zero, the next one decides.
    #[test]
    fn ties_are_broken_by_the_largest_point() {
        let [a, b, c, d, e] = CUBE;
        assert_eq!(in_raised_sphere(a, b, c, d, e), Ordering::Less, "(1, 1, 1) lies outside");
        // The largest is (1, 1, 0), and the tetrahedron with it in place of d is flat; then (1, 0, 0).
        let f = [1.0, 1.0, 0.0];
        assert_eq!(in_raised_sphere(a, b, c, d, f), Ordering::Less);
        assert_eq!(in_raised_sphere(a, b, f, d, c), Ordering::Greater);
        assert_eq!(in_raised_sphere(b, f, c, d, a), Ordering::Less);
    }

    /// Facets that contain the direction of x, or the directions of x and y, are told apart by the next axis.
    #[test]
    fn facets_face_a_direction_near_the_first_axis() {
        let [o, x, y, z, _] = CUBE;
        for (facet, is_ahead) in
            [([x, y, z], true), ([o, z, y], false), ([o, x, z], false), ([o, y, x], false)]
        {
            let [a, b, c] = facet;
            assert_eq!(faces_ahead(a, b, c), is_ahead, "{facet:?}");
            assert_eq!(faces_ahead(b, c, a), is_ahead, "{facet:?}");
            assert_eq!(faces_ahead(b, a, c), !is_ahead, "{facet:?}");
        }
    }

    #[test]
    fn lines_are_found_in_every_direction() {
        let steps = [[1.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 0.1], [1.0, 0.1, 1e-9], [0.0, 1.0, 3.0]];
        for step in steps {
            let at = |times: f64| [0, 1, 2].map(|i| 8.0 + times * step[i]);
            let [p, q, r] = [at(0.0), at(2.0), at(4.0)].map(|p| p.map(|c| (c * 1024.0).round()));
            assert!(are_collinear(p, q, r) || step[2] == 1e-9, "{step:?}");
            assert!(!are_collinear(p, q, [r[0] + 1.0, r[1] + 2.0, r[2] - 7.0]));
        }
    }
}
