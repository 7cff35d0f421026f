//! Counts the tetrahedra that rounding made wrong.

use super::check::orient3d;
use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_delaunay::predicates::{FiniteFloatPredicates3, Predicates3, Sign};

/// The number of tetrahedra that are inverted or flat, or have a vertex of a neighbour inside of their
/// sphere, by exact arithmetic. Spheres of flat tetrahedra have no inside.
///
/// Cost: five exact signs per tetrahedron.
pub fn violations(mesh: &Tetrahedralization) -> u64 {
    let is_wrong = |number: &usize| is_inverted_or_flat(mesh, *number) || has_neighbour_inside(mesh, *number);
    (0..mesh.tetrahedra().len()).filter(is_wrong).count() as u64
}

fn is_inverted_or_flat(mesh: &Tetrahedralization, number: usize) -> bool {
    let [a, b, c, d] = mesh.tetrahedra()[number].vertices.map(|v| mesh.vertices()[v as usize].at);
    orient3d(a, b, c, d) != Sign::Positive
}

/// For a positive tetrahedron.
fn has_neighbour_inside(mesh: &Tetrahedralization, number: usize) -> bool {
    let tetrahedron = &mesh.tetrahedra()[number];
    let point = |v: u32| mesh.vertices()[v as usize].at;
    let [a, b, c, d] = tetrahedron.vertices.map(point);
    (0..4).filter_map(|side| tetrahedron.neighbour(side)).any(|beyond| {
        let apex = mesh.tetrahedra()[beyond.tetrahedron as usize].vertices[beyond.corner as usize];
        FiniteFloatPredicates3::default().insphere(a, b, c, d, point(apex)) == Sign::Positive
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_delaunay::delaunay3::triangulate;

    #[test]
    fn what_is_not_delaunay_is_counted() {
        let mut points =
            vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [9.0, 9.0, 9.0]];
        assert_eq!(violations(&triangulate(&points).unwrap()), 0);
        points
            .extend((0..50).map(|i| [f64::from(i % 7), f64::from(i * i % 11), f64::from(i * 5 % 13) + 0.5]));
        let mesh = triangulate(&points).unwrap();
        assert_eq!(violations(&mesh), 0);
        // A vertex that moves across its neighbours turns some of them over.
        let mut vertices = mesh.vertices().to_vec();
        vertices[5].at = vertices[5].at.map(|x| 12.0 - x);
        let moved = Tetrahedralization::from_parts(vertices, Vec::new(), mesh.tetrahedra().to_vec());
        assert!(violations(&moved) > 0);
    }
}
