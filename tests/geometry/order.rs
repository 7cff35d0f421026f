//! Orders of points along curves, and insertion sequences.

use spmesh_delaunay::order::{BIT_LEVEL_MAX, BitLevels, Curve, Sequence, SpatialOrder, Suffixes};
use spmesh_delaunay::predicates::Extent;
use spmesh_reference::sets::Random;
use std::collections::HashMap;

fn order<const D: usize>(points: &[[f64; D]], curve: Curve) -> Vec<u32> {
    SpatialOrder::default().sort(points, &Extent::of(points), curve).collect()
}

/// Checks the promises of every order.
fn check<const D: usize>(points: &[[f64; D]], curve: Curve) {
    let indices = order(points, curve);
    let mut sorted = indices.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..points.len() as u32), "a permutation");
    let mut last_of = HashMap::new();
    for (place, &index) in indices.iter().enumerate() {
        let point = points[index as usize].map(|c| (c + 0.0).to_bits());
        if let Some((last, before)) = last_of.insert(point, (place, index)) {
            assert!(last + 1 == place && before < index, "equal points are neighbours, in order: {curve:?}");
        }
    }
}

fn check_all<const D: usize>(points: &[[f64; D]]) {
    Curve::ALL.into_iter().for_each(|curve| check(points, curve));
}

fn uniform<const D: usize>(count: usize) -> Vec<[f64; D]> {
    let mut random = Random::new(1);
    (0..count).map(|_| [(); D].map(|()| random.unit())).collect()
}

fn clusters<const D: usize>() -> Vec<[f64; D]> {
    let cluster = |(i, point): (usize, [f64; D])| {
        let size = 1e-5f64.powi(i as i32 % 40);
        // Every seventh point has copies.
        let point = if i % 7 == 0 { [0.25; D] } else { point };
        point.map(|c| c * size)
    };
    uniform(30_000).into_iter().enumerate().map(cluster).collect()
}

#[test]
fn clusters_within_clusters() {
    check_all(&clusters::<2>());
    check_all(&clusters::<3>());
}

const SIZES: [f64; 8] = [5e-324, 1e-320, 1e-307, 1e-300, 1e-150, 1.0, 1e150, f64::MAX];

#[test]
fn many_points_of_the_plane_in_extents_of_every_size() {
    for size in SIZES {
        let mut points: Vec<[f64; 2]> =
            uniform(50_000).iter().map(|[x, y]| [(2.0 * x - 1.0) * size, y * size]).collect();
        check(&points, Curve::Hilbert);
        points.push([1.0, -1.0]);
        check(&points, Curve::Hilbert);
        points.iter_mut().for_each(|p| p[1] = 1e300);
        check(&points, Curve::Hilbert);
    }
}

#[test]
fn many_points_of_space_in_extents_of_every_size() {
    for size in SIZES {
        let mut points: Vec<[f64; 3]> =
            uniform(10_000).iter().map(|[x, y, z]| [(2.0 * x - 1.0) * size, y * size, -z * size]).collect();
        check_all(&points);
        points.push([1.0, -1.0, 1.0]);
        check_all(&points);
        points.iter_mut().for_each(|p| p[1] = 1e300);
        check_all(&points);
        points.iter_mut().for_each(|p| p[2] = -1e300);
        check_all(&points);
        points.iter_mut().for_each(|p| p[0] = -0.0);
        check_all(&points);
    }
    check_all::<3>(&[]);
    check_all(&[[0.0, -0.0, 1.0], [-0.0, 0.0, 1.0], [f64::MAX, f64::MIN, 0.0]]);
}

