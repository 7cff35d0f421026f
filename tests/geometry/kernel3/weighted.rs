//! Regular tetrahedralizations against the definition.

use super::promises::tetrahedra;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_reference::clouds::{self, FAMILIES, Family};
use spmesh_reference::sets::Random;
use spmesh_reference::space::{Point, distinct};
use spmesh_reference::tetrahedra::regular;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Tetrahedralizes distinct points, and compares with the definition, hidden points included. Returns the
/// number of these.
fn assert_regular(kernel: &mut Kernel, points: &[Point], weights: &[f64]) -> usize {
    let mesh = triangulated(kernel, points, weights);
    let found = tetrahedra(&mesh);
    assert_eq!(
        found,
        regular(points, weights),
        "let points = vec!{points:?};\nlet weights = vec!{weights:?};"
    );
    assert_eq!(mesh.vertices().len(), points.len());
    let visible: BTreeSet<u32> = found.iter().flatten().copied().collect();
    let hidden: BTreeSet<u32> = mesh.hidden.iter().copied().collect();
    let expected = (0..points.len() as u32).filter(|index| !found.is_empty() && !visible.contains(index));
    assert!(hidden.iter().copied().eq(expected), "hidden: {hidden:?}");
    mesh.hidden.len()
}

fn triangulated(kernel: &mut Kernel, points: &[Point], weights: &[f64]) -> Tetrahedralization {
    let mut mesh = Tetrahedralization::default();
    kernel
        .triangulate_weighted(Cow::Borrowed(points), weights, &mut mesh)
        .expect("finite points and weights");
    mesh
}

/// Weights of kinds that differ in how many points they hide and how many ties they make.
fn weights_of(random: &mut Random, points: &[Point], kind: u64) -> Vec<f64> {
    let lift = |p: &Point| p.iter().map(|c| c * c).sum::<f64>().min(f64::MAX / 4.0);
    let greatest = points.iter().map(lift).fold(1e-300, f64::max);
    match kind % 7 {
        0 => vec![1.75; points.len()],
        1 => points.iter().map(|_| random.unit() * greatest * 0.1).collect(),
        2 => points.iter().map(|_| (random.unit() - 0.5) * greatest * 3.0).collect(),
        3 => points.iter().map(|_| random.integer(0, 2) as f64).collect(),
        // All lifts in one hyperplane, up to rounding: ties everywhere.
        4 => points.iter().map(lift).collect(),
        // The same, and some of them raised or lowered.
        5 => points.iter().map(|p| lift(p) + random.integer(-1, 1) as f64).collect(),
        // One ball that may hide many.
        _ => (0..points.len()).map(|i| if i == 0 { greatest } else { 0.0 }).collect(),
    }
}

#[test]
fn every_family_with_weights_of_every_kind() {
    let mut kernel = Kernel::new();
    let mut hidden = 0;
    for (number, family) in (0u64..).zip(FAMILIES) {
        for kind in 0..7 {
            let mut random = Random::new(100 * number + kind);
            let mut points = clouds::of(&mut random, family, 13);
            random.shuffle(&mut points);
            let (mut points, _) = distinct(&points);
            points.truncate(11);
            let weights = weights_of(&mut random, &points, kind);
            hidden += assert_regular(&mut kernel, &points, &weights);
        }
    }
    assert!(hidden > 50, "{hidden} hidden points");
}

#[test]
fn lattices_with_integer_weights() {
    let mut kernel = Kernel::new();
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let side = random.integer(1, 3);
        let scale = [1.0, 1000.0, 1e6, 1e9, 0.1][seed as usize % 5];
        let points: Vec<Point> = (0..random.integer(4, 12))
            .map(|_| [(); 3].map(|()| random.integer(0, side) as f64 * scale))
            .collect();
        let (points, _) = distinct(&points);
        let weights: Vec<f64> =
            points.iter().map(|_| random.integer(-2, 2) as f64 * (scale * scale)).collect();
        assert_regular(&mut kernel, &points, &weights);
    }
}

#[test]
fn huge_and_tiny_weights() {
    let mut kernel = Kernel::new();
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let points = clouds::of(&mut random, Family::Integers, 10);
        let (points, _) = distinct(&points);
        let scales = [1e-320, 1e-200, 1e-20, 1.0, 1e17, 1e150, 1e300];
        let weights: Vec<f64> =
            points.iter().map(|_| (random.unit() - 0.5) * scales[random.integer(0, 6) as usize]).collect();
        assert_regular(&mut kernel, &points, &weights);
    }
}

#[test]
fn equal_weights_make_no_difference() {
    let mut kernel = Kernel::new();
    for (number, family) in (0..).zip(FAMILIES) {
        let points = clouds::of(&mut Random::new(number), family, 300);
        let mut plain = Tetrahedralization::default();
        kernel.triangulate(Cow::Borrowed(&points), &mut plain).expect("finite points");
        let mesh = triangulated(&mut kernel, &points, &vec![2.5; points.len()]);
        assert_eq!(tetrahedra(&mesh), tetrahedra(&plain), "{family:?}");
        assert_eq!((mesh.hull_facets, &mesh.duplicates), (plain.hull_facets, &plain.duplicates));
        assert!(mesh.hidden.is_empty());
    }
}

#[test]
fn the_order_of_the_input_makes_no_difference() {
    let mut random = Random::new(7);
    let mut balls: Vec<(Point, f64)> = clouds::of(&mut random, Family::Cubic, 512)
        .into_iter()
        .map(|p| (p, random.integer(0, 3) as f64))
        .collect();
    let mut first = None;
    for _ in 0..4 {
        random.shuffle(&mut balls);
        let (points, weights): (Vec<Point>, Vec<f64>) = balls.iter().copied().unzip();
        let mesh = triangulated(&mut Kernel::new(), &points, &weights);
        let at = |v: u32| points[v as usize].map(f64::to_bits);
        let set: BTreeSet<_> = tetrahedra(&mesh).into_iter().map(|t| BTreeSet::from(t.map(at))).collect();
        assert_eq!(*first.get_or_insert(set.clone()), set);
    }
}

#[test]
fn the_heaviest_of_equal_points_is_the_vertex() {
    let corners = [[0.0; 3], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
    let points: Vec<Point> = [corners[0], corners[1], corners[0]].into_iter().chain(corners).collect();
    let mesh = triangulated(&mut Kernel::new(), &points, &[1.0, 1.0, 3.0, 3.0, 2.0, 1.0, 1.0]);
    assert_eq!(tetrahedra(&mesh), [[2, 4, 5, 6]]);
    let mut duplicates = mesh.duplicates.clone();
    duplicates.sort_unstable();
    assert_eq!(duplicates, [[0, 2], [1, 4], [3, 2]]);
}

#[test]
fn weights_that_are_not_finite_are_refused() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for bad in [f64::NAN, f64::INFINITY] {
        let error = Kernel::new()
            .triangulate_weighted(
                Cow::Borrowed(&points),
                &[0.0, 0.0, bad, 0.0],
                &mut Tetrahedralization::default(),
            )
            .expect_err("not finite");
        assert!(error.to_string().contains("point 2"), "{error}");
    }
}
