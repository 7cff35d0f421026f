//! The 2D kernel against independent triangulations, and its output against its own promises.

use spmesh_delaunay::Result;
use spmesh_delaunay::delaunay2::{Corner, Kernel, NONE, Triangles, distinct};
use spmesh_reference::sets::{self, Random};
use spmesh_reference::{as_set, exhaustive, incremental};
use std::collections::HashSet;

/// What a new kernel makes of points.
pub(super) fn triangulate(points: &[[f64; 2]]) -> Result<Triangles> {
    let mut mesh = Triangles::default();
    Kernel::new().triangulate(points, &mut mesh)?;
    Ok(mesh)
}

fn triangles(mesh: &Triangles) -> impl Iterator<Item = [u32; 3]> + '_ {
    mesh.triangles().iter().map(|triangle| triangle.vertices)
}

/// Checks every promise of [`Triangles`] except the Delaunay property; returns the set of triangles.
pub(super) fn checked(points: &[[f64; 2]], mesh: &Triangles) -> Vec<[u32; 3]> {
    let dropped: HashSet<u32> = mesh.duplicates.iter().map(|pair| pair[0]).collect();
    let vertices = points.len() - dropped.len();
    for &[duplicate, vertex] in &mesh.duplicates {
        assert_eq!(points[duplicate as usize], points[vertex as usize]);
        assert!(vertex < duplicate && !dropped.contains(&vertex));
    }
    assert_eq!(mesh.triangle_of_vertex.len(), points.len());
    if mesh.triangles().is_empty() {
        assert_eq!(mesh.hull.len(), vertices);
        assert!(mesh.triangle_of_vertex.iter().all(|&t| t == NONE));
    } else {
        assert_eq!(mesh.triangles().len(), 2 * vertices - 2 - mesh.hull.len(), "Euler relation");
    }
    let mut hull_edges = HashSet::new();
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (triangle.vertices[(i + 1) % 3], triangle.vertices[(i + 2) % 3]);
            assert_eq!(mesh.left_of(a, b), Some(Corner { triangle: t as u32, corner: i as u32 }));
            assert_eq!(mesh.left_of(b, a), triangle.neighbour(i));
            if triangle.neighbour(i).is_none() {
                assert!(hull_edges.insert((a, b)));
            }
        }
    }
    if !mesh.triangles().is_empty() {
        let cycle = mesh.hull.iter().zip(mesh.hull.iter().cycle().skip(1));
        assert_eq!(cycle.map(|(&a, &b)| (a, b)).collect::<HashSet<_>>(), hull_edges);
        let corners: usize = (0..points.len() as u32).map(|v| mesh.corners_of(v).count()).sum();
        assert_eq!(corners, 3 * mesh.triangles().len());
    }
    as_set(triangles(mesh))
}

/// Triangulates, checks, and compares with `expected`.
fn assert_triangles(kernel: &mut Kernel, points: &[[f64; 2]], expected: &[[u32; 3]]) {
    let mut mesh = Triangles::default();
    kernel.triangulate(points, &mut mesh).expect("finite points");
    assert_eq!(checked(points, &mesh), expected, "let points = vec!{points:?};");
}

#[test]
fn every_subset_of_a_small_lattice() {
    let mut kernel = Kernel::new();
    for (width, height) in [(3, 3), (4, 3), (3, 4)] {
        for subset in 0u32..1 << (width * height) {
            let members = (0..width * height).filter(|i| subset >> i & 1 == 1);
            let points: Vec<[i64; 2]> = members.map(|i| [i % width, i / width]).collect();
            let floats = sets::as_floats(&points);
            let expected = if width * height < 10 {
                exhaustive::triangles(&floats)
            } else {
                incremental::triangles(&points)
            };
            assert_triangles(&mut kernel, &floats, &expected);
        }
    }
}

#[test]
fn every_sequence_of_up_to_five_points_of_a_tiny_lattice() {
    let mut kernel = Kernel::new();
    for length in 0..=5 {
        for sequence in 0..9usize.pow(length) {
            let places = (0..length).map(|k| sequence / 9usize.pow(k) % 9);
            let points: Vec<[f64; 2]> = places.map(|i| [(i % 3) as f64, (i / 3) as f64]).collect();
            let mut mesh = Triangles::default();
            kernel.triangulate(&points, &mut mesh).expect("finite points");
            checked(&points, &mesh);
            let representatives = distinct(&points);
            for (i, p) in points.iter().enumerate() {
                let first = points.iter().position(|q| q == p).expect("itself") as u32;
                assert_eq!(representatives[i], first);
                let listed = mesh.duplicates.iter().find(|pair| pair[0] == i as u32).map(|pair| pair[1]);
                assert_eq!(listed.unwrap_or(i as u32), first);
            }
        }
    }
}

