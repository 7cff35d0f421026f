//! Tiles against the whole, and areas against derivatives of volumes.

use spmesh_molecules::balls::{Balls, Cell, measure_in_tiles, molecular_surface, molecular_surface_in_tiles};
use std::num::NonZeroUsize;

/// Pseudo-random numbers in [0, 1).
fn random(count: usize) -> Vec<f64> {
    let mut state = 9u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| next()).collect()
}

#[test]
fn tiles_make_no_difference() {
    let numbers = random(4 * 900);
    let (centres, radii): (Vec<_>, Vec<_>) =
        numbers.chunks_exact(4).map(|n| ([n[0] * 9.0, n[1] * 9.0, n[2] * 9.0], 0.3 + 0.9 * n[3])).unzip();
    let balls = Balls { centres: &centres, radii: &radii };
    let whole = measure_in_tiles(balls, Some(1e-9), NonZeroUsize::MIN, usize::MAX).expect("finite balls");
    assert!(whole.contacts.len() > 3_000, "{}", whole.contacts.len());
    for (tile_max, threads) in [(200, 1), (200, 3), (17, 2), (1, 1)] {
        let threads = NonZeroUsize::new(threads).expect("positive");
        let tiled = measure_in_tiles(balls, Some(1e-9), threads, tile_max).expect("finite balls");
        let differs = whole.contacts.iter().zip(tiled.contacts.iter()).find(|(p, q)| p.balls != q.balls);
        assert_eq!(differs, None, "tiles of {tile_max}");
        assert_eq!(tiled.contacts.len(), whole.contacts.len(), "tiles of {tile_max}");
        for (found, expected) in tiled.cells.iter().zip(&whole.cells) {
            assert!((found.area - expected.area).abs() < 1e-11, "{found:?} {expected:?}");
            assert!((found.volume - expected.volume).abs() < 1e-11, "{found:?} {expected:?}");
        }
        for (found, expected) in tiled.contacts.iter().zip(whole.contacts.iter()) {
            assert!((found.area - expected.area).abs() < 1e-11, "{found:?} {expected:?}");
        }
    }
}

#[test]
fn tiles_make_no_difference_to_molecular_surfaces() {
    let numbers = random(4 * 900);
    let (centres, radii): (Vec<_>, Vec<_>) =
        numbers.chunks_exact(4).map(|n| ([n[0] * 9.0, n[1] * 9.0, n[2] * 9.0], 0.7 + 0.6 * n[3])).unzip();
    let balls = Balls { centres: &centres, radii: &radii };
    let whole = molecular_surface_in_tiles(balls, 0.6, NonZeroUsize::MIN, usize::MAX).expect("finite balls");
    for (tile_max, threads) in [(200, 1), (200, 3), (17, 2), (1, 1)] {
        let threads = NonZeroUsize::new(threads).expect("positive");
        let tiled = molecular_surface_in_tiles(balls, 0.6, threads, tile_max).expect("finite balls");
        for (found, expected) in tiled.iter().zip(&whole) {
            assert!((found.area - expected.area).abs() < 1e-9, "{found:?} {expected:?}");
            assert!((found.volume - expected.volume).abs() < 1e-9, "{found:?} {expected:?}");
        }
    }
}

/// The volume shrinks with the level by the area, also where patches cut one another.
#[test]
fn areas_are_derivatives_of_volumes() {
    let numbers = random(4 * 2_000);
    for (seed, chunk) in numbers.chunks_exact(4 * 40).enumerate() {
        let side = 2.0 + seed as f64 * 0.1;
        let (centres, radii): (Vec<_>, Vec<_>) = chunk
            .chunks_exact(4)
            .map(|n| ([n[0] * side, n[1] * side, n[2] * side], 0.7 + 0.6 * n[3]))
            .unzip();
        let balls = Balls { centres: &centres, radii: &radii };
        let sums = |probe: f64| {
            let cells = molecular_surface(balls, probe, NonZeroUsize::MIN).expect("finite balls");
            let sum = |of: fn(&Cell) -> f64| cells.iter().map(of).sum::<f64>();
            (sum(|cell| cell.area), sum(|cell| cell.volume))
        };
        for probe in [0.05, 0.2, 0.4, 0.65] {
            let step = 1e-4;
            let [lower, upper] = [-step, step].map(|by| sums(probe + by).1);
            let (area, volume) = sums(probe);
            let derivative = (lower - upper) / (2.0 * step);
            let error = area - derivative;
            assert!(error.abs() < 1e-4 * area.max(1.0), "{seed} {probe}: {area}, {error:e}, volume {volume}");
        }
    }
}
