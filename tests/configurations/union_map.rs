//! The union map and its inverse.

use spmesh_configurations::{UnionSource, inverse_union_map, union_map};

#[test]
fn the_inverse_undoes_the_map() {
    for (boundary, interior) in
        [(vec![4, 7], vec![2]), (vec![1, 5, 9], vec![3, 8]), (vec![1, 2, 3, 4], vec![])]
    {
        for count in 1..boundary.len() {
            let sets = union_map(&boundary, &interior, count);
            let source = inverse_union_map(&sets);
            let expected = UnionSource { boundary: boundary.clone(), interior: interior.clone(), count };
            assert_eq!(source, Some(expected), "{sets:?}");
        }
    }
    assert_eq!(union_map(&[1, 2, 3, 4], &[9], 2).len(), 6);
    assert_eq!(union_map(&[3, 1, 2], &[0], 2), [[0, 1, 2], [0, 1, 3], [0, 2, 3]]);
    assert!(union_map(&[1, 2, 3], &[], 3).is_empty() && union_map(&[1, 2, 3], &[], 0).is_empty());
}

#[test]
fn what_is_no_image_has_no_source() {
    assert_eq!(inverse_union_map(&[]), None);
    assert_eq!(inverse_union_map(&[vec![1, 2]]), None, "one set");
    assert_eq!(inverse_union_map(&[vec![1, 2], vec![1, 3], vec![2, 4]]), None, "a set is missing");
    assert_eq!(inverse_union_map(&[vec![1, 2], vec![1, 3], vec![4]]), None, "sets of different sizes");
    assert_eq!(inverse_union_map(&[vec![1, 2], vec![1, 2]]), None, "a set twice");
}
