//! The sphere test is conservative: checked against exact integers, at the tightest boxes there are.

use num_bigint::BigInt;
use num_traits::Signed;
use spmesh_delaunay::predicates::sphere::{SphereBounds, centre_is_inside};
use spmesh_stream::model::bounds::Region;

use spmesh_reference::sets::Random;

type Corner = [i64; 3];

/// A tetrahedron whose corners have weights.
#[derive(Debug, Clone, Copy)]
struct Weighted {
    corners: [Corner; 4],
    weights: [i64; 4],
    /// No weight of any point is greater.
    greatest: i64,
}

impl Weighted {
    fn equal(corners: [Corner; 4]) -> Self {
        Weighted { corners, weights: [0; 4], greatest: 0 }
    }

    fn is_inside(&self, bounds: SphereBounds, region: &Region<3>) -> bool {
        let corners = self.corners.map(|p| p.map(|c| c as f64));
        let weights = self.weights.map(|weight| weight as f64);
        let claim = bounds.power_ball_inside(corners, weights, self.greatest as f64, region.sides());
        if self.weights != [self.greatest; 4] {
            return claim;
        }
        let plain = bounds.ball_inside(corners, region.sides());
        assert!(plain || !claim, "weights that are equal make no claim easier");
        plain
    }
}

fn cross(p: &[BigInt; 3], q: &[BigInt; 3]) -> [BigInt; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &p[i] * &q[j] - &p[j] * &q[i])
}

