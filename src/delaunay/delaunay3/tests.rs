//! The lanes that are everywhere against those of the processor at hand, which the integration tests prove
//! right.

use super::{Error, Kernel, Point3, Tetrahedralization};
use std::borrow::Cow;
use std::num::NonZeroUsize;

/// Pseudo-random numbers in [0, 1).
fn random(count: usize) -> Vec<Point3> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| [next(), next(), next()]).collect()
}

fn mesh(kernel: &mut Kernel, points: &[Point3]) -> Tetrahedralization {
    let mut mesh = Tetrahedralization::default();
    kernel.triangulate(Cow::Borrowed(points), &mut mesh).expect("finite points");
    mesh
}

fn tetrahedra(kernel: &mut Kernel, points: &[Point3]) -> Vec<[u32; 4]> {
    sorted(&mesh(kernel, points))
}

/// Tetrahedra as sorted indices of points, sorted.
fn sorted(mesh: &Tetrahedralization) -> Vec<[u32; 4]> {
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
        (0..216).map(|i| [i % 6, i / 6 % 6, i / 36].map(|c| f64::from(c) * step)).collect()
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

/// Uniform points, and a lattice full of ties: few in Miri (scripts/check-unsafe), which takes seconds for
/// each.
fn small_sets() -> [Vec<Point3>; 2] {
    let (count, side) = if cfg!(miri) { (28, 3) } else { (800, 9) };
    let lattice = (0..side * side * side).map(|i| [i % side, i / side % side, i / (side * side)]);
    [random(count), lattice.map(|p| p.map(f64::from)).collect()]
}

/// Parts share the array of tetrahedra without a word that two of them touch; points between parts follow.
#[test]
fn parts_of_small_sets() {
    let mut refused = 0;
    for points in small_sets() {
        let expected = tetrahedra(&mut Kernel::new(), &points);
        for threads in [2, 3] {
            let threads = NonZeroUsize::new(threads).expect("a positive number");
            let mut kernel = Kernel { threads, points_per_thread: 4, ..Kernel::default() };
            let mesh = mesh(&mut kernel, &points);
            assert_eq!(sorted(&mesh), expected, "{threads} threads");
            refused += mesh.stats.refused;
        }
    }
    assert!(refused > 0, "no set was cut into parts");
}

/// A kernel and a mesh may be used again, also after a refusal, with fewer points, and with weights.
#[test]
fn small_sets_in_buffers_of_others() {
    let (mut kernel, mut mesh) = (Kernel::new(), Tetrahedralization::default());
    let [uniform, lattice] = small_sets();
    for points in [&uniform[..], &lattice, &uniform[..5], &lattice[..lattice.len() / 2], &uniform] {
        let bad = [[0.0; 3], [f64::NAN, 0.0, 1.0]];
        assert!(kernel.triangulate(Cow::Borrowed(&bad), &mut mesh).is_err());
        kernel.triangulate(Cow::Borrowed(points), &mut mesh).expect("finite points");
        let weights: Vec<f64> = (0..points.len()).map(|i| (i % 3) as f64 * 0.01).collect();
        kernel.triangulate_weighted(Cow::Borrowed(points), &weights, &mut mesh).expect("finite weights");
        assert!(!mesh.tetrahedra().is_empty());
    }
}

/// Points of two lines have as many tetrahedra as there are pairs of edges; with threads or without, the
/// kernel stops at the limit, and makes as many as it may.
#[test]
fn tetrahedra_have_a_limit() {
    let side = |t: i32| [[f64::from(t), 0.0, 0.0], [0.0, f64::from(t), 1.0]];
    let points: Vec<Point3> = (0..60).flat_map(side).collect();
    let mut mesh = Tetrahedralization::default();
    for threads in [1, 3].map(|threads| NonZeroUsize::new(threads).expect("a positive number")) {
        let mut kernel = Kernel { threads, points_per_thread: 4, ..Kernel::default() };
        kernel.tetrahedra_max = 2_000;
        let refused = kernel.triangulate(Cow::Borrowed(&points), &mut mesh);
        assert_eq!(refused, Err(Error::TooManyTetrahedra(2_000)), "{threads} threads");
        kernel.tetrahedra_max = 5_000;
        kernel.triangulate(Cow::Borrowed(&points), &mut mesh).expect("room for all");
        assert_eq!(mesh.tetrahedra().len(), 59 * 59);
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
