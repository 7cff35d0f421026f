//! The circle test is conservative: checked against exact integers, at the tightest boxes there are.

use spmesh_delaunay::predicates::circle::CircleBounds;
use spmesh_stream::model::bounds::Region;

use spmesh_reference::sets::Random;

/// Whether the disk through the triangle lies left of `x = side`, exactly. Coordinates are relative to the
/// first corner.
fn is_left_of(b: [i128; 2], c: [i128; 2], side: i128) -> bool {
    let (p, q) = (b[0] * b[0] + b[1] * b[1], c[0] * c[0] + c[1] * c[1]);
    let d = b[0] * c[1] - b[1] * c[0];
    let (m_x, m_y) = ((c[1] * p - b[1] * q) * d.signum(), (b[0] * q - c[0] * p) * d.signum());
    let gap = 2 * d.abs() * side - m_x;
    gap > 0 && gap * gap > m_x * m_x + m_y * m_y
}

/// The triangle, turned so that each side of its box becomes the right side.
fn rotations(b: [i128; 2], c: [i128; 2]) -> [([i128; 2], [i128; 2]); 4] {
    let turn = |p: [i128; 2]| [p[1], -p[0]];
    let (b1, c1) = (turn(b), turn(c));
    let (b2, c2) = (turn(b1), turn(c1));
    [(b, c), (b1, c1), (b2, c2), (turn(b2), turn(c2))]
}

/// Tests boxes with one finite side near the border of the disk. Returns how many disks are claimed to be
/// inside, and how many are inside exactly. Panics on a wrong claim.
fn check(a: [i64; 2], b: [i64; 2], c: [i64; 2], bounds: CircleBounds) -> (u32, u32) {
    let relative = |p: [i64; 2]| [i128::from(p[0] - a[0]), i128::from(p[1] - a[1])];
    let float = |p: [i64; 2]| [p[0] as f64, p[1] as f64];
    let (mut claimed, mut inside) = (0, 0);
    for (turn, (rb, rc)) in rotations(relative(b), relative(c)).into_iter().enumerate() {
        let first =
            (0..).find(|&step| is_left_of(rb, rc, (1i128 << step) - 1)).map(|step| (1i128 << step) - 1);
        let (mut low, mut high) = (-1, first.expect("the disk is bounded"));
        while high - low > 1 {
            let middle = (low + high) / 2;
            if is_left_of(rb, rc, middle) { high = middle } else { low = middle }
        }
        for side in [high - 2, high - 1, high, high + 1, high + 2] {
            let mut region = Region::PLANE;
            let s = side as f64;
            match turn {
                0 => region.max[0] = a[0] as f64 + s,
                1 => region.max[1] = a[1] as f64 + s,
                2 => region.min[0] = a[0] as f64 - s,
                _ => region.min[1] = a[1] as f64 - s,
            }
            // Clockwise turns bring the top, left and bottom side to the right, in this order.
            let claim = bounds.disk_inside(float(a), float(b), float(c), region.sides());
            assert!(!claim || side >= high, "{a:?} {b:?} {c:?}: turn {turn}, side {side} of {high}");
            claimed += u32::from(claim);
            inside += u32::from(side >= high);
        }
    }
    (claimed, inside)
}

#[test]
fn no_disk_is_claimed_inside_that_is_not() {
    let mut random = Random::new(11);
    let (mut claimed, mut inside) = (0, 0);
    for round in 0..40_000 {
        let side = [3, 10, 1000, 1 << 18][round % 4];
        let offset = [0, 1_000_000_000][round / 4 % 2];
        let mut corner = || [offset + random.integer(-side, side), random.integer(-side, side) - offset];
        let (a, b, c) = (corner(), corner(), corner());
        if (b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0]) {
            continue;
        }
        for bounds in [CircleBounds::INTEGER, CircleBounds::FLOAT] {
            let (yes, exact) = check(a, b, c, bounds);
            claimed += yes;
            inside += exact;
        }
    }
    // Conservative, but useful: nearly every disk that is inside by a unit is recognised.
    assert!(f64::from(claimed) > 0.95 * f64::from(inside), "{claimed} of {inside}");
}

#[test]
fn extreme_triangles_are_never_claimed_by_mistake() {
    let finite = Region { min: [-1e300, -1e300], max: [1e300, 1e300] };
    let triangles = [
        [[0.0, 0.0], [1e-200, 0.0], [0.0, 1e-200]],
        [[0.0, 0.0], [1e200, 0.0], [0.0, 1e200]],
        [[1e308, 0.0], [-1e308, 0.0], [0.0, 1e308]],
        [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
        [[0.0, 0.0], [5e-324, 0.0], [0.0, 5e-324]],
    ];
    for [a, b, c] in triangles {
        assert!(!CircleBounds::FLOAT.disk_inside(a, b, c, finite.sides()), "{a:?} {b:?} {c:?}");
    }
}

/// The power of a place times the doubled area: below zero inside of the circle.
fn power(b: [i128; 2], c: [i128; 2], [x, y]: [i128; 2]) -> i128 {
    let (p, q) = (b[0] * b[0] + b[1] * b[1], c[0] * c[0] + c[1] * c[1]);
    let d = b[0] * c[1] - b[1] * c[0];
    d * (x * x + y * y) - x * (c[1] * p - b[1] * q) - y * (b[0] * q - c[0] * p)
}

#[test]
fn no_box_is_left_out_that_the_disk_meets() {
    let mut random = Random::new(12);
    let (mut claimed, mut outside) = (0, 0);
    for round in 0..40_000 {
        let (side, flatness) = ([10, 1000, 1 << 18][round % 3], [1, 10, 1 << 10][round / 3 % 3]);
        let mut corner = || [random.integer(-side, side), random.integer(-side, side) / flatness];
        let [a, mut b, mut c] = [corner(), corner(), corner()].map(|[x, y]| [i128::from(x), i128::from(y)]);
        // A place near the circle, as corners are on it.
        let at = [0, 1].map(|axis| c[axis] + i128::from(random.integer(-3, 3)));
        let relative = |p: [i128; 2]| [p[0] - a[0], p[1] - a[1]];
        if relative(b)[0] * relative(c)[1] < relative(b)[1] * relative(c)[0] {
            (b, c) = (c, b);
        }
        let (rb, rc, low) = (relative(b), relative(c), relative(at));
        let high = [0, 1].map(|axis| low[axis] + i128::from(random.integer(0, 4)));
        if rb[0] * rc[1] == rb[1] * rc[0] {
            continue;
        }
        let float = |p: [i128; 2]| p.map(|x| x as f64);
        let circle = CircleBounds::FLOAT.circle(float(a), float(b), float(c)).expect("no underflow");
        let claim = circle.misses([float(low), float(high)]);
        let places = (low[0]..=high[0]).flat_map(|x| (low[1]..=high[1]).map(move |y| [x, y]));
        let is_outside = places.into_iter().all(|place| power(rb, rc, place) > 0);
        assert!(!claim || is_outside, "{a:?} {b:?} {c:?}: box {low:?} to {high:?} relative to the first");
        claimed += u32::from(claim);
        outside += u32::from(is_outside);
    }
    assert!(f64::from(claimed) > 0.9 * f64::from(outside), "{claimed} of {outside}");
}