fn dot(p: &[BigInt; 3], q: &[BigInt; 3]) -> BigInt {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

/// A ball: its centre relative to the first corner is `m / 2v`, with v > 0, and its squared radius is that of
/// m over 4 v² and an excess.
struct Ball {
    m: [BigInt; 3],
    volume: BigInt,
    excess: BigInt,
}

/// The ball to which points outside are not near enough for a conflict. `None` for a flat tetrahedron.
fn ball(Weighted { corners, weights, greatest }: Weighted) -> Option<Ball> {
    let [a, b, c, d] = corners;
    let [b, c, d] = [b, c, d].map(|p| [0, 1, 2].map(|axis| BigInt::from(p[axis]) - a[axis]));
    let [x, y, z] = [cross(&c, &d), cross(&d, &b), cross(&b, &c)];
    let volume = dot(&b, &x);
    let lift = |vector: &[BigInt; 3], i: usize| dot(vector, vector) - (weights[i] - weights[0]);
    let [p, q, r] = [lift(&b, 1), lift(&c, 2), lift(&d, 3)];
    let m = [0, 1, 2].map(|axis| (&p * &x[axis] + &q * &y[axis] + &r * &z[axis]) * volume.signum());
    let excess = BigInt::from(greatest - weights[0]);
    (volume != BigInt::ZERO).then(|| Ball { m, volume: volume.abs(), excess })
}

/// Whether the ball lies strictly inside a plane at distance `side` from the first corner, in the direction
/// `sign` of `axis`.
fn is_within(Ball { m, volume, excess }: &Ball, axis: usize, sign: i64, side: &BigInt) -> bool {
    let gap: BigInt = volume * side * 2 - &m[axis] * sign;
    gap.is_positive() && &gap * &gap > dot(m, m) + volume * volume * 4 * excess
}

/// The least integer distance of a plane that has the ball strictly inside.
fn tightest(ball: &Ball, axis: usize, sign: i64) -> BigInt {
    let (mut low, mut high) = (BigInt::from(-1), BigInt::from(1));
    // With weights, the first corner need not be in the ball.
    while is_within(ball, axis, sign, &low) {
        low *= 2;
    }
    while !is_within(ball, axis, sign, &high) {
        high *= 2;
    }
    while &high - &low > BigInt::from(1) {
        let middle: BigInt = (&low + &high) / 2;
        if is_within(ball, axis, sign, &middle) { high = middle } else { low = middle }
    }
    high
}

/// Tests boxes with one finite side near the border of the ball, at `tightest` and around it. Counts the
/// claims and the balls that are inside.
fn check(tetrahedron: Weighted, bounds: SphereBounds, counts: &mut (u32, u32)) {
    let Some(ball) = ball(tetrahedron) else { return };
    let corners = tetrahedron.corners;
    for axis in 0..3 {
        for sign in [1, -1] {
            let Ok(tightest) = i64::try_from(tightest(&ball, axis, sign)) else { continue };
            for side in tightest.saturating_sub(2)..tightest.saturating_add(3) {
                let plane = corners[0][axis] as i128 + i128::from(sign * side);
                if plane as f64 as i128 != plane {
                    continue;
                }
                let mut region = Region::<3>::EVERYTHING;
                let which = if sign > 0 { &mut region.max } else { &mut region.min };
                which[axis] = plane as f64;
                let claim = tetrahedron.is_inside(bounds, &region);
                assert!(!claim || side >= tightest, "{tetrahedron:?}: axis {axis}, {side} of {tightest}");
                counts.0 += u32::from(claim);
                counts.1 += u32::from(side >= tightest);
            }
        }
    }
}

#[test]
fn no_ball_is_claimed_inside_that_is_not() {
    let mut random = Random::new(12);
    let mut counts = (0, 0);
    for round in 0..4000 {
        let side = [3, 10, 1000, 1 << 18][round % 4];
        let offset = [0, 1_000_000_000][round / 4 % 2];
        let mut corner = || {
            [
                offset + random.integer(-side, side),
                random.integer(-side, side) - offset,
                random.integer(-side, side),
            ]
        };
        let corners = [corner(), corner(), corner(), corner()];
        for bounds in [SphereBounds::INTEGER, SphereBounds::FLOAT] {
            check(Weighted::equal(corners), bounds, &mut counts);
        }
    }
    // Conservative, but useful: nearly every ball that is inside by a unit is recognised.
    let (claimed, inside) = counts;
    assert!(f64::from(claimed) > 0.95 * f64::from(inside), "{claimed} of {inside}");
}

/// Balls may be far from their tetrahedra, and have no point at all if there were no greater weight.
#[test]
fn no_ball_of_weighted_points_is_claimed_inside_that_is_not() {
    let mut random = Random::new(14);
    let mut counts = (0, 0);
    for round in 0..6000 {
        let side = [3, 10, 1000, 1 << 18][round % 4];
        let offset = [0, 1_000_000_000][round / 4 % 2];
        let weight = [1, side, side * side, 30 * side * side][round / 8 % 4];
        let mut corner = || [offset, 0, -offset].map(|at| at + random.integer(-side, side));
        let corners = [corner(), corner(), corner(), corner()];
        let weights = [(); 4].map(|()| random.integer(-weight, weight));
        let most = weights.into_iter().max().expect("four weights");
        let greatest = most + [0, 1, weight][round % 3];
        for bounds in [SphereBounds::INTEGER, SphereBounds::FLOAT] {
            check(Weighted { corners, weights, greatest }, bounds, &mut counts);
        }
    }
    let (claimed, inside) = counts;
    assert!(f64::from(claimed) > 0.9 * f64::from(inside), "{claimed} of {inside}");
}

/// Nearly coplanar corners, whose spheres are much larger than their distances.
#[test]
fn slivers_are_not_claimed_by_mistake() {
    let mut random = Random::new(13);
    let mut counts = (0, 0);
    for _ in 0..4000 {
        let mut corner =
            |side: i64| [random.integer(-side, side), random.integer(-side, side), random.integer(0, 1)];
        let corners = [corner(1 << 12), corner(1 << 12), corner(1 << 12), corner(1 << 12)];
        for bounds in [SphereBounds::INTEGER, SphereBounds::FLOAT] {
            check(Weighted::equal(corners), bounds, &mut counts);
        }
    }
    assert!(counts.0 > counts.1 / 2, "{counts:?}");
}

#[test]
fn extreme_tetrahedra_are_never_claimed() {
    let finite = Region { min: [-1e300; 3], max: [1e300; 3] };
    let corner = |size: f64| [[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size]];
    for size in [0.0, 5e-324, 1e-200, 1e-60, 1e60, 1e120, 1e308] {
        assert!(!SphereBounds::FLOAT.ball_inside(corner(size), finite.sides()), "{size}");
    }
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    assert!(!SphereBounds::FLOAT.ball_inside(flat, finite.sides()));
    assert!(!SphereBounds::FLOAT.ball_inside([[f64::NAN; 3]; 4], Region::EVERYTHING.sides()));
    assert!(SphereBounds::FLOAT.ball_inside(corner(1.0), finite.sides()));
    let tiny = [[0.0; 3], [1.0, 1e-310, 0.0], [0.0, 1.0, 1e-310], [1e-310, 0.0, 1.0]];
    assert!(SphereBounds::FLOAT.ball_inside(tiny, finite.sides()));
    for greatest in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(!SphereBounds::FLOAT.power_ball_inside(
            corner(1.0),
            [0.0; 4],
            greatest,
            Region::EVERYTHING.sides()
        ));
    }
    assert!(!SphereBounds::FLOAT.power_ball_inside(
        corner(1.0),
        [0.0, 1e300, 0.0, 0.0],
        1e300,
        finite.sides()
    ));
    assert!(SphereBounds::FLOAT.power_ball_inside(corner(1.0), [1.0, 2.0, 3.0, -7.0], 3.0, finite.sides()));
}

