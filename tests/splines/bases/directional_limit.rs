//! The side of a line for points on the line.

use spmesh_delaunay::predicates::Sign;
use spmesh_splines::bases::DirectionalLimit;

#[test]
fn points_on_a_line_are_on_the_side_that_they_are_approached_from() {
    let side = |x, from| DirectionalLimit::new(x, from).side([0.0, 0.0], [2.0, 0.0]);
    assert_eq!(side([1.0, 0.5], [1.0, -9.0]), Sign::Positive);
    assert_eq!(side([1.0, 0.0], [7.0, 1e-300]), Sign::Positive);
    assert_eq!(side([1.0, 0.0], [7.0, -1e-300]), Sign::Negative);
    assert_eq!(side([1.0, 0.0], [7.0, 0.0]), Sign::Positive, "along the line, and left of the way");
    assert_eq!(side([1.0, 0.0], [-7.0, 0.0]), Sign::Negative);
    assert_eq!(side([1.0, 0.0], [1.0, 0.0]), Sign::Positive);
    let upright = |x, from| DirectionalLimit::new(x, from).side([0.0, 0.0], [0.0, 2.0]);
    assert_eq!(upright([0.0, 1.0], [0.0, 1.0]), Sign::Negative);
    assert_eq!(upright([0.0, 1.0], [0.0, 5.0]), Sign::Positive);
    assert_eq!(DirectionalLimit::new([0.0, 0.0], [1.0, 0.0]).side([3.0, 3.0], [3.0, 3.0]), Sign::Zero);
}