#[test]
fn flat_and_thin_sets_are_as_coherent_as_others() {
    // The mean distance of neighbours in the order is at most `distances` times the spacing of a lattice of
    // as many points along `axes` axes. On a line the bound is larger, because the curve of space does not
    // run straight along it.
    for (sides, axes, distances) in [
        ([1e3, 1e3, 1e3], 3, 1.3),
        ([1e3, 1e3, 1.0], 2, 1.3),
        ([1e3, 0.0, 1e3], 2, 1.3),
        ([1e-3, 1e3, 1e-9], 1, 8.0),
    ] {
        let points: Vec<[f64; 3]> =
            uniform(100_000).iter().map(|p: &[f64; 3]| [0, 1, 2].map(|axis| p[axis] * sides[axis])).collect();
        let indices = order(&points, Curve::Hilbert);
        let distance = |pair: &[u32]| {
            let [p, q] = [pair[0], pair[1]].map(|index| points[index as usize]);
            (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt()
        };
        let mean = indices.windows(2).map(distance).sum::<f64>() / indices.len() as f64;
        let lattice = 1e3 / 100_000f64.powf(1.0 / f64::from(axes));
        assert!(mean < distances * lattice, "{sides:?}: {mean} for {lattice}");
    }
}

#[test]
fn one_order_after_another_in_the_same_buffers() {
    let mut again = SpatialOrder::default();
    for count in [5000, 10, 0, 3000] {
        let (plane, space) = (uniform::<2>(count), uniform::<3>(count));
        let indices: Vec<u32> = again.sort(&plane, &Extent::of(&plane), Curve::Gray).collect();
        assert_eq!(indices, order(&plane, Curve::Gray));
        let indices: Vec<u32> = again.sort(&space, &Extent::of(&space), Curve::Hilbert).collect();
        assert_eq!(indices, order(&space, Curve::Hilbert));
    }
}

#[test]
fn sequences_visit_every_place_once() {
    for sequence in [Sequence::Rounds, Sequence::Pass, Sequence::Random { seed: 7 }] {
        for count in [0, 1, 2, 63, 513, 5000] {
            let points = uniform::<3>(count);
            for insertions in [sequence.of(count), sequence.by_levels(&points, Suffixes::MostCommon)] {
                assert_eq!(insertions.len(), count);
                let mut numbers: Vec<u32> = insertions.collect();
                numbers.sort_unstable();
                assert!(numbers.into_iter().eq(0..count as u32), "{sequence:?} of {count}");
            }
        }
    }
    assert!(Sequence::Pass.of(100).eq(0..100));
}

#[test]
fn random_sequences_follow_from_their_seed_and_are_spread_evenly() {
    let random = |seed| Sequence::Random { seed }.of(1000);
    assert!(random(3).eq(random(3)));
    assert!(!random(3).eq(random(4)));
    let mut first = [0; 6];
    for seed in 0..6000 {
        let numbers: Vec<u32> = Sequence::Random { seed }.of(3).collect();
        first[[[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]
            .iter()
            .position(|permutation| numbers == permutation)
            .expect("a permutation")] += 1;
    }
    assert!(first.iter().all(|&count: &i32| (count - 1000).abs() < 150), "{first:?}");
}

fn levels<const D: usize>(points: &[[f64; D]], suffixes: Suffixes) -> Vec<u32> {
    let bit_levels = BitLevels::of(points, suffixes);
    points.iter().map(|&point| bit_levels.level(point)).collect()
}

#[test]
fn levels_by_zeros_are_counts_of_trailing_zeros() {
    let points = [[1.0, 0.0, 0.0], [2.0, -4.0, 8.0], [4.0, 12.0, -4.0], [0.0; 3], [512.0, -256.0, 1024.0]];
    let expected = [0, 1, 2, BIT_LEVEL_MAX, BIT_LEVEL_MAX];
    assert_eq!(levels(&points, Suffixes::Zeros), expected);
    // The unit is a power of two that divides all coordinates; it may be large, small, or the least f64.
    for unit in [2f64.powi(900), 0.125, 2f64.powi(-1022), 5e-324] {
        assert_eq!(levels(&points.map(|p| p.map(|c| c * unit)), Suffixes::Zeros), expected, "{unit:e}");
    }
}

#[test]
fn levels_by_the_most_common_suffix() {
    let points = [[5.0, -2.0], [13.0, 6.0], [9.0, -6.0], [3.0, 2.0], [4.0, 2.0], [5.0, 1.0]];
    // x: 5 of 6 end with 1, 4 of those with 01, 3 of those with 101. y: 5 end with 0, all of them with 10; -2
    // and 6 end with 110, but -6 and 2 (twice) with 010.
    assert_eq!(levels(&points, Suffixes::MostCommon), [2, 2, 2, 1, 0, 0]);
    // Numbers can have their last bits in common without ending in zeros.
    let uniform: Vec<[f64; 2]> =
        uniform(1000).iter().map(|p: &[f64; 2]| p.map(|c| (c * 1e3).floor() * 16.0)).collect();
    let shifted: Vec<[f64; 2]> = uniform.iter().map(|&[x, y]| [x + 3.0, y - 5.0]).collect();
    assert!(levels(&shifted, Suffixes::MostCommon).iter().all(|&level| level >= 4));
    assert!(levels(&shifted, Suffixes::Zeros).iter().all(|&level| level == 0));
}

#[test]
fn levels_of_floats_are_by_their_significands() {
    // 1e300 and 3 have no common unit in which both are integers of 53 bits.
    let points = [[1e300, 3.0], [1.5, 2f64.powi(-30)], [1.0 + 2f64.powi(-48), -0.0]];
    for suffixes in [Suffixes::MostCommon, Suffixes::Zeros] {
        let zeros = (1e300f64.to_bits().trailing_zeros()).min(BIT_LEVEL_MAX);
        assert_eq!(levels(&points, suffixes), [zeros, BIT_LEVEL_MAX, 4]);
    }
}

#[test]
fn a_share_of_random_bits_rises_level_by_level_and_the_highest_come_first() {
    let points: Vec<[f64; 3]> =
        uniform(40_000).iter().map(|p: &[f64; 3]| p.map(|c| (c * 1e6).floor() - 4e5)).collect();
    for suffixes in [Suffixes::MostCommon, Suffixes::Zeros] {
        let levels = levels(&points, suffixes);
        let above = |level| levels.iter().filter(|&&l| l >= level).count() as f64 / points.len() as f64;
        assert!((above(1) - 1.0 / 8.0).abs() < 0.01 && (above(2) - 1.0 / 64.0).abs() < 0.004, "{suffixes:?}");
        let sequence: Vec<u32> = Sequence::Pass.by_levels(&points, suffixes).collect();
        let keys = sequence.iter().map(|&number| (BIT_LEVEL_MAX - levels[number as usize], number));
        assert!(keys.is_sorted(), "by level, then along the curve");
    }
}