/// Whether the coordinate of the centre is at least `side`, a multiple of 2^-20, by definition.
fn is_from(side: f64, axis: usize, corners: [Corner; 4], ball: &Ball) -> bool {
    let steps = BigInt::from((side * f64::from(1 << 20)) as i128);
    &ball.m[axis] * (1 << 20) >= &ball.volume * 2 * (steps - BigInt::from(corners[0][axis]) * (1 << 20))
}

#[test]
fn centres_are_placed_exactly() {
    let mut random = Random::new(77);
    let mut ties = 0;
    for round in 0..6_000 {
        let reach = [3, 12, 4_000, 1 << 30][round % 4];
        let mut coordinate = || (random.bits() % (2 * reach + 1)) as i64 - reach as i64;
        let mut corners = [0; 4].map(|_| [0; 3].map(|_| coordinate()));
        let Some(ball) = ball(Weighted::equal(corners)) else { continue };
        let floats = |corners: [Corner; 4]| corners.map(|p| p.map(|c| c as f64));
        if orient3d(corners) < 0 {
            corners.swap(2, 3);
        }
        for bounds in [SphereBounds::FLOAT, SphereBounds::INTEGER] {
            let about = bounds.centre(floats(corners));
            for axis in 0..3 {
                let middle = about.map_or(0.0, |centre| (centre.at[axis] * 4.0).round() / 4.0);
                for side in [-1.0, -0.25, 0.0, 0.25, 1.0].map(|off| middle + off) {
                    let mut region = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
                    region[0][axis] = side;
                    let is_above = centre_is_inside(bounds, floats(corners), region);
                    region[1][axis] = side;
                    region[0][axis] = f64::NEG_INFINITY;
                    let is_below = centre_is_inside(bounds, floats(corners), region);
                    assert_eq!(is_above, is_from(side, axis, corners, &ball), "{corners:?} {axis} {side}");
                    assert_ne!(is_above, is_below, "a side belongs to the box above it");
                    ties += usize::from(is_above && !is_from(side + 0.5f64.powi(20), axis, corners, &ball));
                }
                if let Some(centre) = about.filter(|_| reach <= 4_000) {
                    let steps = |place: f64| (place * f64::from(1 << 20)) / f64::from(1 << 20);
                    let off = centre.error[axis] + 0.5f64.powi(18);
                    assert!(
                        is_from(steps(centre.at[axis] - off), axis, corners, &ball),
                        "{corners:?} {axis}"
                    );
                    assert!(
                        !is_from(steps(centre.at[axis] + off), axis, corners, &ball),
                        "{corners:?} {axis}"
                    );
                }
            }
        }
    }
    assert!(ties > 1_000, "{ties} centres on sides");
}

fn orient3d(corners: [Corner; 4]) -> i128 {
    let [a, b, c, d] = corners;
    let [b, c, d] = [b, c, d].map(|p| [0, 1, 2].map(|axis| i128::from(p[axis] - a[axis])));
    let minor = |i: usize, j: usize| c[i] * d[j] - c[j] * d[i];
    (b[0] * minor(1, 2) + b[1] * minor(2, 0) + b[2] * minor(0, 1)).signum()
}
