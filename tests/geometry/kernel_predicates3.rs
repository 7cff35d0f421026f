//! Every arithmetic of the 3D predicates against arbitrary precision, inside its domain and at its limits.

use spmesh_delaunay::predicates::{Arithmetic3, Extent, PredicateCounts, Predicates3, Sign, WithPredicates3};
use spmesh_reference::exact3;
use spmesh_reference::sets::Random;

/// Compares all predicates on every five of the points, in the arithmetic chosen for them.
struct Compare<'a>(&'a [[f64; 3]]);

impl WithPredicates3 for Compare<'_> {
    type Output = ();

    fn with(self, predicates: &mut impl Predicates3) {
        let exact = exact3::exact_points(self.0);
        for (points, exact) in self.0.chunks_exact(5).zip(exact.chunks_exact(5)) {
            let [mut a, mut b, c, d, e] = [0, 1, 2, 3, 4];
            let orientation = exact3::orientation([&exact[a], &exact[b], &exact[c], &exact[d]]);
            assert_eq!(
                predicates.orient3d(points[a], points[b], points[c], points[d]) as i32,
                orientation,
                "orient3d{points:?}"
            );
            if orientation < 0 {
                std::mem::swap(&mut a, &mut b);
            }
            let five = [a, b, c, d, e].map(|i| &exact[i]);
            let [a, b, c, d, e] = [a, b, c, d, e].map(|i| points[i]);
            let insphere = predicates.insphere(a, b, c, d, e);
            assert_eq!(insphere as i32, exact3::insphere(five), "insphere{:?}", (a, b, c, d, e));
            let distinct = (0..5).all(|j| (0..j).all(|k| points[j] != points[k]));
            if orientation != 0 && distinct {
                let perturbed = predicates.insphere_perturbed(a, b, c, d, e);
                assert_eq!(
                    perturbed as i32,
                    exact3::insphere_perturbed(five),
                    "insphere_perturbed{:?}",
                    (a, b, c, d, e)
                );
                assert_ne!(perturbed, Sign::Zero);
            }
        }
    }
}

fn compare(points: &[[f64; 3]], expected: Arithmetic3) -> PredicateCounts {
    let arithmetic = Arithmetic3::of(&Extent::of(points));
    assert_eq!(arithmetic, expected);
    let mut counts = PredicateCounts::default();
    arithmetic.run(Compare(points), &mut counts);
    Arithmetic3::FiniteFloat.run(Compare(points), &mut counts);
    counts
}

/// Quintuples near the corners of a cube of side `d`, with the largest, the smallest and zero determinants.
fn extreme_fives(random: &mut Random, d: i64, offset: i64) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for _ in 0..400 {
        let spread = random.integer(0, 2);
        for _ in 0..5 {
            points.push([0, 1, 2].map(|_| {
                let near = random.integer(0, spread).min(d);
                (offset + if random.bits().is_multiple_of(2) { near } else { d - near }) as f64
            }));
        }
    }
    // The corners themselves, so that the extent is exactly `d`.
    points.extend(
        [[0, 0, 0], [d, d, 0], [d, 0, d], [0, d, d], [d, d, d]].map(|p| p.map(|c| (offset + c) as f64)),
    );
    points
}

#[test]
fn integers_at_the_edges_of_each_width() {
    let edges = [
        (822, Arithmetic3::SmallInteger),
        (823, Arithmetic3::Integer64),
        (3_288, Arithmetic3::Integer64),
        (3_289, Arithmetic3::Integer128),
        (23_400_000, Arithmetic3::Integer128),
        (23_400_001, Arithmetic3::BoundedFloat),
        ((1 << 32) - 1, Arithmetic3::BoundedFloat),
        ((1 << 53) - 1, Arithmetic3::BoundedFloat),
    ];
    let mut random = Random::new(1);
    for (difference, arithmetic) in edges {
        for offset in [0, -difference / 2, -difference] {
            let points = extreme_fives(&mut random, difference, offset);
            let counts = compare(&points, arithmetic);
            assert!(counts.perturbed > 0, "{counts:?}");
        }
    }
    let far = extreme_fives(&mut random, 1 << 20, (1 << 53) - (1 << 20));
    compare(&far, Arithmetic3::Integer128);
}

#[test]
fn random_integers_of_every_size() {
    let mut random = Random::new(2);
    for bits in 1..53 {
        let points: Vec<[f64; 3]> =
            (0..400).map(|_| [0, 1, 2].map(|_| random.integer(0, (1 << bits) - 1) as f64)).collect();
        let mut counts = PredicateCounts::default();
        Arithmetic3::of(&Extent::of(&points)).run(Compare(&points), &mut counts);
    }
}

#[test]
fn lattice_points_of_spheres_planes_and_lines() {
    let mut random = Random::new(3);
    for factor in [1, 100, 1_000_000, 1_000_000_000] {
        let mut counts = PredicateCounts::default();
        for squared in [3, 9, 29, 101, 269] {
            let sphere: Vec<[i64; 3]> = (0..33i64 * 33 * 33)
                .map(|i| [i % 33 - 16, i / 33 % 33 - 16, i / 33 / 33 - 16])
                .filter(|p| p.iter().map(|c| c * c).sum::<i64>() == squared)
                .collect();
            let points: Vec<[f64; 3]> = (0..1_000)
                .map(|_| sphere[random.bits() as usize % sphere.len()].map(|c| (c * factor) as f64))
                .collect();
            Arithmetic3::of(&Extent::of(&points)).run(Compare(&points), &mut counts);
            let flat: Vec<[f64; 3]> = points.iter().map(|p| [p[0], p[1], p[0] + 2.0 * p[1]]).collect();
            Arithmetic3::of(&Extent::of(&flat)).run(Compare(&flat), &mut counts);
        }
        assert!(counts.perturbed > 100, "{counts:?}");
    }
}

