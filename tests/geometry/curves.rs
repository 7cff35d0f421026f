//! Keys of cells along curves.

use spmesh_delaunay::order::Curve;

const BITS: u32 = 3;

/// The cells of a cube along a curve.
fn cells(curve: Curve) -> Vec<[u32; 3]> {
    let mut cells: Vec<[u32; 3]> =
        (0..1 << (3 * BITS)).map(|number| [6, 3, 0].map(|shift| number >> shift & 7)).collect();
    cells.sort_unstable_by_key(|&cell| curve.key(cell, BITS));
    let keys = cells.iter().map(|&cell| curve.key(cell, BITS));
    assert!(keys.eq(0..1 << (3 * BITS)), "each place is taken once: {curve:?}");
    cells
}

#[test]
fn curves_are_what_their_names_say() {
    assert!(cells(Curve::RowMajor).is_sorted());
    let in_boxes = [[1, 1, 3], [1, 2, 0], [1, 1, 14], [4, 0, 0]];
    assert!(in_boxes.is_sorted_by_key(|&cell| Curve::RowMajor.key(cell, 5)));
    let morton = cells(Curve::Morton);
    assert_eq!(morton[..5], [[0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 1], [1, 0, 0]]);
    assert_eq!(morton[8 * 5], [2, 0, 2]);
    let one_bit =
        |pair: &[[u32; 3]]| (0..3).map(|axis| (pair[0][axis] ^ pair[1][axis]).count_ones()).sum::<u32>() == 1;
    assert!(cells(Curve::Gray).windows(2).all(one_bit));
    cells(Curve::Hilbert);
}

#[test]
fn keys_of_most_bits_fill_their_word() {
    for curve in [Curve::Morton, Curve::RowMajor] {
        assert_eq!(curve.key([65_535; 2], 16), u32::MAX);
        assert_eq!(curve.key([1023; 3], 10), (1 << 30) - 1);
    }
    assert_eq!(Curve::Gray.key([65_535, 0], 16), 0xcccc_cccc);
    assert_eq!(Curve::Gray.key([1023, 0, 0], 10), 0x38e3_8e38);
}
