//! Parts of the floating-point program: spheres, stars, and what it gets wrong.

use spmesh_delaunay::delaunay3::{Tetrahedralization, triangulate};
use spmesh_delaunay::points::Point3;
use spmesh_molecules::float::check::{is_rounded, violations};
use spmesh_molecules::float::sphere::{Sphere, orientation};
use spmesh_molecules::float::star::{Edges, Shared};

#[test]
fn sides_meet_once() {
    let mut edges = Edges::default();
    for facets in [1, 4, 1000] {
        edges.clear(facets);
        for side in 0..3 * facets as u32 {
            assert_eq!(edges.enter(side, 7_000_000, side), Shared::WithNone);
        }
        edges.clear(facets);
        assert_eq!(edges.enter(1, 2, 10), Shared::WithNone);
        assert_eq!(edges.enter(2, 1, 11), Shared::With(10));
        assert_eq!(edges.enter(1, 2, 12), Shared::WithTwo);
    }
}

const CORNER: [Point3; 4] = [[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 3.0, 1.0], [1.0, 1.0, 3.0]];

#[test]
fn values_of_a_sphere() {
    let [o, a, b, c] = CORNER;
    let sphere = Sphere::through(o, a, b, c);
    assert_eq!(sphere.volume, orientation(o, a, b, c));
    assert_eq!(sphere.volume, 8.0);
    assert!(CORNER.iter().all(|&p| sphere.value(o, p) == 0.0));
    assert_eq!(sphere.value(o, [3.0, 3.0, 3.0]), 0.0);
    assert!(sphere.value(o, [2.0, 2.0, 2.0]) > 0.0);
    assert!(sphere.value(o, [0.0, 0.0, 0.0]) < 0.0);
}

#[test]
fn values_of_a_half_space() {
    let [o, a, b, c] = CORNER;
    let half_space = Sphere::beyond(o, a, b);
    assert!(half_space.value(o, c) > 0.0);
    assert_eq!(half_space.value(o, [7.0, 5.0, 1.0]), 0.0);
    assert!(half_space.value(o, [1.0, 1.0, 0.0]) < 0.0);
}

#[test]
fn values_of_small_integers_are_not_rounded_and_those_of_great_ones_are() {
    let tetrahedron = [[0.0, 0.0, 0.0], [7.0, 1.0, 0.0], [3.0, 5.0, 1.0], [1.0, 2.0, 9.0]];
    for (scale, expected) in [(1.0, false), (100.0, false), (65_537.0, true)] {
        let [o, a, b, c] = tetrahedron.map(|p| p.map(|x: f64| x * scale));
        let p = [scale * 5.0, scale * 3.0 + 1.0, scale * 2.0 - 1.0];
        let value = Sphere::through(o, a, b, c).value(o, p);
        assert_eq!(is_rounded([o, a, b, c], p, value), expected, "{scale}");
    }
    let [o, a, b, c] = tetrahedron.map(|p| p.map(|x: f64| x * 0.5));
    assert!(!is_rounded([o, a, b, c], [1.0; 3], 1e300), "unknown for coordinates that are not integers");
}

#[test]
fn what_is_not_delaunay_is_counted() {
    let mut points =
        vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [9.0, 9.0, 9.0]];
    assert_eq!(violations(&triangulate(&points).unwrap()), 0);
    points.extend((0..50).map(|i| [f64::from(i % 7), f64::from(i * i % 11), f64::from(i * 5 % 13) + 0.5]));
    let mesh = triangulate(&points).unwrap();
    assert_eq!(violations(&mesh), 0);
    // A vertex that moves across its neighbours turns some of them over.
    let mut vertices = mesh.vertices().to_vec();
    vertices[5].at = vertices[5].at.map(|x| 12.0 - x);
    let moved = Tetrahedralization::from_parts(vertices, Vec::new(), mesh.tetrahedra().to_vec());
    assert!(violations(&moved) > 0);
}
