//! Lists by cells, facets of tetrahedra, groups of numbers, and areas.

use spmesh_delaunay::cell_lists::CellLists;
use spmesh_delaunay::order::sizes_to_starts;
use spmesh_delaunay::predicates::area;
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;

#[test]
fn lists_are_in_order() {
    let of = |most| {
        CellLists::of(4, 10, most, |number, visit| {
            (0..4).filter(|cell| number % (cell + 2) == 0).for_each(|cell| visit(cell as usize));
        })
    };
    let mut lists = of(14).expect("14 entries");
    let expected: [&[u32]; 4] = [&[0, 2, 4, 6, 8], &[0, 3, 6, 9], &[0, 4, 8], &[0, 5]];
    assert_eq!([0, 1, 2, 3].map(|cell| lists.get(cell)), expected);
    lists.get_mut(1).reverse();
    assert_eq!(lists.get(1), [9, 6, 3, 0]);
    assert!(of(13).is_none());
}

#[test]
fn facets_face_outwards() {
    let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    for (opposite, facet) in TETRAHEDRON_FACETS.into_iter().enumerate() {
        let [p, q, r] = facet.map(|corner| [0, 1, 2].map(|i| corners[corner][i] - corners[opposite][i]));
        let minor = |i: usize, j: usize| q[i] * r[j] - q[j] * r[i];
        assert_eq!(p[0] * minor(1, 2) + p[1] * minor(2, 0) + p[2] * minor(0, 1), 1, "facet {opposite}");
    }
}

#[test]
fn groups_start_where_the_ones_before_end() {
    let mut groups = [3u32, 0, 2, 1];
    sizes_to_starts(&mut groups);
    assert_eq!(groups, [0, 3, 3, 5]);
}

#[test]
fn flat_triangles_have_accurate_areas() {
    // (0, 0), (1 + u, 1) and (2, 2 - u), u = 2^-52: twice the area is (1 + u) (2 - u) - 2 = u - u^2.
    let u = f64::EPSILON;
    let expected = 0.5 * (u - u * u);
    assert_eq!(area([0.0, 0.0], [1.0 + u, 1.0], [2.0, 2.0 - u]), expected);
    assert_eq!(area([1.0 + u, 1.0], [0.0, 0.0], [2.0, 2.0 - u]), -expected);
    assert_eq!(area([0.1, 0.1], [0.3, 0.3], [0.7, 0.7]), 0.0);
    assert_eq!(area([0.0, 0.0], [4.0, 0.0], [0.0, 3.0]), 6.0);
}