#[test]
fn a_hundred_random_sets() {
    let mut kernel = Kernel::new();
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let count = if seed % 50 == 49 { 5000 } else { random.integer(3, 600) as usize };
        let side = [100, 5234, 29_609, 1_000_000, (1 << 30) - 1][seed as usize % 5];
        let points = sets::uniform(&mut random, count, side);
        assert_triangles(&mut kernel, &sets::as_floats(&points), &incremental::triangles(&points));
    }
}

#[test]
fn a_hundred_degenerate_sets() {
    let mut kernel = Kernel::new();
    for seed in 0..100 {
        let mut random = Random::new(1000 + seed as u64);
        let count = if seed / 10 == 9 { 3000 } else { random.integer(3, 500) as usize };
        let points = sets::degenerate(&mut random, seed % sets::DEGENERATE_FAMILIES, count);
        assert_triangles(&mut kernel, &sets::as_floats(&points), &incremental::triangles(&points));
    }
}

#[test]
fn huge_and_tiny_coordinates() {
    let mut kernel = Kernel::new();
    let scales = [5e-324, 1e-310, 1e-160, 1e-60, 1e-3, 1e60, 1e154, 1e300, 4e307];
    for (seed, &scale) in (0..).zip(scales.iter().cycle().take(36)) {
        let mut random = Random::new(2000 + seed);
        let count = random.integer(3, 24) as usize;
        let lattice = seed % 2 == 0;
        let points: Vec<[i64; 2]> = match lattice {
            true => sets::uniform(&mut random, count, 4),
            false => sets::uniform(&mut random, count, 1 << 40),
        };
        let unit = if lattice { 1.0 } else { (1u64 << 38) as f64 };
        let points: Vec<[f64; 2]> =
            points.iter().map(|p| p.map(|c| (c as f64 / unit - 2.0) * scale)).collect();
        let kept = first_of_each(&points);
        let expected = exhaustive::triangles(&kept);
        assert_triangles(&mut kernel, &kept, &expected);
    }
}

/// The points without later duplicates.
fn first_of_each(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let representatives = distinct(points);
    (0..).zip(points).filter(|&(i, _)| representatives[i as usize] == i).map(|(_, &point)| point).collect()
}

#[test]
fn magnitudes_mixed_in_one_set() {
    for seed in 0..20 {
        let mut random = Random::new(3000 + seed);
        let points: Vec<[f64; 2]> = (0..random.integer(3, 24))
            .map(|_| [0, 1].map(|_| (random.unit() - 0.5) * 10f64.powi(random.integer(-323, 308) as i32)))
            .collect();
        let mesh = triangulate(&points).expect("finite points");
        assert!(mesh.duplicates.is_empty());
        assert_eq!(checked(&points, &mesh), exhaustive::triangles(&points), "let points = vec!{points:?};");
    }
}

#[test]
fn decimal_grids_are_nearly_cocircular() {
    let mut kernel = Kernel::new();
    for (step, width) in [(0.1, 4), (0.01, 5), (0.3, 6), (1e-7, 5)] {
        let shift = [431_234.7, 5_412_345.1].map(|offset| if width == 5 { offset } else { 0.0 });
        let points: Vec<[f64; 2]> = (0..30)
            .map(|i| [f64::from(i % width) * step + shift[0], f64::from(i / width) * step + shift[1]])
            .collect();
        let kept = first_of_each(&points);
        assert_triangles(&mut kernel, &kept, &exhaustive::triangles(&kept));
    }
}

#[test]
fn outliers_that_leave_the_rest_one_cell_of_the_curve() {
    let mut kernel = Kernel::new();
    for (seed, outlier) in [(0, 1e20), (1, 1e200), (2, f64::MAX), (3, -f64::MAX)] {
        let mut random = Random::new(9000 + seed);
        let mut points = sets::as_floats(&sets::uniform(&mut random, 26, 6));
        points.push([outlier, 1.0]);
        points.push([2.0, -outlier]);
        assert_triangles(&mut kernel, &points, &exhaustive::triangles(&points));
    }
}

#[test]
fn many_points_in_a_tiny_extent_and_too_many() {
    let integers = sets::uniform(&mut Random::new(77), 20_000, 1 << 20);
    let tiny = 2f64.powi(-520).powi(2);
    let mut points: Vec<[f64; 2]> = integers.iter().map(|p| p.map(|c| c as f64 * tiny)).collect();
    let mut kernel = Kernel::new();
    let mut mesh = Triangles::default();
    kernel.triangulate(&points, &mut mesh).expect("finite points");
    let scaled = checked(&points, &mesh);
    assert_eq!(scaled, as_set(triangles(&triangulate(&sets::as_floats(&integers)).expect("finite points"))));
    points.push([1.0, 1.0]);
    kernel.triangulate(&points, &mut mesh).expect("finite points");
    checked(&points, &mesh);

    // The memory is never touched: the kernel refuses the number of points alone.
    let too_many = vec![[0.0; 2]; spmesh_delaunay::delaunay2::MAX_POINTS + 1];
    let error = kernel.triangulate(&too_many, &mut Triangles::default()).expect_err("too many");
    assert!(error.to_string().contains("at most"), "{error}");
}

