//! Tiles against the whole.

use super::super::tests::random;
use super::{Balls, in_tiles};
use std::num::NonZeroUsize;

#[test]
fn tiles_make_no_difference() {
    let numbers = random(4 * 900);
    let (centres, radii): (Vec<_>, Vec<_>) =
        numbers.chunks_exact(4).map(|n| ([n[0] * 9.0, n[1] * 9.0, n[2] * 9.0], 0.7 + 0.6 * n[3])).unzip();
    let balls = Balls { centres: &centres, radii: &radii };
    let whole = in_tiles(balls, 0.6, NonZeroUsize::MIN, usize::MAX).expect("finite balls");
    for (tile_max, threads) in [(200, 1), (200, 3), (17, 2), (1, 1)] {
        let threads = NonZeroUsize::new(threads).expect("positive");
        let tiled = in_tiles(balls, 0.6, threads, tile_max).expect("finite balls");
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
            let cells = in_tiles(balls, probe, NonZeroUsize::MIN, usize::MAX).expect("finite balls");
            let sum = |of: fn(&super::Cell) -> f64| cells.iter().map(of).sum::<f64>();
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
