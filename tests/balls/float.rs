//! The floating-point 3D program: correct where no operation rounds, and structurally valid in any case.

use robust::{Coord3D, insphere, orient3d};
use spmesh_delaunay::delaunay3::{Corner, Tetrahedralization};
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_molecules::float::{Options, Stats, triangulate};
use spmesh_reference::sets::Random;
use std::collections::{HashMap, HashSet};

type Point = [f64; 3];

/// For each corner, the opposite facet, ordered so that the corner followed by the facet is positively
/// oriented.
const FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Every combination of options, with signs checked.
fn all_options() -> Vec<Options> {
    let passes = Curve::ALL.into_iter().map(|curve| (curve, Sequence::Pass));
    let sequences = [Sequence::Rounds, Sequence::Random { seed: 3 }];
    let orders = passes.chain(sequences.into_iter().map(|sequence| (Curve::Hilbert, sequence)));
    let options = |(curve, sequence), flags: u64| Options {
        curve,
        sequence,
        by_bit_levels: flags & 1 != 0,
        seed: 7 + flags,
        check_signs: true,
        cache_spheres: flags & 2 != 0,
        orientation_from_spheres: flags & 4 != 0,
    };
    orders.flat_map(|order| (0..8).map(move |flags| options(order, flags))).collect()
}

fn coord([x, y, z]: Point) -> Coord3D<f64> {
    Coord3D { x, y, z }
}

/// Positive if the tetrahedron is positively oriented.
fn orientation(corners: [Point; 4]) -> f64 {
    let [a, b, c, d] = corners.map(coord);
    -orient3d(a, b, c, d)
}

/// Positive if `e` is inside the sphere of a positively oriented tetrahedron.
fn in_sphere(corners: [Point; 4], e: Point) -> f64 {
    let [a, b, c, d] = corners.map(coord);
    -insphere(a, b, c, d, coord(e))
}

/// Checks what must hold in spite of rounding: the tetrahedra fit together, and each distinct point is a
/// vertex or missing.
fn check_structure(points: &[Point], mesh: &Tetrahedralization, stats: &Stats) {
    let distinct: HashSet<[u64; 3]> = points.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    assert_eq!(mesh.vertices().len(), distinct.len());
    assert_eq!(mesh.vertices().len() + mesh.duplicates.len(), points.len());
    assert!(mesh.vertices().iter().all(|vertex| vertex.at == points[vertex.index as usize]));
    for &[duplicate, other] in &mesh.duplicates {
        assert!(other < duplicate);
        assert_eq!(points[duplicate as usize], points[other as usize]);
    }
    let mut facets: HashMap<[u32; 3], u32> = HashMap::new();
    let mut vertices = HashSet::new();
    for (t, tetrahedron) in mesh.tetrahedra().iter().enumerate() {
        vertices.extend(tetrahedron.vertices);
        for (side, corners) in FACETS.into_iter().enumerate() {
            let mut facet = corners.map(|i| tetrahedron.vertices[i]);
            facet.sort_unstable();
            *facets.entry(facet).or_default() += 1;
            let Some(Corner { tetrahedron: other, corner }) = tetrahedron.neighbour(side) else { continue };
            let other = mesh.tetrahedra()[other as usize];
            let mut shared = FACETS[corner as usize].map(|i| other.vertices[i]);
            shared.sort_unstable();
            assert_eq!(facet, shared);
            let back = Corner { tetrahedron: t as u32, corner: side as u32 };
            assert_eq!(other.neighbour(corner as usize), Some(back));
        }
    }
    for tetrahedron in mesh.tetrahedra() {
        for (side, corners) in FACETS.into_iter().enumerate() {
            let mut facet = corners.map(|i| tetrahedron.vertices[i]);
            facet.sort_unstable();
            assert_eq!(facets[&facet], if tetrahedron.neighbour(side).is_some() { 2 } else { 1 });
        }
    }
    assert_eq!(stats.missing as usize, mesh.vertices().len() - vertices.len());
    assert!(stats.created as usize >= mesh.tetrahedra().len());
}

