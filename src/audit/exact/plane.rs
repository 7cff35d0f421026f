//! Orientation and in-circle in the plane.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use num_bigint::BigInt;

use super::dyadic::{Wide, differences, integers, small_differences};
use super::{Decided, ROUNDING, decide, decided, power_of_two};

/// A position in the plane, in stored coordinates. Both are finite.
pub(crate) type Xy = [f64; 2];

/// Whether `a`, `b`, `c` turn left (`Greater`), right (`Less`) or lie on a line (`Equal`).
pub(crate) fn orientation(a: Xy, b: Xy, c: Xy) -> Decided {
    decided(filtered_orientation(a, b, c), || exact_orientation(a, b, c))
}

/// Whether `d` lies inside (`Greater`), outside (`Less`) or on (`Equal`) the circle of the counterclockwise
/// triangle `a`, `b`, `c`.
pub(crate) fn in_circle(a: Xy, b: Xy, c: Xy, d: Xy) -> Decided {
    decided(filtered_in_circle(a, b, c, d), || exact_in_circle(a, b, c, d))
}

/// Whether `d`, which lies on the circle of the counterclockwise triangle `a`, `b`, `c`, counts as inside or
/// outside after the symbolic perturbation: every lift x² + y² is raised by an infinitesimal, and the lifts
/// of lexicographically larger points by infinitely more. `Equal` if no perturbation separates them, which
/// takes four points on a line.
///
/// The in-circle determinant is linear in the lifts, so that the largest point whose coefficient is not zero
/// decides. The coefficient of a vertex of the triangle is the orientation of the three other points with the
/// vertex replaced by `d`; the coefficient of `d` is minus the orientation of the triangle.
pub(crate) fn in_raised_circle(a: Xy, b: Xy, c: Xy, d: Xy) -> Ordering {
    let mut by_rank = [(a, [d, b, c]), (b, [a, d, c]), (c, [a, b, d]), (d, [a, c, b])];
    by_rank.sort_by(|(p, _), (q, _)| lexicographic(*q, *p));
    by_rank
        .iter()
        .map(|&(_, [p, q, r])| orientation(p, q, r).sign)
        .find(|&sign| sign != Ordering::Equal)
        .unwrap_or(Ordering::Equal)
}

/// Centre and radius of a circle that contains the circle of a triangle; `None` if rounding hides it.
///
/// Relative to `c`, the centre is (|a|² b_y - |b|² a_y, |b|² a_x - |a|² b_x) / (2 det(a, b)). Numerators and
/// determinant are sums of products of at most three factors, with relative errors below 16 `ROUNDING` of the
/// products of norms; `slack` counts 64 of them, relative to the determinant.
pub(crate) fn enclosing_circle(a: Xy, b: Xy, c: Xy) -> Option<(Xy, f64)> {
    let [a, b] = [a, b].map(|p| [p[0] - c[0], p[1] - c[1]]);
    let squares = [a, b].map(|[x, y]| x * x + y * y);
    let norms = [a, b].map(|[x, y]: Xy| x.abs() + y.abs());
    if !squares.iter().all(|square| (power_of_two(-200)..power_of_two(200)).contains(square)) {
        return None;
    }
    let determinant = a[0] * b[1] - a[1] * b[0];
    let slack = 64.0 * ROUNDING * norms[0] * norms[1] / determinant.abs();
    let offset = [
        (squares[0] * b[1] - squares[1] * a[1]) / (2.0 * determinant),
        (squares[1] * a[0] - squares[0] * b[0]) / (2.0 * determinant),
    ];
    let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
    // Each square is at most the square of its norm.
    let error = slack * (norms[0] + norms[1] + 2.0 * length);
    let radius = (length + 2.0 * error) * (1.0 + 1e-9);
    let rounding = c.iter().map(|x| x.abs()).fold(radius, f64::max) * 4.0 * ROUNDING;
    (slack < 1e-3 && radius.is_finite()).then_some(([c[0] + offset[0], c[1] + offset[1]], radius + rounding))
}

