//! The orientation of five points, and the sort of short lists.

use spmesh_base::random::Random;
use spmesh_delaunay::predicates::Sign;
use spmesh_spacetime::diagram4::{orient4d, sort_distinct};
use spmesh_stream::model::cells4::Point4;

#[test]
fn signs_are_those_of_the_determinant() {
    let unit = |axis: usize, x: f64| -> Point4 { std::array::from_fn(|i| if i == axis { x } else { 0.0 }) };
    let simplex = [[0.0; 4], unit(0, 1.0), unit(1, 1.0), unit(2, 1.0), unit(3, 1.0)];
    assert_eq!(orient4d(simplex), Sign::Positive);
    let [a, b, c, d, e] = simplex;
    assert_eq!(orient4d([a, c, b, d, e]), Sign::Negative);
    for x in [1e-300, 1e-80, 1e-5, 0.1, 1e80, 1e300] {
        assert_eq!(orient4d(simplex.map(|p| p.map(|y| y * x))), Sign::Positive, "{x}");
        assert_eq!(orient4d([a, b, c, d, [x, x, x, 0.0]]), Sign::Zero, "{x}");
        assert_eq!(orient4d([a, b, c, d, [x, x, x, -5e-324]]), Sign::Negative, "{x}");
    }
}

#[test]
fn nearly_flat_simplices_are_not_flat() {
    let third = 1.0 / 3.0;
    let row = |x: f64| [x, x * third, x * 7.0, x * 0.1];
    // All on a line but for one rounding.
    let bent = [row(1.0), row(2.0), row(4.0), row(8.0), [16.0, 16.0 * third, 112.0, 1.6]];
    assert_eq!(orient4d(bent), Sign::Zero);
    let mut flat =
        [[0.1, 0.2, 0.3, 0.4], [1.1, 0.2, 0.3, 0.4], [0.1, 1.2, 0.3, 0.4], [0.1, 0.2, 1.3, 0.4], [0.7; 4]];
    flat[4][3] = 0.4;
    assert_eq!(orient4d(flat), Sign::Zero);
    flat[4][3] = 0.4f64.next_up();
    assert_eq!(orient4d(flat), Sign::Positive);
}

#[test]
fn lists_of_all_lengths_are_sorted() {
    let mut random = Random::new(1);
    for length in 0..40 {
        for _ in 0..20 {
            let mut numbers: Vec<u32> =
                (0..length).map(|i| i * 50_000_000 + random.below(1 << 20) as u32).collect();
            let expected = numbers.clone();
            random.shuffle(&mut numbers);
            sort_distinct(&mut numbers);
            assert_eq!(numbers, expected);
        }
    }
}
