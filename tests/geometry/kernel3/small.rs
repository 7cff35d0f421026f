//! Sets of up to 60 points, against the definition.

use super::promises::tetrahedra;
use super::proved;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_reference::clouds::{self, FAMILIES, Family};
use spmesh_reference::sets::Random;
use spmesh_reference::space::{Point, Space, distinct};
use spmesh_reference::tetrahedra as by_definition;
use std::borrow::Cow;

/// Tetrahedralizes, proves, and compares with the `reference` for the distinct points.
fn assert_tetrahedra(kernel: &mut Kernel, points: &[Point], reference: impl Fn(&[Point]) -> Vec<[u32; 4]>) {
    let found = tetrahedra(&proved(kernel, points));
    let (kept, first) = distinct(points);
    let indices: Vec<u32> =
        (0..).zip(&first).filter(|&(i, &first)| i == first).map(|(i, _)| i as u32).collect();
    let expected = reference(&kept).into_iter().map(|t| t.map(|v| indices[v as usize]));
    // The map of indices is monotonic, so the set stays sorted.
    assert_eq!(found, expected.collect::<Vec<_>>(), "let points = vec!{points:?};");
}

fn with_decisions(points: &[Point]) -> Vec<[u32; 4]> {
    Space::new(points).tetrahedra()
}

#[test]
fn every_subset_of_a_small_lattice() {
    let mut kernel = Kernel::new();
    for subset in 0u32..1 << 12 {
        let members = (0..12).filter(|i| subset >> i & 1 == 1);
        let points: Vec<Point> = members.map(|i| [i % 3, i / 3 % 2, i / 6].map(f64::from)).collect();
        assert_tetrahedra(&mut kernel, &points, with_decisions);
    }
}

#[test]
fn every_sequence_of_up_to_five_corners_of_a_cube() {
    let mut kernel = Kernel::new();
    for length in 0..=5 {
        for sequence in 0..8usize.pow(length) {
            let corners = (0..length).map(|k| sequence >> (3 * k) & 7);
            let points: Vec<Point> = corners.map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|c| c as f64)).collect();
            proved(&mut kernel, &points);
        }
    }
}

#[test]
fn every_family() {
    let mut kernel = Kernel::new();
    let sizes = [4, 6, 9, 12, 15, 18, 22, 26, 30];
    for (family, size) in FAMILIES.into_iter().flat_map(|family| sizes.map(move |size| (family, size))) {
        // Exact decisions are slow for coordinates of all magnitudes, and where the filter rarely decides.
        let is_slow = matches!(family, Family::Wild | Family::RoundedSphere | Family::Cluster);
        let mut random = Random::new(size as u64);
        let mut points = clouds::of(&mut random, family, size);
        random.shuffle(&mut points);
        points.truncate(if is_slow { size.min(15) } else { size });
        assert_tetrahedra(&mut kernel, &points, with_decisions);
    }
}

#[test]
fn sixty_points() {
    let mut kernel = Kernel::new();
    for family in [Family::Uniform, Family::Integers, Family::Cubic, Family::IntegerSphere, Family::Orbit] {
        let mut points = clouds::of(&mut Random::new(60), family, 60);
        points.truncate(60);
        assert_tetrahedra(&mut kernel, &points, with_decisions);
    }
}

#[test]
fn mixtures() {
    let mut kernel = Kernel::new();
    for seed in 0..200 {
        let mut random = Random::new(1000 + seed);
        let count = random.integer(1, 14) as usize;
        let points = clouds::mixture(&mut random, count);
        let reference = if seed % 10 == 0 { by_definition::tetrahedra } else { with_decisions };
        assert_tetrahedra(&mut kernel, &points[..points.len().min(14)], reference);
    }
}

#[test]
fn larger_mixtures() {
    let mut kernel = Kernel::new();
    for seed in 0..100 {
        let mut random = Random::new(2000 + seed);
        let count = random.integer(15, 150) as usize;
        proved(&mut kernel, &clouds::mixture(&mut random, count));
    }
}

