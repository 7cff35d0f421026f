//! Interpolation against definitions in exact arithmetic.

use spmesh_delaunay::Location;
use spmesh_delaunay::delaunay2::interpolation::{Linear, NaturalNeighbours};
use spmesh_delaunay::delaunay2::{Triangulation, triangulate};
use spmesh_delaunay::delaunay3;
use spmesh_reference::natural::sibson;
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, as_floats, degenerate, uniform};

type Point = [f64; 2];

const NATURAL_ERROR: f64 = 1e-12;
const LINEAR_ERROR: f64 = 3e-14;

/// Few points of every kind: random, degenerate, of different scales, huge and tiny.
fn points(random: &mut Random, round: usize) -> Vec<Point> {
    let count = 3 + round % 8;
    let mut points = match round % 16 {
        family if family < DEGENERATE_FAMILIES => as_floats(&degenerate(random, family, count.max(9))[..]),
        10 => as_floats(&uniform(random, count, 6)),
        11 => as_floats(&uniform(random, count, 1 << 30)),
        // A cluster far smaller than its distance from the others.
        12 => (0..count).map(|i| [0, 1].map(|_| random.unit() * [1.0, 1e-9][i % 2])).collect(),
        // Flat triangles at the hull: points that are nearly on a line.
        13 => (0..count).map(|i| [i as f64 + random.unit(), 1e-7 * random.unit()]).collect(),
        // Points on a circle, rounded.
        14 => (0..count).map(|_| random.unit() * 6.3).map(|t| [t.cos(), t.sin()]).collect(),
        _ => (0..count).map(|_| [random.unit(), random.unit()]).collect(),
    };
    random.shuffle(&mut points);
    points.truncate(9);
    let scale = [1.0, 1.0, 1.0, 2f64.powi(900), 2f64.powi(-950)][round % 5];
    points.iter().map(|p| p.map(|c| c * scale)).collect()
}

/// Targets of every kind: at random, on edges, at vertices, and just beside the hull.
fn targets(random: &mut Random, points: &[Point]) -> Vec<Point> {
    let mut pick = || points[(random.bits() % points.len() as u64) as usize];
    let [a, b, c] = [pick(), pick(), pick()];
    let middle = [0, 1].map(|i| a[i].midpoint(b[i]));
    let centroid = [0, 1].map(|i| a[i] / 3.0 + b[i] / 3.0 + c[i] / 3.0);
    let beside = [0, 1].map(|i| middle[i] + (c[i] - middle[i]) * 1e-10);
    let near_vertex = [0, 1].map(|i| a[i] + (centroid[i] - a[i]) * 1e-6);
    vec![a, middle, centroid, beside, near_vertex]
}

/// The edge of the hull that the target is on.
fn hull_edge(mesh: &Triangulation, target: Point) -> Option<[u32; 2]> {
    let Location::Edge([a, b]) = mesh.locate(target) else { return None };
    mesh.hull().find(|&edge| edge == [a, b] || edge == [b, a])
}

fn check_natural(mesh: &Triangulation, target: Point, weights: Option<&[(u32, f64)]>) {
    let points = mesh.points();
    let location = mesh.locate(target);
    let Some(weights) = weights else {
        assert_eq!(location, Location::Outside, "{points:?} {target:?}");
        return;
    };
    if let Location::Vertex(vertex) = location {
        assert_eq!(weights, [(vertex, 1.0)]);
        return;
    }
    let mut found = vec![0.0; points.len()];
    weights.iter().for_each(|&(v, weight)| found[v as usize] += weight);
    assert!(weights.iter().all(|&(_, weight)| weight >= 0.0));
    let sum: f64 = found.iter().sum();
    assert!((sum - 1.0).abs() < 1e-15 * (weights.len() + 2) as f64, "{sum}");
    if let Some([a, b]) = hull_edge(mesh, target) {
        let [a, b] = [points[a as usize], points[b as usize]];
        let axis = usize::from((a[1] - b[1]).abs() > (a[0] - b[0]).abs());
        let expected = (target[axis] - a[axis]) / (b[axis] - a[axis]);
        let vertex = points.iter().position(|&point| point == b).expect("a vertex");
        assert!((found[vertex] - expected).abs() < NATURAL_ERROR && weights.len() == 2);
        return;
    }
    for (v, expected) in sibson(points, target).iter().enumerate() {
        let error = (found[v] - expected.to_float()).abs();
        assert!(error < NATURAL_ERROR, "{points:?} {target:?}: {v}, {error}");
    }
}

#[test]
fn natural_neighbours_have_the_weights_of_their_definition() {
    let mut random = Random::new(31);
    for round in 0..500 {
        let points = points(&mut random, round);
        let mesh = triangulate(&points).expect("finite points");
        let mut natural = NaturalNeighbours::new(&mesh);
        // Definitions are slow: two of the targets of each set.
        for target in targets(&mut random, &points).into_iter().cycle().skip(round / 16).step_by(2).take(2) {
            check_natural(&mesh, target, natural.weights(target));
        }
    }
}

