//! Several threads: each set is cut into parts of a few points, and the result proved as that of one thread
//! is.

use super::promises::{prove, tetrahedra};
use super::proved;
use spmesh_delaunay::delaunay2;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::order::Sequence;
use spmesh_delaunay::{Error, Watch};
use spmesh_reference::clouds::{self, FAMILIES, Family};
use spmesh_reference::sets::Random;
use spmesh_reference::space::Point;
use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::sync::Arc;

const THREADS: [usize; 3] = [2, 3, 8];

fn count(threads: usize) -> NonZeroUsize {
    NonZeroUsize::new(threads).expect("a positive number")
}

fn parallel(threads: usize, points_per_thread: usize) -> Kernel {
    let mut kernel = Kernel::new();
    (kernel.threads, kernel.points_per_thread) = (count(threads), points_per_thread);
    kernel
}

#[test]
fn every_family() {
    for (family, threads) in FAMILIES.into_iter().flat_map(|family| THREADS.map(move |t| (family, t))) {
        let is_slow = matches!(family, Family::Wild | Family::MomentCurve | Family::SkewLines);
        let size = if is_slow { 60 } else { 900 };
        let mut points = clouds::of(&mut Random::new(threads as u64), family, size);
        Random::new(1).shuffle(&mut points);
        points.truncate(size);
        proved(&mut parallel(threads, 4), &points);
    }
}

#[test]
fn mixtures_of_any_size() {
    for seed in 0..300 {
        let mut random = Random::new(9000 + seed);
        let size = random.integer(0, 200) as usize;
        let points = clouds::mixture(&mut random, size);
        let points_per_thread = random.integer(0, 12) as usize;
        proved(&mut parallel(THREADS[seed as usize % 3], points_per_thread), &points);
    }
}

/// A tetrahedralization that was put in order stays one, and does not tell how many threads made it.
#[test]
fn order_without_threads() {
    for seed in (0..60).step_by(3) {
        let mut random = Random::new(400 + seed);
        let points = clouds::mixture(&mut random, 10 * seed as usize);
        let sorted = |mut kernel: Kernel| -> Vec<_> {
            let mut mesh = proved(&mut kernel, &points);
            mesh.sort();
            assert_eq!(prove(&points, &mesh), Ok(()));
            mesh.tetrahedra()
                .iter()
                .map(|t| (t.vertices, [0, 1, 2, 3].map(|side| t.neighbour(side))))
                .collect()
        };
        let expected = sorted(Kernel::new());
        assert!(expected.is_sorted(), "{expected:?}");
        for threads in THREADS {
            assert!(sorted(parallel(threads, 4)) == expected, "{threads} threads, {points:?}");
        }
    }
}

/// Somebody stops the work: at once, or while it goes on.
#[test]
fn watched() {
    let points = clouds::of(&mut Random::new(5), Family::Uniform, 30_000);
    for (threads, is_stopped) in
        [1, 3].into_iter().flat_map(|threads| [false, true].map(|stop| (threads, stop)))
    {
        let mut kernel = parallel(threads, 1_000);
        let watch = Arc::new(Watch::default());
        kernel.watch = Some(watch.clone());
        if is_stopped {
            watch.stop();
        }
        let mut mesh = Tetrahedralization::default();
        let made = kernel.triangulate(Cow::Borrowed(&points), &mut mesh);
        assert_eq!(made, if is_stopped { Err(Error::Stopped) } else { Ok(()) });
        assert_eq!(mesh.tetrahedra().is_empty(), is_stopped);
        assert_eq!(watch.inserted() < points.len() / 2, is_stopped, "{}", watch.inserted());
        let plane: Vec<[f64; 2]> = points.iter().map(|&[x, y, _]| [x, y]).collect();
        let (mut kernel, mut triangles) = (delaunay2::Kernel::new(), delaunay2::Triangles::default());
        let watch = Arc::new(Watch::default());
        kernel.watch = Some(watch.clone());
        if is_stopped {
            watch.stop();
        }
        assert_eq!(kernel.triangulate(&plane, &mut triangles).is_err(), is_stopped);
        assert_eq!(triangles.triangles().is_empty(), is_stopped);
        assert_eq!(watch.inserted() < points.len() / 2, is_stopped, "{}", watch.inserted());
    }
}