#[test]
fn order_of_input_does_not_matter() {
    let mut kernel = Kernel::new();
    for seed in 0..30 {
        let mut random = Random::new(4000 + seed);
        let points = match seed % 3 {
            0 => sets::uniform(&mut random, 2000, 50),
            _ => sets::degenerate(&mut random, seed as usize % sets::DEGENERATE_FAMILIES, 1500),
        };
        let floats = sets::as_floats(&points);
        let mesh = triangulate(&floats).expect("finite points");
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        random.shuffle(&mut order);
        let shuffled: Vec<[f64; 2]> = order.iter().map(|&i| floats[i as usize]).collect();
        let mut again = Triangles::default();
        kernel.triangulate(&shuffled, &mut again).expect("finite points");
        let renamed = triangles(&again).map(|t| t.map(|v| order[v as usize]));
        assert!(triangles(&mesh).eq(renamed), "the very same triangles in the same order, seed {seed}");
        let neighbours = |mesh: &Triangles| -> Vec<_> {
            mesh.triangles().iter().map(|t| [0, 1, 2].map(|side| t.neighbour(side))).collect()
        };
        assert_eq!(neighbours(&mesh), neighbours(&again));
    }
}

#[test]
fn quarter_turns_keep_the_triangles_of_points_in_general_position() {
    let mut random = Random::new(5000);
    let points: Vec<[f64; 2]> = (0..3000).map(|_| [random.unit(), random.unit() * 0.01]).collect();
    let expected = as_set(triangles(&triangulate(&points).expect("finite points")));
    let turned: Vec<[f64; 2]> = points.iter().map(|p| [-p[1], p[0]]).collect();
    assert_eq!(checked(&turned, &triangulate(&turned).expect("finite points")), expected);
}

#[test]
fn spade_agrees_in_general_position() {
    use spade::Triangulation as _;
    for (seed, count) in [(6000, 10), (6001, 1000), (6002, 20_000)] {
        let mut random = Random::new(seed);
        let points: Vec<[f64; 2]> = (0..count).map(|_| [random.unit(), random.unit()]).collect();
        let vertices = points.iter().map(|p| spade::Point2::new(p[0], p[1])).collect();
        let peer =
            spade::DelaunayTriangulation::<spade::Point2<f64>>::bulk_load_stable(vertices).expect("valid");
        let peer = as_set(peer.inner_faces().map(|f| f.vertices().map(|v| v.index() as u32)));
        assert_eq!(checked(&points, &triangulate(&points).expect("finite points")), peer);
    }
}

#[test]
fn duplicates_are_one_vertex() {
    let mut random = Random::new(7000);
    let points: Vec<[f64; 2]> = (0..4000)
        .map(|_| [random.integer(-20, 20) as f64 * 0.5, random.integer(-20, 20) as f64 * 0.5])
        .collect();
    let mesh = triangulate(&points).expect("finite points");
    checked(&points, &mesh);
    let different: HashSet<[u64; 2]> = points.iter().map(|p| p.map(|c| (c + 0.0).to_bits())).collect();
    assert_eq!(points.len() - mesh.duplicates.len(), different.len());
    assert!(triangulate(&[[0.0, -0.0], [-0.0, 0.0]]).expect("finite points").duplicates == [[1, 0]]);
}

#[test]
fn coordinates_that_are_not_finite_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for point in [[bad, 0.0], [0.0, bad]] {
            let error = triangulate(&[[0.0, 1.0], [2.0, 3.0], point]).expect_err("not finite");
            assert!(error.to_string().contains("point 2"), "{error}");
        }
    }
}

#[test]
fn a_kernel_is_clean_after_an_error_and_after_larger_input() {
    let mut kernel = Kernel::new();
    let mut random = Random::new(8000);
    let mut mesh = Triangles::default();
    for count in [1000, 3, 0, 1, 500, 2] {
        let points = sets::as_floats(&sets::uniform(&mut random, count, 1 << 20));
        kernel.triangulate(&[[f64::NAN; 2]], &mut mesh).expect_err("not finite");
        kernel.triangulate(&points, &mut mesh).expect("finite points");
        let fresh = triangulate(&points).expect("finite points");
        assert!(triangles(&mesh).eq(triangles(&fresh)));
        assert_eq!((&mesh.hull, &mesh.triangle_of_vertex), (&fresh.hull, &fresh.triangle_of_vertex));
        assert_eq!(checked(&points, &mesh), checked(&points, &fresh));
    }
}