/// Whether a segment is longer than `length`, which is not negative.
pub(crate) fn is_longer([p, q]: [Xy; 2], length: f64) -> bool {
    let [p, q, [length, _]] = integers([p, q, [length, 0.0]]);
    let [[x, y]] = differences([p], &q);
    &x * &x + &y * &y > &length * &length
}

/// Order by x, then by y.
pub(crate) fn lexicographic(p: Xy, q: Xy) -> Ordering {
    p.partial_cmp(&q).expect("coordinates are finite")
}

/// Whether the vertical distance of `point` from the counterclockwise triangle with these corners, in which
/// it is, exceeds `most` (`Greater`), which is not negative, or is equal to it or less.
pub(crate) fn distance_to(corners: [[f64; 3]; 3], point: [f64; 3], most: f64) -> Decided {
    decided(filtered_distance(corners, point, most), || exact_distance(corners, point, most))
}

/// The signed volume below the point, with shares of the corners of the area as weights of their heights, is
/// compared with the area times `most`. A share passes four roundings, its product with a height three more,
/// and sums two; 16 covers those of the bound.
fn filtered_distance(corners: [[f64; 3]; 3], point: [f64; 3], most: f64) -> Option<Ordering> {
    let rise = corners.map(|corner| [0, 1, 2].map(|axis| corner[axis] - point[axis]));
    let (mut volume, mut area, mut magnitude) = (0.0f64, 0.0, 0.0);
    for corner in 0..3 {
        let [p, q] = [1, 2].map(|turn| rise[(corner + turn) % 3]);
        let (left, right) = (p[0] * q[1], p[1] * q[0]);
        volume += (left - right) * rise[corner][2];
        area += left - right;
        magnitude += (left.abs() + right.abs()) * (rise[corner][2].abs() + most);
    }
    let error = 16.0 * ROUNDING * magnitude + UNDERFLOW_OF_CIRCLE;
    decide(volume.abs() - area * most, error).filter(|_| magnitude < LIFT_OF_FILTER)
}

fn exact_distance([a, b, c]: [[f64; 3]; 3], point: [f64; 3], most: f64) -> Ordering {
    let [a, b, c, [most, ..], point] = integers([a, b, c, [most, 0.0, 0.0], point]);
    let rise = differences([a, b, c], &point);
    let share = |corner: usize| {
        let [p, q] = [1, 2].map(|turn| &rise[(corner + turn) % 3]);
        &p[0] * &q[1] - &p[1] * &q[0]
    };
    let volume: BigInt = (0..3).map(|corner| share(corner) * &rise[corner][2]).sum();
    let area: BigInt = (0..3).map(share).sum();
    let limit = area * most;
    if volume < BigInt::ZERO { (-volume).cmp(&limit) } else { volume.cmp(&limit) }
}

/// Each of the two products of `(a - c) x (b - c)` passes four roundings (two differences, the product, the
/// last difference), hence an error of at most 4.1 `ROUNDING` times the sum of their magnitudes; 8 covers the
/// rounding of that sum too. Products that underflow err by less than 2^-1000. What overflows compares false.
fn filtered_orientation(a: Xy, b: Xy, c: Xy) -> Option<Ordering> {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let determinant = left - right;
    let error = 8.0 * ROUNDING * (left.abs() + right.abs()) + UNDERFLOW_OF_AREA;
    decide(determinant, error)
}

/// 2^-1000.
const UNDERFLOW_OF_AREA: f64 = power_of_two(-1000);

/// Each monomial passes at most 11 roundings: four differences, a square and its sum, a product and its
/// difference, the product of both and two sums. So the error is below 12 `ROUNDING` times the sum of the
/// magnitudes; 16 covers the roundings of that sum.
///
/// Underflow: a product errs by at most 2^-1075 on top. With all lifts below 2^400, differences are below
/// 2^200 and lifts and minors below 2^402, so that all such errors together stay below 2^-600.
fn filtered_in_circle(a: Xy, b: Xy, c: Xy, d: Xy) -> Option<Ordering> {
    let [[ax, ay], [bx, by], [cx, cy]] = [a, b, c].map(|p| [p[0] - d[0], p[1] - d[1]]);
    let lifts = [ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy];
    let products = [[bx * cy, by * cx], [cx * ay, cy * ax], [ax * by, ay * bx]];
    let (mut determinant, mut magnitude) = (0.0, 0.0);
    for (lift, [left, right]) in lifts.into_iter().zip(products) {
        determinant += lift * (left - right);
        magnitude += lift * (left.abs() + right.abs());
    }
    let in_range = lifts[0] + lifts[1] + lifts[2] < LIFT_OF_FILTER;
    decide(determinant, 16.0 * ROUNDING * magnitude + UNDERFLOW_OF_CIRCLE).filter(|_| in_range)
}

