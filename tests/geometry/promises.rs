//! What public types promise to programs of any kind.

use spmesh_delaunay::constrained2::ConstrainedTriangulation;
use spmesh_delaunay::delaunay2::{Kernel, Triangles, Triangulation, triangulate};
use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_delaunay::points::points;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, FiniteFloatPredicates3, Sign};
use spmesh_delaunay::{Error, Location};

#[test]
fn results_can_be_sent_copied_and_printed() {
    fn is_shared<T: Send + Sync + std::fmt::Debug>() {}
    fn is_plain<T: Send + Sync + std::fmt::Debug + Clone>() {}
    is_shared::<Kernel>();
    is_shared::<spmesh_delaunay::delaunay3::Kernel>();
    is_plain::<Triangles>();
    is_plain::<Triangulation>();
    is_plain::<Tetrahedralization>();
    is_plain::<ConstrainedTriangulation>();
    is_plain::<FiniteFloatPredicates>();
    is_plain::<FiniteFloatPredicates3>();
    is_plain::<Location>();
    is_plain::<Sign>();
    is_plain::<Error>();
}

/// The memory of the triangles is aligned by hand, so it is not copied as a vector of words is.
#[test]
fn copies_change_by_themselves() {
    for count in 3..40 {
        let mesh = triangulate(&points((0..count).map(|i| [i, i * i % 11]))).unwrap();
        let before: Vec<[u32; 3]> = mesh.simplices().collect();
        let copies: Vec<Triangulation> = (0..4).map(|_| mesh.clone()).collect();
        for mut copy in copies {
            assert!(copy.simplices().eq(before.iter().copied()));
            copy.insert([-0.5, 20.25]).unwrap();
            assert!(copy.simplices().count() > before.len() && mesh.simplices().eq(before.iter().copied()));
        }
    }
}

#[test]
fn coordinates_of_other_types_are_exact() {
    let singles = vec![[0.1_f32, 3.0]];
    assert_eq!(points(&singles), points(singles.iter().map(|point| point.map(f64::from))));
    assert_eq!(points([[u32::MAX, 0, 7]]), [[4_294_967_295.0, 0.0, 7.0]]);
    assert_eq!(points([[0.1_f64; 2]]), [[0.1; 2]]);
}