#[test]
fn weights_do_not_depend_on_the_targets_before() {
    let mut random = Random::new(32);
    for family in [0, 2, 3, 8, 9] {
        let points = as_floats(&degenerate(&mut random, family, 300));
        let mesh = triangulate(&points).expect("finite points");
        let (mut natural, mut linear) = (NaturalNeighbours::new(&mesh), Linear::new(&mesh));
        let targets: Vec<Point> = (0..40).flat_map(|_| targets(&mut random, &points)).collect();
        for &target in &targets {
            let afresh = NaturalNeighbours::new(&mesh).weights(target).map(<[_]>::to_vec);
            assert_eq!(natural.weights(target), afresh.as_deref(), "{target:?}");
            assert_eq!(linear.weights(target), Linear::new(&mesh).weights(target));
        }
    }
}

/// Linear precision where there are many neighbours.
#[test]
fn targets_are_the_means_of_their_natural_neighbours() {
    let mut random = Random::new(33);
    for family in 0..DEGENERATE_FAMILIES {
        let points = as_floats(&degenerate(&mut random, family, 500));
        let mesh = triangulate(&points).expect("finite points");
        let mut natural = NaturalNeighbours::new(&mesh);
        for target in (0..100).flat_map(|_| targets(&mut random, &points)) {
            let Some(weights) = natural.weights(target) else { continue };
            for axis in [0, 1] {
                let ways =
                    weights.iter().map(|&(v, weight)| (points[v as usize][axis] - target[axis], weight));
                let (sum, size) = ways.fold((0.0, 0.0), |(sum, size): (f64, f64), (way, weight)| {
                    (sum + way * weight, size + way.abs())
                });
                assert!(sum.abs() <= NATURAL_ERROR * size, "{family} {target:?}: {sum} of {size}");
            }
        }
    }
}

#[test]
fn smooth_interpolation_is_exact_for_circular_paraboloids_and_at_vertices() {
    let mut random = Random::new(34);
    let points: Vec<Point> = (0..200).map(|_| [random.unit(), random.unit()]).collect();
    let mesh = triangulate(&points).expect("finite points");
    let value = |[x, y]: Point| 3.0 - x + 2.0 * y + 5.0 * (x * x + y * y);
    let values: Vec<f64> = points.iter().copied().map(value).collect();
    let gradients: Vec<Point> = points.iter().map(|[x, y]| [10.0 * x - 1.0, 10.0 * y + 2.0]).collect();
    let mut natural = NaturalNeighbours::new(&mesh);
    let mut inside = 0;
    for target in (0..500).map(|_| [random.unit(), random.unit()]) {
        let Some(found) = natural.interpolate_smoothly(&values, &gradients, target) else { continue };
        inside += 1;
        assert!((found - value(target)).abs() < 1e-10, "{target:?}");
    }
    assert!(inside > 400);
    for (v, &point) in points.iter().enumerate() {
        assert_eq!(natural.interpolate_smoothly(&values, &gradients, point), Some(values[v]));
    }
}

/// The weights of the first triangle that contains the target, in integers.
fn barycentric(points: &[Point], mesh: &Triangulation, target: Point) -> Option<Vec<f64>> {
    let area = |p: Point, q: Point, r: Point| {
        let [a, b, c, d] = [q[0] - p[0], r[1] - p[1], q[1] - p[1], r[0] - p[0]].map(|x| x as i64);
        a * b - c * d
    };
    mesh.simplices().find_map(|triangle| {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let areas = [area(b, c, target), area(c, a, target), area(a, b, target)];
        let mut weights = vec![0.0; points.len()];
        (0..3).for_each(|i| weights[triangle[i] as usize] = areas[i] as f64 / area(a, b, c) as f64);
        areas.iter().all(|&area| area >= 0).then_some(weights)
    })
}

#[test]
fn an_edge_of_the_least_numbers_is_divided() {
    let least = f64::from_bits(1);
    let at = |x: f64, y: f64| [x * least, y * least];
    let points = [at(2.0, 1.0), at(-2.0, 2.0), at(-2.0, -2.0), at(2.0, -1.0)];
    let mesh = triangulate(&points).expect("finite points");
    let mut natural = NaturalNeighbours::new(&mesh);
    assert_eq!(natural.weights(at(2.0, 0.0)), Some(&[(0, 0.5), (3, 0.5)][..]));
}

