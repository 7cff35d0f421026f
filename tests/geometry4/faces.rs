//! Faces of cells against those of known polytopes.

use spmesh_spacetime::diagram4::diagram;
use spmesh_spacetime::slices::Faces;

/// Numbers of faces of dimensions 3, 2 and 1 of the first cell.
fn count(points: Vec<[f64; 4]>) -> [usize; 3] {
    let (diagram, _) = diagram(points, None).unwrap();
    let cell = Faces::of_cell(&diagram.cells, 0);
    let facets: Vec<Faces> = (0..cell.lower.len()).map(|facet| cell.face(facet)).collect();
    let mut ridges = Vec::new();
    for facet in &facets {
        ridges.extend((0..facet.lower.len()).map(|ridge| facet.face(ridge)));
    }
    let mut edges: Vec<Vec<u32>> = ridges.iter().flat_map(|ridge| ridge.lower.clone()).collect();
    ridges.sort_by(|p, q| p.vertices.cmp(&q.vertices));
    ridges.dedup();
    edges.sort_unstable();
    edges.dedup();
    [facets.len(), ridges.len(), edges.len()]
}

#[test]
fn a_cube_has_its_faces() {
    let corner = |i: u32| std::array::from_fn(|axis| f64::from(i >> axis & 1));
    assert_eq!(count((0..16).map(corner).collect()), [8, 24, 32]);
}

#[test]
fn a_prism_of_triangles_has_its_faces() {
    // A triangle times a square: its facets are three boxes and four prisms.
    let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let triangle = [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
    let product = square.iter().flat_map(|&[x, y]| triangle.map(|[z, t]| [x, y, z, t]));
    // Ridges: a triangle per corner of the square, a square per corner of the triangle, products of
    // edges.
    assert_eq!(count(product.collect()), [7, 4 + 3 + 12, 24]);
}
