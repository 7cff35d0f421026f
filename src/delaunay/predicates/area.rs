//! Areas of triangles, accurate however flat they are.

use super::Point2;

/// From this part of the sum of its two products on, a determinant in plain arithmetic is good to about
/// 2^-47: each product and its factors are off by three roundings of 2^-53.
const TRUSTED: f64 = 1.0 / 16.0;

/// Signed area of the triangle abc: positive if it is counterclockwise.
///
/// Relative error below 1e-14, and zero if and only if the points are collinear, for coordinates that are
/// zero or have magnitudes in the range of [`super::BoundedFloatPredicates`].
#[inline]
pub fn area(a: Point2, b: Point2, c: Point2) -> f64 {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let determinant = left - right;
    if determinant.abs() >= TRUSTED * (left.abs() + right.abs()) {
        return 0.5 * determinant;
    }
    exact_area(a, b, c)
}

/// [`area()`] to two units in the last place, and slower.
#[cold]
pub fn exact_area(a: Point2, b: Point2, c: Point2) -> f64 {
    0.5 * exact_determinant(a, b, c)
}

/// The determinant as a sum of products of exact differences, rounded at the end only.
fn exact_determinant(a: Point2, b: Point2, c: Point2) -> f64 {
    let [ax, ay, bx, by] =
        [difference(a[0], c[0]), difference(a[1], c[1]), difference(b[0], c[0]), difference(b[1], c[1])];
    let mut sum = Expansion::default();
    sum.add_product(ax, by);
    sum.add_product(ay.map(|part| -part), bx);
    sum.rounded()
}

/// `p - q` as two numbers without an error (Knuth's two-sum).
fn difference(p: f64, q: f64) -> [f64; 2] {
    two_sum(p, -q)
}

/// The rounded sum, and its error (Knuth).
pub(super) fn two_sum(p: f64, q: f64) -> [f64; 2] {
    let sum = p + q;
    let of_q = sum - p;
    [sum, (p - (sum - of_q)) + (q - of_q)]
}

/// A sum of at most sixteen numbers, held exactly as parts that do not overlap, the least first (Shewchuk
/// 1997, theorem 10).
#[derive(Default)]
struct Expansion {
    parts: [f64; 16],
    count: usize,
}

impl Expansion {
    fn add(&mut self, number: f64) {
        let mut carried = number;
        let mut kept = 0;
        for place in 0..self.count {
            let [sum, error] = two_sum(carried, self.parts[place]);
            carried = sum;
            if error != 0.0 {
                self.parts[kept] = error;
                kept += 1;
            }
        }
        self.parts[kept] = carried;
        self.count = kept + 1;
    }

    fn add_product(&mut self, p: [f64; 2], q: [f64; 2]) {
        for (x, y) in [(p[1], q[1]), (p[1], q[0]), (p[0], q[1]), (p[0], q[0])] {
            let product = x * y;
            self.add(x.mul_add(y, -product));
            self.add(product);
        }
    }

    /// The parts do not overlap, so that adding them from the least on gives the sum but for one rounding or
    /// two.
    fn rounded(&self) -> f64 {
        self.parts[..self.count].iter().sum()
    }
}