/// 2^400.
const LIFT_OF_FILTER: f64 = power_of_two(400);

/// 2^-600.
const UNDERFLOW_OF_CIRCLE: f64 = power_of_two(-600);

fn exact_orientation(a: Xy, b: Xy, c: Xy) -> Ordering {
    match small_differences([a, b, c]) {
        // Products of two differences of 61 bits have 122, their difference 123.
        Some([a, b, _]) => area([a, b].map(|point| point.map(i128::from))).cmp(&0),
        None => {
            let [a, b, c] = integers([a, b, c]);
            area(differences([a, b], &c)).cmp(&BigInt::ZERO)
        }
    }
}

fn area<T: Clone + Mul<Output = T> + Sub<Output = T>>([[ax, ay], [bx, by]]: [[T; 2]; 2]) -> T {
    ax * by - ay * bx
}

fn exact_in_circle(a: Xy, b: Xy, c: Xy, d: Xy) -> Ordering {
    let Some([a, b, c, _]) = small_differences([a, b, c, d]) else {
        let [a, b, c, d] = integers([a, b, c, d]);
        let terms = lifts_and_minors(differences([a, b, c], &d));
        return terms.into_iter().map(|(lift, minor)| lift * minor).sum::<BigInt>().cmp(&BigInt::ZERO);
    };
    let is_short = [a, b, c].as_flattened().iter().all(|&difference| difference.abs() <= 1 << 30);
    if is_short {
        // Lifts and minors have at most 61 bits, a product 122, the sum of three 124.
        let terms = lifts_and_minors([a, b, c].map(|point| point.map(i128::from)));
        terms.into_iter().map(|(lift, minor)| lift * minor).sum::<i128>().cmp(&0)
    } else {
        let terms = lifts_and_minors([a, b, c].map(|point| point.map(Wide::from)));
        let products = terms.map(|(lift, minor)| lift * minor);
        (products[0] + products[1] + products[2]).sign()
    }
}

/// The in-circle determinant is the sum of the products of these three pairs.
fn lifts_and_minors<T>([a, b, c]: [[T; 2]; 3]) -> [(T, T); 3]
where
    T: Clone + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let lift = |[x, y]: &[T; 2]| x.clone() * x.clone() + y.clone() * y.clone();
    let minor = |p: &[T; 2], q: &[T; 2]| area([p.clone(), q.clone()]);
    [(lift(&a), minor(&b, &c)), (lift(&b), minor(&c, &a)), (lift(&c), minor(&a, &b))]
}

#[cfg(test)]
mod tests {
    use super::super::random;
    use super::*;