/// Checks exactly that a mesh is a Delaunay tetrahedralization: positively oriented, locally Delaunay, and
/// convex.
fn check_delaunay(mesh: &Tetrahedralization) {
    let mut hull = Vec::new();
    for tetrahedron in mesh.tetrahedra() {
        let corners = tetrahedron.vertices.map(|v| mesh.vertices()[v as usize].at);
        assert!(orientation(corners) > 0.0);
        for (side, facet) in FACETS.into_iter().enumerate() {
            match tetrahedron.neighbour(side) {
                Some(other) => {
                    let other =
                        &mesh.tetrahedra()[other.tetrahedron as usize].vertices[other.corner as usize];
                    assert!(in_sphere(corners, mesh.vertices()[*other as usize].at) <= 0.0);
                }
                None => hull.push(facet.map(|i| corners[i])),
            }
        }
    }
    for [a, b, c] in hull {
        assert!(mesh.vertices().iter().all(|p| orientation([p.at, a, b, c]) >= 0.0));
    }
}

/// Runs all options on points for which no operation rounds.
fn check_exact(points: &[Point]) {
    for options in all_options() {
        let (mesh, stats) = triangulate(points, &options).expect("finite points");
        check_structure(points, &mesh, &stats);
        check_delaunay(&mesh);
        assert!(stats.missing == 0 || mesh.tetrahedra().is_empty(), "{options:?}: {stats:?}");
        assert_eq!((stats.wrong_signs, stats.wrong_zeros, stats.rounded), (0, 0, 0), "{options:?}");
        assert_eq!((stats.restarts, stats.forced, stats.repairs), (0, 0, 0), "{options:?}: {stats:?}");
    }
}

/// Runs all options on any points.
fn check_any(points: &[Point]) {
    for options in all_options() {
        let options = Options { check_signs: options.seed == 7, ..options };
        let (mesh, stats) = triangulate(points, &options).expect("finite points");
        check_structure(points, &mesh, &stats);
    }
}

fn uniform(random: &mut Random, count: usize, bits: u32) -> Vec<Point> {
    let mut number = || random.integer(0, (1 << bits) - 1) as f64;
    (0..count).map(|_| [number(), number(), number()]).collect()
}

fn grid(side: usize) -> Vec<Point> {
    let number = |i: usize| (i % side) as f64;
    (0..side.pow(3)).map(|i| [number(i), number(i / side), number(i / side / side)]).collect()
}

#[test]
fn random_points_of_ten_bits() {
    let mut random = Random::new(1);
    for count in [4, 5, 6, 10, 30, 100, 1000] {
        check_exact(&uniform(&mut random, count, 10));
    }
}

#[test]
fn points_at_the_corners_of_ten_bits() {
    let mut random = Random::new(2);
    let mut number = || {
        let low = random.integer(0, 40);
        (if random.bits() & 1 == 0 { low } else { 1023 - low }) as f64
    };
    let points: Vec<Point> = (0..300).map(|_| [number(), number(), number()]).collect();
    check_exact(&points);
}

#[test]
fn ties_of_every_kind() {
    let mut random = Random::new(3);
    for bits in [1, 2, 3] {
        for count in [6, 10, 40, 300] {
            check_exact(&uniform(&mut random, count, bits));
        }
    }
    let mut points = grid(7);
    check_exact(&points);
    random.shuffle(&mut points);
    points.truncate(200);
    check_exact(&points);
}

/// The tetrahedra with empty spheres, found by trying all. Domain: no five points on a sphere.
fn exhaustive(points: &[Point]) -> HashSet<[u32; 4]> {
    let n = points.len();
    let mut found = HashSet::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                for d in c + 1..n {
                    let corners = [a, b, c, d].map(|i| points[i]);
                    let side = orientation(corners);
                    let is_empty = |p: &Point| in_sphere(corners, *p) * side.signum() <= 0.0;
                    if side != 0.0 && points.iter().all(is_empty) {
                        found.insert([a, b, c, d].map(|i| i as u32));
                    }
                }
            }
        }
    }
    found
}

#[test]
fn the_same_tetrahedra_as_by_trying_all() {
    let mut random = Random::new(4);
    for count in [4, 5, 8, 16, 32] {
        let points = uniform(&mut random, count, 10);
        let expected = exhaustive(&points);
        for options in all_options() {
            let (mesh, _) = triangulate(&points, &options).expect("finite points");
            let found: HashSet<[u32; 4]> = mesh
                .tetrahedra()
                .iter()
                .map(|tetrahedron| {
                    let mut vertices = tetrahedron.vertices.map(|v| mesh.vertices()[v as usize].index);
                    vertices.sort_unstable();
                    vertices
                })
                .collect();
            assert_eq!(found, expected, "let points = vec!{points:?};");
        }
    }
}