#[test]
fn huge_and_tiny_coordinates() {
    let mut kernel = Kernel::new();
    let scales = [5e-324, 1e-310, 1e-160, 1e-60, 1e-3, 1e60, 1e154, 1e300, 4e307];
    for (seed, scale) in (0..36).zip(scales.into_iter().cycle()) {
        let mut random = Random::new(3000 + seed);
        let side = if seed % 2 == 0 { 2 } else { 1 << 40 };
        let unit = if seed % 2 == 0 { 1.0 } else { side as f64 };
        let points: Vec<Point> = (0..random.integer(4, 12))
            .map(|_| [(); 3].map(|()| random.integer(-side, side) as f64 / unit * scale))
            .collect();
        assert_tetrahedra(&mut kernel, &points, with_decisions);
    }
}

#[test]
fn outliers_that_leave_the_rest_one_cell_of_the_curve() {
    let mut kernel = Kernel::new();
    for (seed, outlier) in [(0, 1e20), (1, 1e200), (2, f64::MAX), (3, -f64::MAX)] {
        let mut points = clouds::of(&mut Random::new(seed), Family::Integers, 14);
        points.extend([[outlier, 1.0, 0.0], [0.0, -outlier, 1.0]]);
        assert_tetrahedra(&mut kernel, &points, with_decisions);
    }
}

#[test]
fn points_in_a_plane_have_no_tetrahedra() {
    let mut kernel = Kernel::new();
    let equal = vec![[0.1, 0.2, 0.3]; 7];
    let line: Vec<Point> = (0..40).map(|t| [f64::from(t), f64::from(-2 * t), 5.0]).collect();
    let grid: Vec<Point> = (0..49).map(|i| [i % 7, i / 7, 3 * (i % 7) - i / 7].map(f64::from)).collect();
    let wall: Vec<Point> = (0..500).map(|i| [0.1, f64::from(i).sin(), f64::from(i * i).sin()]).collect();
    for flat in [vec![], equal, line, grid, wall] {
        let mesh = proved(&mut kernel, &flat);
        assert!(mesh.tetrahedra().is_empty() && mesh.hull_facets == 0);
        // One point off the plane sees all of them.
        let mut aside = flat.clone();
        aside.push([7.0, 1e-3, 100.0]);
        proved(&mut kernel, &aside);
    }
}

#[test]
fn zero_has_no_sign() {
    let points = [[0.0; 3], [-0.0; 3], [1.0, 0.0, -0.0], [1.0, -0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 1.0]];
    let mesh = proved(&mut Kernel::new(), &points);
    assert_eq!((mesh.tetrahedra().len(), mesh.duplicates.len()), (1, 2));
}

#[test]
fn coordinates_that_are_not_finite_are_refused() {
    let mut mesh = proved(&mut Kernel::new(), &clouds::of(&mut Random::new(1), Family::Cubic, 27));
    let before = tetrahedra(&mesh);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut points = vec![[0.0, 1.0, 2.0], [1.0, 0.0, 0.0], [0.5; 3], [5.0; 3]];
            points[2][axis] = bad;
            let error = Kernel::new().triangulate(Cow::Owned(points), &mut mesh).expect_err("not finite");
            assert!(error.to_string().contains("point 2"), "{error}");
            assert_eq!(tetrahedra(&mesh), before);
        }
    }
}

#[test]
fn a_kernel_is_clean_after_an_error_and_after_larger_input() {
    let (mut kernel, mut mesh) = (Kernel::new(), Tetrahedralization::default());
    let mut random = Random::new(4000);
    for count in [1000, 3, 0, 1, 500, 2, 5, 40] {
        let points = clouds::of(&mut random, Family::Uniform, count);
        kernel.triangulate(Cow::Borrowed(&[[f64::NAN; 3]]), &mut mesh).expect_err("not finite");
        kernel.triangulate(Cow::Borrowed(&points), &mut mesh).expect("finite points");
        let fresh = proved(&mut Kernel::new(), &points);
        let corners = |mesh: &Tetrahedralization| -> Vec<_> {
            mesh.tetrahedra()
                .iter()
                .map(|t| (t.vertices, [0, 1, 2, 3].map(|side| t.neighbour(side))))
                .collect()
        };
        assert_eq!(corners(&mesh), corners(&fresh));
        assert_eq!((mesh.hull_facets, &mesh.duplicates), (fresh.hull_facets, &fresh.duplicates));
    }
}
