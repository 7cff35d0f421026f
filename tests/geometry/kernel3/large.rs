//! Sets of thousands of points, and changes of the input that must not change the result.

use super::promises::tetrahedra;
use super::proved;
use spmesh_delaunay::delaunay3::Kernel;
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_reference::clouds::{self, Family};
use spmesh_reference::sets::Random;
use spmesh_reference::space::Point;
use spmesh_reference::tetrahedra::as_set;

fn grid(side: i64) -> impl Iterator<Item = [i64; 2]> {
    (0..side * side).map(move |i| [i % side, i / side])
}

#[test]
fn points_in_space() {
    let mut kernel = Kernel::new();
    let sizes = [
        (Family::Uniform, 20_000),
        (Family::WideIntegers, 8_000),
        (Family::WideIntegers, 8_001),
        (Family::Chain, 10_000),
        (Family::Cluster, 5_000),
        (Family::Integers, 8_000),
    ];
    for (family, count) in sizes {
        proved(&mut kernel, &clouds::of(&mut Random::new(count as u64), family, count));
    }
}

#[test]
fn lattices() {
    let mut kernel = Kernel::new();
    for (family, count) in
        [(Family::Cubic, 5_000), (Family::FaceCentered, 6_000), (Family::BodyCentered, 5_000)]
    {
        let points = clouds::of(&mut Random::new(7), family, count);
        let before = kernel.counts().perturbed;
        proved(&mut kernel, &points);
        assert!(kernel.counts().perturbed - before > points.len() as u64, "lattices are full of ties");
        // Rounded coordinates turn ties into near ties.
        let decimal: Vec<Point> = points.iter().map(|p| p.map(|c| c * 0.1 + 431.7)).collect();
        proved(&mut kernel, &decimal[..decimal.len() / 4]);
    }
}

/// A point whose cavity is the whole mesh, and points that are all neighbours of each other.
#[test]
fn large_cavities() {
    let mut kernel = Kernel::new();
    let mut sphere = clouds::of(&mut Random::new(1), Family::RoundedSphere, 800);
    sphere.push([0.0; 3]);
    proved(&mut kernel, &sphere);
    let integer_sphere = |square: i64| {
        let side = (square as f64).sqrt() as i64 + 1;
        grid(2 * side + 1)
            .flat_map(move |[x, y]| (0..=2 * side).map(move |z| [x, y, z].map(|c| c - side)))
            .filter(move |p| p.iter().map(|c| c * c).sum::<i64>() == square)
            .map(|p| p.map(|c| c as f64))
    };
    proved(&mut kernel, &integer_sphere(941).chain([[0.0; 3]]).collect::<Vec<_>>());
    let lines = (0..90).map(f64::from).flat_map(|t| [[t, 0.0, 0.0], [45.0, t - 45.0, 7.0]]);
    assert_eq!(proved(&mut kernel, &lines.clone().collect::<Vec<_>>()).tetrahedra().len(), 89 * 89);
    proved(&mut kernel, &lines.map(|p| p.map(|c| c * 0.1)).collect::<Vec<_>>());
    // A cyclic polytope: all points are neighbours.
    let curve = clouds::of(&mut Random::new(1), Family::MomentCurve, 120);
    assert_eq!(proved(&mut kernel, &curve).tetrahedra().len(), 117 * 118 / 2);
    proved(&mut kernel, &clouds::of(&mut Random::new(1), Family::Paraboloid, 1_000));
    let bowl = grid(25).map(|[x, y]| [x - 12, y - 12, (x - 12) * (x - 12) + (y - 12) * (y - 12)]);
    proved(&mut kernel, &bowl.map(|p| p.map(|c| c as f64)).chain([[0.0, 0.0, 500.0]]).collect::<Vec<_>>());
    proved(&mut kernel, &clouds::of(&mut Random::new(1), Family::Cylinder, 1_200));
}

#[test]
fn the_order_of_the_input_and_copies_make_no_difference() {
    let mut kernel = Kernel::new();
    for seed in 0..12 {
        let mut random = Random::new(5000 + seed);
        let points = clouds::mixture(&mut random, 250);
        let expected = by_coordinates(&points, &tetrahedra(&unproved(&mut kernel, &points)));
        let mut shuffled = points.clone();
        for _ in 0..points.len() / 3 {
            shuffled.push(points[random.integer(0, points.len() as i64 - 1) as usize]);
        }
        random.shuffle(&mut shuffled);
        let found = by_coordinates(&shuffled, &tetrahedra(&unproved(&mut kernel, &shuffled)));
        assert!(found == expected, "seed {seed}");
    }
}

