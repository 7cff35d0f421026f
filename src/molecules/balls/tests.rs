//! Tiles against the whole.

use super::{Balls, in_tiles};
use std::num::NonZeroUsize;

/// Pseudo-random numbers in [0, 1).
pub(super) fn random(count: usize) -> Vec<f64> {
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
    let whole = in_tiles(balls, Some(1e-9), NonZeroUsize::MIN, usize::MAX).expect("finite balls");
    assert!(whole.contacts.len() > 3_000, "{}", whole.contacts.len());
    for (tile_max, threads) in [(200, 1), (200, 3), (17, 2), (1, 1)] {
        let threads = NonZeroUsize::new(threads).expect("positive");
        let tiled = in_tiles(balls, Some(1e-9), threads, tile_max).expect("finite balls");
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
