//! The domain against its definition: every closed half-plane with the point on its border has at least k
//! knots.

use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_reference::sets::{Random, as_floats};
use spmesh_splines::bases::{Basis, Scratch};

fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The least number of knots in a closed half-plane with `x` on its border.
fn depth(x: [i64; 2], knots: &[[i64; 2]]) -> usize {
    let here = knots.iter().filter(|&&knot| knot == x).count();
    let around = knots.iter().filter(|&&knot| knot != x);
    let least = around.clone().map(|&knot| {
        // Turn the line through the knot by an infinitesimal: knots ahead on the line go to one side, knots
        // behind to the other.
        let count = |test: &dyn Fn(i64, i64) -> bool| {
            around.clone().filter(|&&p| test(cross(x, knot, p), dot(x, knot, p))).count()
        };
        let (left, right) = (count(&|side, _| side > 0), count(&|side, _| side < 0));
        let (ahead, behind) =
            (count(&|side, along| side == 0 && along > 0), count(&|side, along| side == 0 && along < 0));
        left.min(right) + ahead.min(behind)
    });
    least.min().map_or(here, |least| least + here)
}

fn dot(x: [i64; 2], p: [i64; 2], q: [i64; 2]) -> i64 {
    (p[0] - x[0]) * (q[0] - x[0]) + (p[1] - x[1]) * (q[1] - x[1])
}

fn check(points: &[[i64; 2]], degree: usize, side: i64) -> usize {
    let knots = Knots::new(as_floats(points)).expect("finite points");
    let Ok(start) = configurations::delaunay(&knots) else { return 0 };
    let Ok(mut all) = configurations::generate(&knots, start, &Rule::Delaunay, degree - 1) else { return 0 };
    let Ok(basis) = Basis::new(&knots, &all.pop().expect("a degree")) else { return 0 };
    let mut scratch = Scratch::default();
    let mut inside = 0;
    for x in (-1..=side + 1).flat_map(|i| (-1..=side + 1).map(move |j| [i, j])) {
        let at = x.map(|c| c as f64);
        let expected = depth(x, points) >= degree;
        assert_eq!(
            basis.is_in_domain(at),
            expected,
            "degree {degree} at {x:?}: let points = vec!{points:?};"
        );
        let sum: f64 = basis.at(at, &mut scratch).iter().map(|(_, value)| value).sum();
        if expected {
            inside += 1;
        } else {
            assert!(sum < 1.0 + 1e-12, "{sum} outside of the domain, {at:?}: let points = vec!{points:?};");
        }
    }
    inside
}

#[test]
fn a_corner_has_the_depth_of_its_copies() {
    let points = [[0, 0], [4, 0], [0, 4], [0, 0], [1, 1]];
    assert_eq!([[0, 0], [4, 0], [2, 0], [1, 1], [5, 0]].map(|x| depth(x, &points)), [2, 1, 1, 2, 0]);
}

#[test]
fn the_domain_is_where_half_planes_have_enough_knots() {
    let mut random = Random::new(17);
    let mut inside = 0;
    for round in 0..240 {
        let (side, count) = ([4, 8, 30][round % 3], [4, 6, 9, 14, 25][round / 3 % 5]);
        let mut points: Vec<[i64; 2]> =
            (0..count).map(|_| [random.integer(0, side), random.integer(0, side)]).collect();
        match round / 15 % 4 {
            // Random copies.
            0 => (0..3).for_each(|_| points.push(points[random.integer(0, count - 1) as usize])),
            // Most points on two lines.
            1 => (0..count as usize).for_each(|at| points[at][at % 2] = side / 2),
            _ => (),
        }
        inside += (1..=3).map(|degree| check(&points, degree, side)).sum::<usize>();
    }
    assert!(inside > 5000, "{inside}");
}

#[test]
fn points_outside_of_everything_have_no_functions() {
    let points = [[0, 0], [4, 0], [0, 4], [5, 5], [2, 1]];
    let knots = Knots::new(as_floats(&points)).expect("finite points");
    let basis = Basis::new(&knots, &configurations::delaunay(&knots).expect("triangles")).expect("functions");
    let mut scratch = Scratch::default();
    for x in [[-1.0, 0.0], [1e300, 2.0], [f64::NAN, 1.0], [1.0, f64::INFINITY]] {
        assert!(
            !basis.is_in_domain(x)
                && basis.at(x, &mut scratch).is_empty()
                && basis.jets_at(x, &mut scratch).is_empty()
        );
    }
}
