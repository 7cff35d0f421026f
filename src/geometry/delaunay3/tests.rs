//! The lanes that are everywhere against those of the processor at hand, which the integration tests prove
//! right.

use super::{Kernel, Point3, Tetrahedralization};
use std::borrow::Cow;

/// Pseudo-random numbers in [0, 1).
fn random(count: usize) -> Vec<Point3> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| [next(), next(), next()]).collect()
}

/// Tetrahedra as sorted indices of points, sorted.
fn tetrahedra(kernel: &mut Kernel, points: &[Point3]) -> Vec<[u32; 4]> {
    let mut mesh = Tetrahedralization::default();
    kernel.triangulate(Cow::Borrowed(points), &mut mesh).expect("finite points");
    let mut set: Vec<[u32; 4]> = mesh
        .tetrahedra()
        .iter()
        .map(|t| {
            let mut vertices = t.vertices.map(|v| mesh.vertices()[v as usize].index);
            vertices.sort_unstable();
            vertices
        })
        .collect();
    set.sort_unstable();
    set
}

/// Compares sets of `count` random points, and sets that are special.
fn lanes_agree(count: usize) {
    let uniform = random(count);
    let map = |change: fn(f64) -> f64| -> Vec<Point3> { uniform.iter().map(|p| p.map(change)).collect() };
    let on_a_sphere = |p: &Point3| {
        let p = p.map(|c| c - 0.5);
        let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
        p.map(|c| c / length)
    };
    let lattice = |step: f64| -> Vec<Point3> {
        (0..1_000).map(|i| [i % 10, i / 10 % 10, i / 100].map(|c| f64::from(c) * step)).collect()
    };
    let sets = [
        map(|c| (c * 12.0).floor()),
        map(|c| (c * 1024.0).floor()),
        map(|c| (c * 1e9).floor()),
        map(|c| (c * 1e15).floor()),
        map(|c| c.powi(40) * 1e-3),
        map(|c| c * 1e-310),
        map(|c| (c - 0.5) * 1e300),
        map(|c| if c < 0.5 { 10f64.powf(600.0 * c - 150.0) } else { -c }),
        uniform.iter().map(on_a_sphere).chain([[0.0; 3]]).collect(),
        lattice(1.0),
        lattice(0.1),
        lattice(1e-160),
        lattice(1e160),
        (0..80).map(f64::from).flat_map(|t| [[t, 0.0, 0.0], [40.0, t - 40.0, 0.1]]).collect(),
    ];
    let (mut widest, mut portable) = (Kernel::new(), Kernel { is_portable: true, ..Kernel::default() });
    for (number, points) in sets.iter().enumerate() {
        let (found, expected) = (tetrahedra(&mut portable, points), tetrahedra(&mut widest, points));
        assert!(!found.is_empty() && found == expected, "set {number}");
    }
}

#[test]
fn lanes_make_no_difference() {
    lanes_agree(400);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn lanes_make_no_difference_with_many_points() {
    lanes_agree(3_000);
}
