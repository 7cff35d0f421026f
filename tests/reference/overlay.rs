//! Volumes between triangle meshes by definition: all pairs of triangles, cut at lines one by one, with
//! fractions of big integers.

use num_bigint::BigInt;
use num_integer::Integer;

/// A triangle with integer corners.
pub type Triangle3 = [[i64; 3]; 3];

/// A rational number in lowest terms; its denominator is positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational(BigInt, BigInt);

impl Rational {
    fn new(numerator: BigInt, denominator: BigInt) -> Rational {
        let divisor = numerator.gcd(&denominator) * if denominator < BigInt::ZERO { -1 } else { 1 };
        Rational(numerator / &divisor, denominator / &divisor)
    }

    /// An integer.
    pub fn whole(value: i64) -> Rational {
        Rational(value.into(), 1.into())
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Rational) -> Rational {
        Rational::new(&self.0 * &other.1 + &other.0 * &self.1, &self.1 * &other.1)
    }

    /// The difference.
    #[must_use]
    pub fn minus(&self, other: &Rational) -> Rational {
        Rational::new(&self.0 * &other.1 - &other.0 * &self.1, &self.1 * &other.1)
    }

    fn times(&self, other: &Rational) -> Rational {
        Rational::new(&self.0 * &other.0, &self.1 * &other.1)
    }

    fn over(&self, other: &Rational) -> Rational {
        Rational::new(&self.0 * &other.1, &self.1 * &other.0)
    }

    fn is_negative(&self) -> bool {
        self.0 < BigInt::ZERO
    }

    fn is_zero(&self) -> bool {
        self.0 == BigInt::ZERO
    }

    /// How far it is from a number of units, of which `size` are one: in units, rounded down.
    pub fn distance(&self, units: &BigInt, size: &BigInt) -> BigInt {
        let difference = &self.0 * size - units * &self.1;
        BigInt::from(difference.magnitude().clone()) / &self.1
    }
}

/// Volumes and areas: where the second mesh is lower, higher, and the same.
#[derive(Clone, Debug)]
pub struct Overlay {
    /// Volume, area.
    pub cut: [Rational; 2],
    /// Volume, area.
    pub fill: [Rational; 2],
    /// Area.
    pub level: Rational,
}

/// Place, then the second surface minus the first.
type Corner = [Rational; 3];

/// The volumes between two meshes, and in a counterclockwise convex region if there is one.
pub fn overlay(first: &[Triangle3], second: &[Triangle3], region: Option<&[[i64; 2]]>) -> Overlay {
    let zero = || Rational::whole(0);
    let mut all = Overlay { cut: [zero(), zero()], fill: [zero(), zero()], level: zero() };
    for a in first {
        for b in second {
            add(&mut all, a, b, region);
        }
    }
    all
}

fn add(all: &mut Overlay, a: &Triangle3, b: &Triangle3, region: Option<&[[i64; 2]]>) {
    let rise = |x: &Rational, y: &Rational| height(b, x, y).minus(&height(a, x, y));
    let corner = |&[x, y, _]: &[i64; 3]| {
        let (x, y) = (Rational::whole(x), Rational::whole(y));
        let rise = rise(&x, &y);
        [x, y, rise]
    };
    let mut piece: Vec<Corner> = a.iter().map(corner).collect();
    let flat = b.map(|[x, y, _]| [x, y]);
    for ring in [Some(&flat[..]), region].into_iter().flatten() {
        for (from, to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            piece = kept(&piece, |[x, y, _]| left(from, to, x, y));
        }
    }
    let [volume, area] = integral(&piece);
    if area.is_zero() {
        return;
    }
    if piece.iter().all(|[_, _, rise]| rise.is_zero()) {
        all.level = all.level.plus(&area);
        return;
    }
    let higher = integral(&kept(&piece, |[_, _, rise]| rise.clone()));
    all.fill = [0, 1].map(|i| all.fill[i].plus(&higher[i]));
    let lower = [higher[0].minus(&volume), area.minus(&higher[1])];
    all.cut = [0, 1].map(|i| all.cut[i].plus(&lower[i]));
}

fn left([ax, ay]: &[i64; 2], [bx, by]: &[i64; 2], x: &Rational, y: &Rational) -> Rational {
    let across = Rational::whole(bx - ax).times(&y.minus(&Rational::whole(*ay)));
    across.minus(&Rational::whole(by - ay).times(&x.minus(&Rational::whole(*ax))))
}

/// The elevation of the plane of a triangle, by Cramer's rule.
fn height(triangle: &Triangle3, x: &Rational, y: &Rational) -> Rational {
    let [a, b, c] = triangle;
    let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
    let (x, y) = (x.minus(&Rational::whole(a[0])), y.minus(&Rational::whole(a[1])));
    let size = u[0] * v[1] - u[1] * v[0];
    let s = x.times(&Rational::whole(v[1])).minus(&y.times(&Rational::whole(v[0])));
    let t = y.times(&Rational::whole(u[0])).minus(&x.times(&Rational::whole(u[1])));
    let rise = s.times(&Rational::whole(u[2])).plus(&t.times(&Rational::whole(v[2])));
    Rational::whole(a[2]).plus(&rise.over(&Rational::whole(size)))
}

/// The part of a polygon where a linear function is not negative.
fn kept(piece: &[Corner], function: impl Fn(&Corner) -> Rational) -> Vec<Corner> {
    let mut part = Vec::new();
    for (p, q) in piece.iter().zip(piece.iter().cycle().skip(1)) {
        let (f, g) = (function(p), function(q));
        if !f.is_negative() {
            part.push(p.clone());
        }
        if f.times(&g).is_negative() {
            let share = f.over(&f.minus(&g));
            part.push([0, 1, 2].map(|axis| p[axis].plus(&q[axis].minus(&p[axis]).times(&share))));
        }
    }
    part
}

/// The integral of the rise, and the area.
fn integral(piece: &[Corner]) -> [Rational; 2] {
    let mut sums = [Rational::whole(0), Rational::whole(0)];
    for at in 2..piece.len() {
        let [o, p, q] = [&piece[0], &piece[at - 1], &piece[at]];
        let cross = p[0].minus(&o[0]).times(&q[1].minus(&o[1]));
        let area = cross.minus(&p[1].minus(&o[1]).times(&q[0].minus(&o[0]))).over(&Rational::whole(2));
        let mean = o[2].plus(&p[2]).plus(&q[2]).over(&Rational::whole(3));
        sums = [sums[0].plus(&area.times(&mean)), sums[1].plus(&area)];
    }
    sums
}