/// Many parts, thick ones, and points that are all but a few in one of them.
#[test]
fn larger_sets() {
    let mut random = Random::new(11);
    let uniform = clouds::of(&mut random, Family::Uniform, 20_000);
    let mut crowd = clouds::of(&mut random, Family::Uniform, 6_000);
    crowd.iter_mut().for_each(|p| *p = p.map(|c| c * 1e-9));
    crowd.extend_from_slice(&uniform[..300]);
    let mut twice = uniform[..4_000].to_vec();
    twice.extend_from_within(1_000..);
    let flat: Vec<Point> = uniform.iter().map(|p| [p[0], p[1], 0.25]).collect();
    let sphere = clouds::of(&mut random, Family::RoundedSphere, 3_000);
    let chain = clouds::of(&mut random, Family::Chain, 15_000);
    let huge: Vec<Point> = uniform[..2_000].iter().map(|p| p.map(|c| c * 1e300)).collect();
    for points in [uniform, crowd, twice, flat, sphere, chain, huge] {
        for (threads, points_per_thread) in [(2, 1_000), (3, 200), (8, 20)] {
            proved(&mut parallel(threads, points_per_thread), &points);
        }
    }
}

#[test]
fn any_sequence_of_insertion() {
    let points = clouds::of(&mut Random::new(5), Family::Chain, 3_000);
    let expected = tetrahedra(&proved(&mut Kernel::new(), &points));
    for sequence in [Sequence::Rounds, Sequence::Pass, Sequence::Random { seed: 3 }] {
        for by_bit_levels in [false, true] {
            let mut kernel = parallel(3, 50);
            (kernel.sequence, kernel.by_bit_levels) = (sequence, by_bit_levels);
            let found = tetrahedra(&proved(&mut kernel, &points));
            assert!(found == expected, "{sequence:?}, {by_bit_levels}");
        }
    }
}

/// Corners, in the order that they are written in, depend on the points alone.
#[test]
fn corners_are_the_same_for_any_number_of_threads() {
    let corners = |mut kernel: Kernel, points: &[Point], threads: usize| {
        let mut mesh = Tetrahedralization::default();
        kernel.triangulate(Cow::Borrowed(points), &mut mesh).expect("finite points");
        let set = tetrahedra(&mesh);
        let indices: Vec<u32> = mesh.vertices().iter().map(|vertex| vertex.index).collect();
        let mut corners = mesh.into_corners(|_| true, count(threads)).expect("no errors");
        let corners = corners.parts().tetrahedra.to_vec();
        let sorted = spmesh_reference::tetrahedra::as_set(
            corners.iter().map(|corners| corners.map(|v| indices[v as usize])),
        );
        assert!(sorted == set, "other tetrahedra than those of the mesh");
        assert!(corners.is_sorted_by_key(|&[a, b, c, d]| [d, a, b, c]));
        (corners, indices)
    };
    for (family, size) in
        [(Family::Uniform, 30_000), (Family::Cubic, 20_000), (Family::Chain, 9), (Family::Line, 9)]
    {
        let points = clouds::of(&mut Random::new(2), family, size);
        let expected = corners(Kernel::new(), &points, 1);
        for threads in THREADS {
            assert!(corners(parallel(threads, 500), &points, threads) == expected, "{family:?}, {threads}");
        }
    }
}

/// The work on several threads is little more than that on one: few points are refused by the parts.
#[test]
fn parts_take_most_points() {
    let points = clouds::of(&mut Random::new(6), Family::Uniform, 60_000);
    let created = |mut kernel: Kernel| {
        let mut mesh = Tetrahedralization::default();
        kernel.triangulate(Cow::Borrowed(&points), &mut mesh).expect("finite points");
        (mesh.stats.created as f64, mesh.stats.refused as f64)
    };
    let (alone, refused) = created(Kernel::new());
    assert_eq!(refused, 0.0);
    let (together, refused) = created(parallel(2, 10_000));
    assert!(together < 1.02 * alone, "{together} tetrahedra created, {alone} on one thread");
    assert!(refused > 0.0 && refused < 0.2 * points.len() as f64, "{refused} points refused");
}
