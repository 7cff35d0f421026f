//! Functions that are sums of B-splines: box splines (theorem 8.2.4) and Bézier tents (theorem 8.3.1).

use spmesh_configurations::special::{self, Features, Function, FunctionKind, Special, ZpSplit};
use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_reference::sets::Random;
use spmesh_splines::bases::{Basis, Scratch};

struct Built {
    functions: Vec<Function>,
    collected: Basis,
    /// All B-splines as separate functions.
    single: Basis,
}

fn build(special: &Special, rule: &Rule) -> Built {
    let all = special.generate(rule, 1).expect("links");
    let links = configurations::links(&special.knots, &all[1]).expect("links");
    let functions = special.functions(&links).expect("pairs");
    let collected = Basis::of_functions(&special.knots, &all[1], &functions).expect("functions");
    assert_eq!(collected.len(), functions.len());
    let single = Basis::new(&special.knots, &all[1]).expect("functions");
    Built { functions, collected, single }
}

/// The values of all functions.
fn values(basis: &Basis, x: [f64; 2]) -> Vec<f64> {
    let mut values = vec![0.0; basis.len()];
    for &(function, value) in basis.at(x, &mut Scratch::default()) {
        values[function as usize] = value;
    }
    values
}

/// The Zwart-Powell box spline is the unit square convolved with the directions (1, 1) and (1, -1). With
/// coordinates s and t along these, its value at x is the area of the part of the unit square of (s, t) from
/// which x is reached.
fn zwart_powell([x, y]: [f64; 2]) -> f64 {
    let mut polygon = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    // Half-planes a s + b t <= c.
    for [a, b, c] in [[1.0, 1.0, x], [-1.0, -1.0, 1.0 - x], [1.0, -1.0, y], [-1.0, 1.0, 1.0 - y]] {
        let room = |[s, t]: [f64; 2]| c - a * s - b * t;
        let mut kept = Vec::new();
        for (&p, &q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            if room(p) >= 0.0 {
                kept.push(p);
            }
            if room(p) * room(q) < 0.0 {
                let share = room(p) / (room(p) - room(q));
                kept.push([0, 1].map(|axis| p[axis] + share * (q[axis] - p[axis])));
            }
        }
        polygon = kept;
    }
    let shoelace = polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(p, q)| p[0] * q[1] - p[1] * q[0]);
    0.5 * shoelace.sum::<f64>()
}

#[test]
fn the_box_spline_has_known_values() {
    assert_eq!(zwart_powell([1.5, 0.5]), 0.5);
    assert_eq!(zwart_powell([1.0, 0.0]), 0.25);
    assert_eq!(zwart_powell([3.0, 0.5]), 0.0);
    let translates =
        (-4..5).flat_map(|i| (-4..5).map(move |j| zwart_powell([0.3 + f64::from(i), 0.9 + f64::from(j)])));
    assert!((translates.sum::<f64>() - 1.0).abs() < 1e-14);
}

#[test]
fn half_the_splines_of_the_sides_of_a_face_are_a_box_spline() {
    let grid: Vec<[f64; 2]> = (0..64).map(|i| [f64::from(i % 8) - 3.0, f64::from(i / 8) + 2.0]).collect();
    for (is_falling, is_upright) in [(false, false), (false, true), (true, false), (true, true)] {
        let knots = Knots::new(grid.clone()).expect("finite points");
        let zp = special::zp(&knots, ZpSplit { is_falling, is_upright }).expect("a grid");
        let built = build(&zp, &Rule::Delaunay);
        let single: Vec<&[u32]> =
            (0..built.single.len()).map(|i| built.single.terms(i).next().expect("a set").0).collect();
        let mut random = Random::new(5);
        for (number, function) in built.functions.iter().enumerate() {
            let FunctionKind::Face(face) = function.kind else { continue };
            let [left, below] = zp.knots.at(face[0]);
            assert_eq!(built.collected.greville(number), [left + 0.5, below + 0.5]);
            for round in 0..40 {
                let mut coordinate = |low: f64, high: f64| match round % 4 {
                    0 => random.integer(2 * low as i64, 2 * high as i64) as f64 / 2.0,
                    _ => low + (high - low) * random.unit(),
                };
                let (u, v) = (coordinate(-1.0, 2.0), coordinate(-1.0, 2.0));
                let x = [left + u, below + v];
                let expected = zwart_powell([u + 1.0, v]);
                let found = values(&built.collected, x)[number];
                assert!((found - expected).abs() < 1e-14, "{:?} {u} {v}: {found} {expected}", function.kind);
                let all = values(&built.single, x);
                let sides = (0..4).map(|i| [face[i].min(face[(i + 1) % 4]), face[i].max(face[(i + 1) % 4])]);
                let sum: f64 =
                    sides.map(|side| all[single.iter().position(|set| *set == side).expect("a side")]).sum();
                assert!(
                    (sum / 2.0 - expected).abs() < 1e-14,
                    "{:?} {u} {v}: {sum} {expected}",
                    function.kind
                );
            }
        }
    }
}