#[test]
fn the_order_of_insertion_makes_no_difference() {
    for (seed, family) in (0..).zip([Family::Uniform, Family::Cubic, Family::Chain, Family::RoundedSphere]) {
        let points = clouds::of(&mut Random::new(8000 + seed), family, 400);
        let expected = tetrahedra(&proved(&mut Kernel::new(), &points));
        for curve in Curve::ALL {
            for sequence in [Sequence::Rounds, Sequence::Pass, Sequence::Random { seed }] {
                for by_bit_levels in [false, true] {
                    let mut kernel = Kernel::new();
                    (kernel.curve, kernel.sequence, kernel.by_bit_levels) = (curve, sequence, by_bit_levels);
                    let found = tetrahedra(&unproved(&mut kernel, &points));
                    assert!(found == expected, "{family:?}, {curve:?}, {sequence:?}, {by_bit_levels}");
                }
            }
        }
    }
}

/// Tetrahedra as the sorted coordinates of their vertices.
fn by_coordinates(points: &[Point], tetrahedra: &[[u32; 4]]) -> Vec<[[u64; 3]; 4]> {
    let mut set: Vec<[[u64; 3]; 4]> = tetrahedra
        .iter()
        .map(|t| {
            let mut corners = t.map(|v| points[v as usize].map(|c| (c + 0.0).to_bits()));
            corners.sort_unstable();
            corners
        })
        .collect();
    set.sort_unstable();
    set
}

/// Scales and offsets select the arithmetic: integers of each width, floats, or any finite numbers.
#[test]
fn exact_scales_and_offsets_make_no_difference() {
    let mut kernel = Kernel::new();
    let families =
        [Family::Cubic, Family::Integers, Family::Orbit, Family::BodyCentered, Family::IntegerSphere];
    for (seed, family) in (0..).zip(families) {
        let points = clouds::of(&mut Random::new(6000 + seed), family, 700);
        let expected = tetrahedra(&proved(&mut kernel, &points));
        for exponent in [-1000, -400, -200, -3, 5, 16, 20, 30, 40, 55, 150, 400, 1000] {
            let scaled: Vec<Point> = points.iter().map(|p| p.map(|c| c * 2f64.powi(exponent))).collect();
            let found = tetrahedra(&unproved(&mut kernel, &scaled));
            assert!(found == expected, "{family:?} times 2^{exponent}");
        }
        for offset in [1.0, -1e6, 2f64.powi(50), 2f64.powi(-30), 0.125] {
            let moved: Vec<Point> = points.iter().map(|p| p.map(|c| c + offset)).collect();
            let found = tetrahedra(&unproved(&mut kernel, &moved));
            assert!(found == expected, "{family:?} plus {offset}");
        }
    }
}

/// Another order of insertion gives the same tetrahedra.
#[test]
fn symmetries_keep_the_tetrahedra_of_points_in_general_position() {
    let mut kernel = Kernel::new();
    let mut random = Random::new(7000);
    let points: Vec<Point> =
        (0..6000).map(|_| [random.unit(), random.unit() * 0.1, random.unit() * 3.0]).collect();
    let expected = tetrahedra(&proved(&mut kernel, &points));
    for turned in [
        points.iter().map(|p| [-p[1], p[0], p[2]]).collect::<Vec<Point>>(),
        points.iter().map(|p| [p[1], p[2], p[0]]).collect(),
        points.iter().map(|p| [-p[2], -p[1], -p[0]]).collect(),
    ] {
        let found = tetrahedra(&unproved(&mut kernel, &turned));
        assert!(found == expected);
    }
    let mirrored: Vec<Point> = points.iter().map(|p| [-p[0], p[1], p[2]]).collect();
    let found = unproved(&mut kernel, &mirrored);
    let inverted = tetrahedra(&found).into_iter().map(|[a, b, c, d]| [b, a, c, d]);
    assert!(as_set(inverted) == expected);
}

fn unproved(kernel: &mut Kernel, points: &[Point]) -> spmesh_delaunay::delaunay3::Tetrahedralization {
    let mut mesh = spmesh_delaunay::delaunay3::Tetrahedralization::default();
    kernel.triangulate(points.into(), &mut mesh).expect("finite points");
    mesh
}
