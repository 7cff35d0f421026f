//! Every arithmetic of the predicates against arbitrary precision, inside its domain and at its limits.

use spmesh_delaunay::predicates::{Arithmetic, Extent, PredicateCounts, Predicates2, Sign, WithPredicates2};
use spmesh_reference::exact;
use spmesh_reference::sets::Random;

/// Compares all predicates on the points, in the arithmetic chosen for them.
struct Compare<'a>(&'a [[f64; 2]]);

impl WithPredicates2 for Compare<'_> {
    type Output = ();

    fn with(self, predicates: &mut impl Predicates2) {
        let points = self.0;
        let exact = exact::exact_points(points);
        for i in 0..points.len() - 3 {
            let [mut a, mut b, c, d] = [i, i + 1, i + 2, i + 3];
            let orientation = exact::orientation(&exact[a], &exact[b], &exact[c]);
            assert_eq!(
                predicates.orient2d(points[a], points[b], points[c]) as i32,
                orientation,
                "orient2d{:?}",
                (points[a], points[b], points[c])
            );
            if orientation < 0 {
                std::mem::swap(&mut a, &mut b);
            }
            let call = (points[a], points[b], points[c], points[d]);
            let four = [&exact[a], &exact[b], &exact[c], &exact[d]];
            let incircle = predicates.incircle(call.0, call.1, call.2, call.3);
            assert_eq!(incircle as i32, exact::incircle(four), "incircle{call:?}");
            let distinct = (0..4).all(|j| (0..j).all(|k| points[i + j] != points[i + k]));
            if orientation != 0 && distinct {
                let perturbed = predicates.incircle_perturbed(call.0, call.1, call.2, call.3);
                assert_eq!(perturbed as i32, exact::incircle_perturbed(four), "incircle_perturbed{call:?}");
                assert_ne!(perturbed, Sign::Zero);
            }
        }
    }
}

fn compare(points: &[[f64; 2]], expected: Arithmetic) -> PredicateCounts {
    let arithmetic = Arithmetic::of(&Extent::of(points));
    assert_eq!(arithmetic, expected);
    let mut counts = PredicateCounts::default();
    arithmetic.run(Compare(points), &mut counts);
    Arithmetic::FiniteFloat.run(Compare(points), &mut counts);
    counts
}

/// Quadruples near the corners of a square of side `d`, with the largest, the smallest and zero determinants.
fn extreme_quadruples(random: &mut Random, d: i64, offset: i64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for _ in 0..500 {
        for _ in 0..4 {
            let coordinate = |random: &mut Random| {
                let near = random.integer(0, 2).min(d);
                offset + if random.bits().is_multiple_of(2) { near } else { d - near }
            };
            let x = coordinate(random);
            let y = coordinate(random);
            points.push([x as f64, y as f64]);
        }
    }
    // The corners themselves, so that the extent is exactly `d`.
    points.extend([[0, 0], [d, 0], [d, d], [0, d]].map(|p| p.map(|c| (offset + c) as f64)));
    points
}

#[test]
fn integers_at_the_edges_of_each_width() {
    let edges = [
        (5_234, Arithmetic::SmallInteger),
        (5_235, Arithmetic::Integer64),
        (29_609, Arithmetic::Integer64),
        (29_610, Arithmetic::Integer128),
        (1_900_000_000, Arithmetic::Integer128),
        (1_900_000_001, Arithmetic::IntegerPair),
        ((1 << 32) - 1, Arithmetic::IntegerPair),
        (1 << 32, Arithmetic::IntegerPair),
        (1 << 41, Arithmetic::IntegerPair),
        ((1 << 41) + 1, Arithmetic::BoundedFloat),
        ((1 << 53) - 1, Arithmetic::BoundedFloat),
    ];
    let mut random = Random::new(1);
    for (difference, arithmetic) in edges {
        for offset in [0, -difference / 2, -difference] {
            let points = extreme_quadruples(&mut random, difference, offset);
            let counts = compare(&points, arithmetic);
            assert!(counts.perturbed > 0, "{counts:?}");
        }
    }
    let far = extreme_quadruples(&mut random, 1 << 20, (1 << 53) - (1 << 20));
    compare(&far, Arithmetic::Integer128);
}