    const SQUARE: [Xy; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn lengths_are_compared_exactly() {
        for scale in [1.0, 0.1, 1e300, 5e-324] {
            let ends = [[0.0, 0.0], [3.0 * scale, 4.0 * scale]];
            let whole = scale != 0.1;
            assert!(!whole || !is_longer(ends, 5.0 * scale), "{scale}");
            assert!(is_longer(ends, (5.0 * scale).next_down().next_down()), "{scale}");
            assert!(!is_longer(ends, (5.0 * scale).next_up().next_up()), "{scale}");
        }
    }

    #[test]
    fn distances_are_compared_exactly() {
        let corners = [[0.0, 0.0, 1.0], [3.0, 0.0, 2.0], [0.0, 3.0, 5.0]];
        for (height, sign) in [(3.0, Ordering::Equal), (3.0f64.next_up(), Ordering::Greater)] {
            for scale in [1.0, 1e-9, 1e60, 1e200] {
                let [at, up] = [[1.0, 1.0, height], [1.0, 1.0, 16.0 / 3.0 - height]];
                let [corners, [at, _, _]] =
                    [corners, [at, up, up]].map(|points| points.map(|p| p.map(|v| v * scale)));
                // The plane is at 8/3 there, which no f64 is.
                let third = distance_to(corners, at, scale / 3.0);
                assert!(third.exactly || third.sign == sign);
                let level = corners.map(|[x, y, _]| [x, y, 0.0]);
                assert_eq!(distance_to(level, at, 3.0 * scale).sign, sign, "{scale}");
                let below = [at[0], at[1], -at[2]];
                assert_eq!(distance_to(level, below, 3.0 * scale).sign, sign, "{scale}");
            }
        }
    }

    /// Every route of the arithmetic: 128 bits, 320 bits, and big integers.
    #[test]
    fn cocircular_points_are_found_at_every_size() {
        for scale in [1.0, 3.0, 1e5 / 3.0, 1e9 / 7.0, 2f64.powi(40) + 1.0, 1e300, 5e-324, 1e-200] {
            let [a, b, c, d] = SQUARE.map(|point| point.map(|value| value * scale));
            assert_eq!(in_circle(a, b, c, d), Decided { sign: Ordering::Equal, exactly: true }, "{scale}");
            let inside = [d[0].max(5e-324), d[1].next_down()];
            if scale > 1e-300 {
                assert_eq!(in_circle(a, b, c, inside).sign, Ordering::Greater, "{scale}");
            }
            assert_eq!(in_circle(a, b, c, [d[0], d[1].next_up()]).sign, Ordering::Less, "{scale}");
        }
    }

    #[test]
    fn far_offsets_do_not_hide_the_last_bit() {
        let [a, b, c, d] = SQUARE.map(|[x, y]| [x + 4_503_599_627_370_496.0, y - 1e15]);
        assert_eq!(in_circle(a, b, c, d).sign, Ordering::Equal);
        assert_eq!(in_circle(a, b, c, [d[0], d[1] + 1.0]).sign, Ordering::Less);
        assert_eq!(in_circle(a, b, c, [d[0] + 1.0, d[1] - 0.125]).sign, Ordering::Greater);
        assert_eq!(orientation([1e300, 1e-300], [0.0; 2], [-1e300, -1e-300]).sign, Ordering::Equal);
        assert_eq!(
            orientation([1e300, 1e-300], [0.0; 2], [-1e300, -(1e-300f64.next_up())]).sign,
            Ordering::Greater
        );
    }

    /// A filter with a wrong bound would disagree with the integers near zero.
    #[test]
    fn filter_and_integers_agree() {
        let mut random = random(88_172_645_463_325_252);
        let mut decided = 0;
        for round in 0..20_000 {
            let angle = [random(6.2), random(6.2), random(6.2), random(6.2)];
            let shift = [random(1e3), random(1e3)];
            let [a, b, c, d] = angle.map(|angle| [angle.cos() + shift[0], angle.sin() + shift[1]]);
            let range = if round % 2 == 0 { 1e-12 } else { 1e-15 };
            let d = [d[0] + random(range), d[1] + random(range)];
            if let Some(sign) = filtered_in_circle(a, b, c, d) {
                decided += 1;
                assert_eq!(sign, exact_in_circle(a, b, c, d), "{a:?} {b:?} {c:?} {d:?}");
            }
            if let Some(sign) = filtered_orientation(a, b, c) {
                assert_eq!(sign, exact_orientation(a, b, c), "{a:?} {b:?} {c:?}");
            }
        }
        assert!(decided > 0, "no case reached the filter");
    }

    /// The diagonal of a square avoids its largest point, whose lift is raised most.
    #[test]
    fn ties_are_broken_by_the_largest_point() {
        let [a, b, c, d] = SQUARE;
        assert_eq!(in_raised_circle(a, b, d, c), Ordering::Less, "(1, 1) lies outside");
        assert_eq!(in_raised_circle(b, c, d, a), Ordering::Less);
        assert_eq!(in_raised_circle(a, b, c, d), Ordering::Greater, "the other diagonal is refused");
        assert_eq!(in_raised_circle(a, c, d, b), Ordering::Greater);
    }
}