/// The barycentric coordinate of corner `v` in the triangle that contains the point; zero if `v` is not a
/// corner of it.
fn share(triangles: &[[[f64; 2]; 3]], v: [f64; 2], x: [f64; 2]) -> f64 {
    let size =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let around = triangles
        .iter()
        .find(|&&[a, b, c]| [size(a, b, x), size(b, c, x), size(c, a, x)].iter().all(|&s| s >= 0.0));
    around.map_or(0.0, |&[a, b, c]| {
        let parts = [(a, size(b, c, x)), (b, size(c, a, x)), (c, size(a, b, x))];
        parts.iter().find(|(corner, _)| *corner == v).map_or(0.0, |(_, part)| part / size(a, b, c))
    })
}

#[test]
fn knots_pulled_apart_make_bezier_tents() {
    let mut random = Random::new(6);
    let corners = [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
    let mut coordinate = || random.integer(0, 64) as f64 / 64.0;
    let points: Vec<[f64; 2]> =
        corners.into_iter().chain((0..12).map(|_| [coordinate(), coordinate()])).collect();
    let knots = Knots::new(points.clone()).expect("finite points");
    let features = Features { corners: (0..16).collect(), ..Features::default() };
    let special = special::features(&knots, &features).expect("corners");
    let triangles: Vec<[[f64; 2]; 3]> =
        special.start.configurations().iter().map(|(t, _)| t.map(|id| special.knots.at(id))).collect();
    let area = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let triangles: Vec<[[f64; 2]; 3]> = triangles.into_iter().filter(|&t| area(t) != 0.0).collect();
    for rule in [Rule::Delaunay, Rule::Random(4)] {
        let built = build(&special, &rule);
        for round in 0..300 {
            let (p, q) = (random.integer(0, 15) as usize, random.integer(0, 15) as usize);
            let middle = [0, 1].map(|axis| (points[p][axis] + points[q][axis]) / 2.0);
            let x = match round % 3 {
                0 => points[p],
                1 => middle,
                _ => [random.unit() * 3.0 - 1.0, random.unit() * 3.0 - 1.0],
            };
            assert!(built.collected.is_in_domain(x));
            for (function, found) in built.functions.iter().zip(values(&built.collected, x)) {
                let of = |v: u32| share(&triangles, points[v as usize], x);
                let expected = match function.kind {
                    FunctionKind::Vertex(v) => of(v).powi(2),
                    FunctionKind::Tent([u, v]) => 2.0 * of(u) * of(v),
                    kind => panic!("{kind:?}"),
                };
                assert!((found - expected).abs() < 1e-14, "{:?} at {x:?}: {found} {expected}", function.kind);
            }
        }
    }
}

#[test]
fn functions_of_features_sum_to_one_and_reproduce_linear_functions() {
    let mut random = Random::new(12);
    let mut coordinate = || random.integer(0, 4096) as f64 / 4096.0;
    let corners = [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
    let points: Vec<[f64; 2]> =
        corners.into_iter().chain((0..30).map(|_| [coordinate(), coordinate()])).collect();
    let knots = Knots::new(points).and_then(|knots| knots.clamped(1)).expect("finite points");
    let line = |has_sharp_ends, ids: &[u32]| special::Crease { knots: ids.to_vec(), has_sharp_ends };
    let features =
        Features { corners: vec![7, 9], creases: vec![line(true, &[5, 6])], lines: vec![vec![11, 12]] };
    let special = special::features(&knots, &features).expect("features that do not cross");
    let built = build(&special, &Rule::Delaunay);
    for _ in 0..300 {
        let x = [random.unit() * 3.0 - 1.0, random.unit() * 3.0 - 1.0];
        assert!(built.collected.is_in_domain(x));
        let all = values(&built.collected, x);
        assert!((all.iter().sum::<f64>() - 1.0).abs() < 1e-13, "{x:?}");
        // The ends of linear elements share their tents, so functions along the elements do not reproduce
        // polynomials.
        let is_linear = |kind| matches!(kind, FunctionKind::Vertex(11 | 12));
        if built.functions.iter().zip(&all).any(|(function, &value)| is_linear(function.kind) && value != 0.0)
        {
            continue;
        }
        for axis in 0..2 {
            let sum: f64 = all
                .iter()
                .enumerate()
                .map(|(i, value)| if *value == 0.0 { 0.0 } else { value * built.collected.greville(i)[axis] })
                .sum();
            assert!((sum - x[axis]).abs() < 1e-13, "{x:?}: {sum}");
        }
    }
}
