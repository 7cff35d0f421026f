//! The forms of predicates against determinants by cofactors.

use spmesh_delaunay::predicates::forms::{Form, Incircle, Insphere, Orient2d, Orient3d, lift};
use spmesh_reference::laplace::determinant;

#[test]
fn forms_are_determinants() {
    let plane = [[3, -5], [2, 8], [-7, 1]];
    let [a, b, _] = plane;
    assert_eq!(Orient2d::value(&[a, b], |_| 0), determinant([a, b]));
    let lifted = plane.map(|v| [v[0], v[1], lift(&v)]);
    assert_eq!(Incircle::value(&plane, |i| lifted[i][2]), determinant(lifted));
    let space = [[1, 2, -3], [0, 5, 1], [7, -1, 2], [-4, 3, 6]];
    let [a, b, c, _] = space;
    assert_eq!(Orient3d::value(&[a, b, c], |_| 0), determinant([a, b, c]));
    let lifted = space.map(|v| [v[0], v[1], v[2], lift(&v)]);
    // Inside is positive for a positive orientation; the lift in the last column gives the opposite.
    assert_eq!(Insphere::value(&space, |i| lifted[i][3]), -determinant(lifted));
}
