//! Centroid triangulations.

use super::{delaunay, knots};
use spmesh_configurations::{CentroidMesh, Configurations, Knots, inverse_union_map, union_map};
use spmesh_reference::sets::Random;
use std::collections::{HashMap, HashSet};

fn meshes(knots: &Knots, all: &[Configurations]) -> Vec<CentroidMesh> {
    let lower = std::iter::once(None).chain(all.iter().map(Some));
    lower.zip(all).map(|(lower, upper)| CentroidMesh::of(knots, lower, upper).expect("degrees")).collect()
}

/// Twice the area of a triangle, times the square of the order, in integers.
fn area(points: &[[i64; 2]], mesh: &CentroidMesh, triangle: [u32; 3]) -> i64 {
    let sum = |vertex: u32| {
        mesh.set(vertex)
            .iter()
            .fold([0, 0], |[x, y], &id| [x + points[id as usize][0], y + points[id as usize][1]])
    };
    let [p, q, r] = triangle.map(sum);
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

/// Asserts a planar triangulation: triangles are positive; every edge has its opposite, except on one closed
/// convex border that goes around once; and the areas add up to the area within the border.
fn assert_planar(points: &[[i64; 2]], mesh: &CentroidMesh) {
    let mut edges: HashSet<[u32; 2]> = HashSet::new();
    let mut total = 0;
    for &[a, b, c] in &mesh.triangles {
        let area = area(points, mesh, [a, b, c]);
        assert!(area > 0, "order {}: flat or clockwise", mesh.order());
        total += area;
        assert!(
            [[a, b], [b, c], [c, a]].into_iter().all(|edge| edges.insert(edge)),
            "order {}",
            mesh.order()
        );
    }
    let open: HashMap<u32, u32> =
        edges.iter().filter(|&&[a, b]| !edges.contains(&[b, a])).map(|&[a, b]| (a, b)).collect();
    let first = *open.keys().min().expect("a border");
    let (mut at, mut length, mut around) = (first, 0, 0);
    loop {
        let next = open[&at];
        assert!(area(points, mesh, [at, next, open[&next]]) >= 0, "the border is convex");
        around += area(points, mesh, [first, at, next]);
        (at, length) = (next, length + 1);
        if at == first {
            break;
        }
    }
    assert_eq!(length, open.len(), "one cycle");
    assert_eq!(total, around);
    let vertices = mesh.vertices.len();
    assert_eq!(vertices + mesh.triangles.len() - (edges.len() + open.len()) / 2, 1, "Euler");
}

#[test]
fn they_are_planar_triangulations() {
    for seed in 0..4 {
        let mut random = Random::new(seed);
        let points: Vec<[i64; 2]> =
            (0..30).map(|_| [random.integer(0, 5000), random.integer(0, 5000)]).collect();
        let floats = spmesh_reference::sets::as_floats(&points);
        let all = delaunay(&floats, 5);
        for (order, mesh) in (1..).zip(meshes(&knots(&floats), &all)) {
            assert_eq!(mesh.order(), order);
            assert_eq!(mesh.from_upper, all[order - 1].len());
            assert_planar(&points, &mesh);
        }
    }
}

#[test]
fn vertices_and_triangles_are_images_of_the_union_map() {
    let points: Vec<[f64; 2]> =
        (0..16).map(|i| [f64::from(i % 4) + 0.1 * f64::from(i / 4), f64::from(i / 4)]).collect();
    let (knots, all) = (knots(&points), delaunay(&points, 2));
    let mesh = CentroidMesh::of(&knots, Some(&all[1]), &all[2]).expect("order 3");
    let mut found: HashSet<(Vec<u32>, Vec<u32>, usize)> = HashSet::new();
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        let sets = triangle.map(|vertex| mesh.set(vertex).to_vec());
        let source = inverse_union_map(&sets).expect("an image");
        assert_eq!(source.count, if number < mesh.from_upper { 1 } else { 2 });
        assert!(found.insert((source.boundary, source.interior, source.count)));
    }
    let sorted = |boundary: [u32; 3]| {
        let mut boundary = boundary.to_vec();
        boundary.sort_unstable();
        boundary
    };
    let upper = all[2].iter().map(|(boundary, interior)| (sorted(boundary), interior.to_vec(), 1));
    let lower = all[1].iter().map(|(boundary, interior)| (sorted(boundary), interior.to_vec(), 2));
    assert_eq!(found, upper.chain(lower).collect());
    let set = &union_map(&[3, 1, 2], &[0], 1)[0];
    assert_eq!(set, &[0, 1]);
}

#[test]
fn degrees_must_follow() {
    let points: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i % 3), f64::from(i / 3)]).collect();
    let (knots, all) = (knots(&points), delaunay(&points, 2));
    assert!(CentroidMesh::of(&knots, Some(&all[0]), &all[2]).is_err());
    assert!(CentroidMesh::of(&knots, None, &all[1]).is_err());
    assert!(CentroidMesh::of(&knots, Some(&all[0]), &all[0]).is_err());
}