#[test]
fn random_integers_of_every_size() {
    let mut random = Random::new(2);
    for bits in 1..53 {
        let points: Vec<[f64; 2]> =
            (0..400).map(|_| [0, 1].map(|_| random.integer(0, (1 << bits) - 1) as f64)).collect();
        let mut counts = PredicateCounts::default();
        Arithmetic::of(&Extent::of(&points)).run(Compare(&points), &mut counts);
    }
}

/// Nearly cocircular and nearly collinear quadruples, which a filter cannot decide.
fn near_degenerate(random: &mut Random, scale: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for quadruple in 0..150 {
        let (x, y) = (random.unit(), random.unit());
        for corner in [[x, y], [-y, x], [-x, -y], [y, -x]] {
            let nudge = [0, 1].map(|_| random.integer(-1, 1) as f64 * f64::EPSILON / 8.0);
            let p = if quadruple % 3 == 0 { corner.map(|c| c / 3.0) } else { corner };
            points.push([(p[0] + nudge[0]) * scale, (p[1] + nudge[1]) * scale]);
        }
    }
    points
}

#[test]
fn floats_near_degeneracy_at_every_scale() {
    let mut random = Random::new(3);
    for exponent in (-1070..=1022).step_by(31) {
        let scale = if exponent < -1000 {
            2f64.powi(-1000) * 2f64.powi(exponent + 1000)
        } else {
            2f64.powi(exponent)
        };
        let points = near_degenerate(&mut random, scale);
        let mut counts = PredicateCounts::default();
        Arithmetic::of(&Extent::of(&points)).run(Compare(&points), &mut counts);
        Arithmetic::FiniteFloat.run(Compare(&points), &mut counts);
        assert!(counts.total() > 0);
    }
}

#[test]
fn floats_at_the_edge_of_the_bounded_range() {
    let (least, greatest) = (2f64.powi(-170), 2f64.powi(240));
    let mut random = Random::new(4);
    for _ in 0..20 {
        let mut points: Vec<[f64; 2]> = (0..40)
            .map(|_| {
                [0, 1].map(|_| match random.integer(0, 4) {
                    0 => greatest * (1.0 - random.unit() / 2.0),
                    1 => -greatest,
                    2 => least * (1.0 + random.unit()),
                    3 => 0.0,
                    _ => (random.unit() - 0.5) * 2f64.powi(random.integer(-160, 240) as i32),
                })
            })
            .collect();
        points.retain(|p| p.iter().all(|c| *c == 0.0 || c.abs() >= least));
        compare(&points, Arithmetic::BoundedFloat);
        let small: Vec<[f64; 2]> = (0..40)
            .map(|_| [0, 1].map(|_| least * (1.0 + random.integer(0, 3) as f64 * f64::EPSILON)))
            .chain([[0.0, 0.0], [least, least]])
            .collect();
        compare(&small, Arithmetic::BoundedFloat);
        points.push([least / 2.0, greatest]);
        compare(&points, Arithmetic::FiniteFloat);
    }
}

#[test]
fn floats_of_wildly_different_magnitude() {
    let mut random = Random::new(5);
    let mut points: Vec<[f64; 2]> = (0..600)
        .map(|_| [0, 1].map(|_| (random.unit() - 0.5) * 10f64.powi(random.integer(-324, 308) as i32)))
        .collect();
    points.extend([
        [f64::MAX, f64::MIN],
        [5e-324, -5e-324],
        [f64::MIN, f64::MAX],
        [0.0, f64::MAX],
        [-0.0, 0.0],
    ]);
    let counts = compare(&points, Arithmetic::FiniteFloat);
    assert!(counts.bigint > 0);
}

#[test]
fn perturbation_takes_the_lexicographically_largest_point() {
    // The unit square: raising [1, 1] keeps it off every circle, so that the diagonal avoids it.
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mesh = spmesh_delaunay::delaunay2::triangulate(&square).expect("finite points");
    assert_eq!(mesh.triangles().len(), 2);
    assert!(
        mesh.arrays().left_of(1, 3).is_some() && mesh.arrays().left_of(3, 1).is_some(),
        "{:?}",
        mesh.triangles()
    );
}