/// Nearly cospherical and nearly coplanar quintuples, which a filter cannot decide.
fn near_degenerate(random: &mut Random, scale: f64) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for five in 0..100 {
        let corner = [0, 1, 2].map(|_| random.unit() - 0.5);
        let offset = [0, 1, 2].map(|_| if five % 4 < 2 { 0.0 } else { random.unit() });
        let normal = [0, 1].map(|_| random.unit());
        let nudges = five % 3;
        for _ in 0..5 {
            let turn = random.bits() as usize % 3;
            let mut p = [0, 1, 2].map(|i| {
                let c = corner[(i + turn) % 3];
                offset[i] + if random.bits().is_multiple_of(2) { c } else { -c }
            });
            if five % 5 == 0 {
                p[2] = p[0] * normal[0] + p[1] * normal[1];
            }
            points.push(p.map(|c| {
                let nudge = random.integer(-nudges, nudges) as f64 * f64::EPSILON / 8.0;
                (c + nudge) * scale
            }));
        }
    }
    points
}

#[test]
fn floats_near_degeneracy_at_every_scale() {
    let mut random = Random::new(4);
    let mut counts = PredicateCounts::default();
    for exponent in (-1070..=1022).step_by(31) {
        let scale = if exponent < -1000 {
            2f64.powi(-1000) * 2f64.powi(exponent + 1000)
        } else {
            2f64.powi(exponent)
        };
        let points = near_degenerate(&mut random, scale);
        Arithmetic3::of(&Extent::of(&points)).run(Compare(&points), &mut counts);
        Arithmetic3::FiniteFloat.run(Compare(&points), &mut counts);
    }
    assert!(counts.filter > 0 && counts.pairs > 0 && counts.residues > 0, "{counts:?}");
}

#[test]
fn floats_at_the_edge_of_the_bounded_range() {
    let (least, greatest) = (2f64.powi(-132), 2f64.powi(200));
    let mut random = Random::new(5);
    for _ in 0..20 {
        let mut points: Vec<[f64; 3]> = (0..50)
            .map(|_| {
                [0, 1, 2].map(|_| match random.integer(0, 4) {
                    0 => greatest * (1.0 - random.unit() / 2.0),
                    1 => -greatest,
                    2 => least * (1.0 + random.unit()),
                    3 => 0.0,
                    _ => (random.unit() - 0.5) * 2f64.powi(random.integer(-130, 200) as i32),
                })
            })
            .collect();
        points.retain(|p| p.iter().all(|c| *c == 0.0 || c.abs() >= least));
        compare(&points, Arithmetic3::BoundedFloat);
        let small: Vec<[f64; 3]> = (0..100)
            .map(|_| [0, 1, 2].map(|_| least * (1.0 + random.integer(0, 3) as f64 * f64::EPSILON)))
            .collect();
        compare(&small, Arithmetic3::BoundedFloat);
        let large: Vec<[f64; 3]> = (0..100)
            .map(|_| {
                [0, 1, 2].map(|_| {
                    let magnitude = greatest * (1.0 - random.integer(0, 3) as f64 * f64::EPSILON);
                    if random.bits().is_multiple_of(2) { magnitude } else { -magnitude }
                })
            })
            .collect();
        compare(&large, Arithmetic3::BoundedFloat);
        points.push([least / 2.0, greatest, 0.0]);
        compare(&points, Arithmetic3::FiniteFloat);
    }
}

#[test]
fn floats_of_wildly_different_magnitude() {
    let mut random = Random::new(6);
    let mut points: Vec<[f64; 3]> = (0..1_000)
        .map(|_| [0, 1, 2].map(|_| (random.unit() - 0.5) * 10f64.powi(random.integer(-324, 308) as i32)))
        .collect();
    points.extend([
        [f64::MAX, f64::MIN, f64::MAX],
        [5e-324, -5e-324, 0.0],
        [f64::MIN, f64::MAX, f64::MAX],
        [0.0, f64::MAX, f64::MIN],
        [-0.0, 0.0, 5e-324],
    ]);
    let counts = compare(&points, Arithmetic3::FiniteFloat);
    assert!(counts.bigint > 0);
}

#[test]
fn signs_are_those_of_the_documentation() {
    let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for factor in [1.0, 1e3, 1e5, 1e9, 0.1, 1e250] {
        struct Signs([[f64; 3]; 5]);
        impl WithPredicates3 for Signs {
            type Output = [Sign; 3];
            fn with(self, predicates: &mut impl Predicates3) -> [Sign; 3] {
                let [o, x, y, z, corner] = self.0;
                [
                    predicates.orient3d(o, x, y, z),
                    predicates.insphere(o, x, y, z, corner.map(|c| c / 2.0)),
                    predicates.insphere_perturbed(o, x, y, z, corner),
                ]
            }
        }
        let points = [o, x, y, z, [1.0; 3]].map(|p| p.map(|c| c * factor));
        let signs = Arithmetic3::of(&Extent::of(&points)).run(Signs(points), &mut PredicateCounts::default());
        assert_eq!(signs, [Sign::Positive, Sign::Positive, Sign::Negative], "{factor}");
    }
}