#[test]
fn linear_weights_are_areas() {
    let mut random = Random::new(35);
    for round in 0..300 {
        let side = [6, 1000, 1 << 25][round % 3];
        let integers = match round % 2 {
            0 => degenerate(&mut random, round / 2 % DEGENERATE_FAMILIES, 12),
            _ => uniform(&mut random, round % 12 + 1, side),
        };
        let points = as_floats(&integers);
        let scale = [1.0, 2f64.powi(950), 2f64.powi(-1000)][round / 2 % 3];
        let scaled: Vec<Point> = points.iter().map(|p| p.map(|c| c * scale)).collect();
        let mesh = triangulate(&scaled).expect("finite points");
        let mut linear = Linear::new(&mesh);
        for _ in 0..20 {
            let [a, b, c] = [0; 3].map(|_| points[random.integer(0, points.len() as i64 - 1) as usize]);
            for target in [a, [0, 1].map(|i| ((a[i] + b[i] + 2.0 * c[i]) / 4.0).round())] {
                let found = linear.weights(target.map(|c| c * scale));
                let vertex = points.iter().position(|&point| point == target);
                let expected = barycentric(&points, &mesh, target)
                    .or(vertex.map(|v| (0..points.len()).map(|w| f64::from(u8::from(v == w))).collect()));
                assert_eq!(found.is_some(), expected.is_some(), "{points:?} {target:?}");
                let (Some(found), Some(expected)) = (found, expected) else { continue };
                let mut weights = vec![0.0; points.len()];
                found.iter().for_each(|&(v, weight)| weights[v as usize] += weight);
                for (weight, expected) in weights.iter().zip(&expected) {
                    assert!((weight - expected).abs() <= LINEAR_ERROR * expected, "{points:?} {target:?}");
                }
                let values: Vec<f64> = (0..points.len()).map(|v| 0.1 + v as f64).collect();
                if let Some(v) = vertex {
                    assert_eq!(linear.interpolate(&values, target.map(|c| c * scale)), Some(values[v]));
                }
            }
        }
    }
}

/// In space, against volumes in integers: random sets, lattices, and flat tetrahedra, of several scales.
#[test]
fn linear_weights_are_volumes() {
    let mut random = Random::new(77);
    for round in 0..120 {
        let side = [3, 9, 1 << 20, 1 << 20][round % 4];
        let flatness = [1, 1, 1, 1 << 18][round % 4];
        // Axes of scales far apart, too, where products of three are of any size.
        let exponents =
            [[0; 3], [-3; 3], [300; 3], [-340; 3], [900; 3], [-1000; 3], [338, -458, -669]][round % 7];
        let scaled = |place: [i64; 3]| [0, 1, 2].map(|axis| place[axis] as f64 * 2f64.powi(exponents[axis]));
        let count = 4 + random.integer(0, 10);
        let corner = |random: &mut Random| [1, 1, flatness].map(|by| 2 * random.integer(0, side / by));
        let places: Vec<[i64; 3]> = (0..count).map(|_| corner(&mut random)).collect();
        let points: Vec<[f64; 3]> = places.iter().map(|&place| scaled(place)).collect();
        let mesh = delaunay3::triangulate(&points).expect("finite points");
        let mut linear = delaunay3::Linear::new(&mesh);
        for turn in 0..20 {
            let [a, b] = [0, 1].map(|_| places[random.integer(0, count - 1) as usize]);
            let target = match turn % 3 {
                0 => a,
                1 => [0, 1, 2].map(|axis| (a[axis] + b[axis]) / 2),
                _ => corner(&mut random).map(|c| c + 1),
            };
            let at = scaled(target);
            let Some(weights) = linear.weights(at) else {
                assert_eq!(mesh.locate(at), Location::Outside, "{points:?} {at:?}");
                continue;
            };
            let corners = weights.map(|(vertex, _)| places[vertex as usize]);
            let volume = |corners: [[i64; 3]; 4]| -> i128 {
                let [a, b, c] =
                    [1, 2, 3].map(|i| [0, 1, 2].map(|k| i128::from(corners[i][k] - corners[0][k])));
                let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
                a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
            };
            let total = volume(corners);
            for (corner, (vertex, weight)) in weights.into_iter().enumerate() {
                let mut part = corners;
                part[corner] = target;
                let part = volume(part);
                assert!(part >= 0 && total > 0);
                assert_eq!(part == 0, weight == 0.0, "{points:?} {at:?} {corner} {weights:?} {part} {total}");
                assert!((weight - part as f64 / total as f64).abs() < 1e-13, "{points:?} {at:?} {vertex}");
                assert!(part != total || weight == 1.0);
            }
        }
    }
}

#[test]
fn gradients_of_linear_functions_are_exact() {
    let mut random = Random::new(36);
    for family in 0..=DEGENERATE_FAMILIES {
        let mut points = match family {
            DEGENERATE_FAMILIES => as_floats(&uniform(&mut random, 300, 1 << 20)),
            _ => as_floats(&degenerate(&mut random, family, 300)),
        };
        points.push(points[7]);
        let values: Vec<f64> = points.iter().map(|[x, y]| 2.0 * x - 0.5 * y + 7.0).collect();
        let mesh = triangulate(&points).expect("finite points");
        let gradients = mesh.gradients(&values);
        let expected = if mesh.simplices().len() == 0 { [0.0; 2] } else { [2.0, -0.5] };
        for ([x, y], point) in gradients.into_iter().zip(points) {
            let error = (x - expected[0]).abs().max((y - expected[1]).abs());
            assert!(error < 1e-6, "{family} {point:?}: {x}, {y}");
        }
    }
}