#[test]
fn few_points_and_flat_ones_give_no_tetrahedra() {
    let line: Vec<Point> = (0..50).map(|i| [f64::from(i), f64::from(2 * i), 7.0]).collect();
    let plane: Vec<Point> = grid(8).into_iter().filter(|p| p[2] == 3.0).collect();
    let tilted: Vec<Point> = plane.iter().map(|&[x, y, _]| [x * 0.1, y * 0.1, x * 0.1]).collect();
    let equal = vec![[1.0, 2.0, 3.0]; 20];
    let few = [vec![], vec![[1.0; 3]], grid(2)[..2].to_vec(), grid(2)[..3].to_vec()];
    for points in few.into_iter().chain([line, plane, tilted, equal]) {
        for options in all_options() {
            let (mesh, stats) = triangulate(&points, &options).expect("finite points");
            assert!(mesh.tetrahedra().is_empty());
            check_structure(&points, &mesh, &stats);
        }
    }
}

#[test]
fn flat_points_and_one_more() {
    let mut points: Vec<Point> = grid(8).into_iter().filter(|p| p[2] == 3.0).collect();
    points.push([2.0, 3.0, 9.0]);
    check_exact(&points);
    points.extend((0..50).map(|i| [f64::from(i), f64::from(2 * i), 3.0]));
    check_exact(&points);
}

#[test]
fn equal_points_are_one_vertex() {
    let mut random = Random::new(5);
    let mut points = uniform(&mut random, 100, 8);
    points.extend(points.clone());
    points.extend([[0.0, -0.0, 5.0], [-0.0, 0.0, 5.0]]);
    random.shuffle(&mut points);
    check_exact(&points);
}

#[test]
fn rounding_breaks_nothing() {
    let mut random = Random::new(6);
    let mut sets: Vec<Vec<Point>> = Vec::new();
    // Turned grids: rounding breaks all ties at random.
    let (sin, cos) = 0.3f64.sin_cos();
    for points in [grid(9), grid(9)[..81].to_vec()] {
        sets.push(
            points
                .iter()
                .map(|&[x, y, z]| [x * cos - y * sin, (x * sin + y * cos) * cos - z * sin, z * cos + y * sin])
                .collect(),
        );
    }
    sets.push(grid(8).iter().map(|p| p.map(|x| x * 0.1)).collect());
    // Points on a sphere.
    sets.push(
        (0..500)
            .map(|_| {
                let p = [random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5];
                let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
                p.map(|x| x / length + 1000.0)
            })
            .collect(),
    );
    // Coordinates far from the origin that differ in a few bits only.
    sets.push((0..500).map(|_| [(); 3].map(|()| 1e15 + random.integer(0, 8) as f64 * 0.125)).collect());
    sets.push(
        (0..500).map(|_| [random.unit(), 1.0 + random.unit() * 1e-15, 3.0 + random.unit() * 1e-15]).collect(),
    );
    // Overflow and underflow; then all magnitudes together.
    for scale in [1e-320, 1e-200, 1e-70, 1e-63, 1e-60, 1e60, 1e63, 1e70, 1e200, 1e308] {
        sets.push((0..150).map(|_| [(); 3].map(|()| (random.unit() - 0.5) * scale)).collect());
    }
    sets.push((0..400).map(|_| [(); 3].map(|()| 10f64.powi(random.integer(-300, 300) as i32))).collect());
    sets.push((0..400).map(|_| [(); 3].map(|()| 10f64.powi(random.integer(-20, 20) as i32))).collect());
    for points in sets {
        check_any(&points);
    }
}

#[test]
fn coordinates_that_are_not_finite_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut points = grid(3);
        points[5][1] = bad;
        let error = triangulate(&points, &Options::default()).expect_err("not finite");
        assert!(matches!(error, spmesh_delaunay::Error::NotFinite { point: 5, .. }));
        assert!(error.to_string().contains("point 5"), "{error}");
    }
}

#[test]
fn a_run_depends_on_its_seed_alone() {
    let points = uniform(&mut Random::new(8), 2000, 20);
    let run = |seed| {
        let options = Options { seed, ..Options::default() };
        triangulate(&points, &options).expect("finite points").1.walk_steps
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn order_along_a_curve_shortens_walks() {
    let points = uniform(&mut Random::new(9), 20_000, 16);
    let steps = |sequence, by_bit_levels| {
        let options = Options { sequence, by_bit_levels, ..Options::default() };
        let (_, stats) = triangulate(&points, &options).expect("finite points");
        stats.walk_steps as f64 / points.len() as f64
    };
    assert!(steps(Sequence::Pass, false) < 4.0);
    assert!(steps(Sequence::Pass, true) < 4.0);
    assert!(steps(Sequence::Random { seed: 1 }, false) > 15.0);
}
