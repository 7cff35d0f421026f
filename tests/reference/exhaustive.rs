//! The definition: every triangle of the set is tried against every point. Cost: O(n^4).

use super::as_set;
use super::exact::{exact_points, incircle_perturbed, orientation};

/// Canonical Delaunay triangles of distinct points. Domain: up to about 40 points.
pub fn triangles(points: &[[f64; 2]]) -> Vec<[u32; 3]> {
    let exact = exact_points(points);
    let count = points.len();
    let mut found = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            for c in b + 1..count {
                let [a, b, c] = match orientation(&exact[a], &exact[b], &exact[c]) {
                    0 => continue,
                    1 => [a, b, c],
                    _ => [a, c, b],
                };
                let empty = (0..count).filter(|d| ![a, b, c].contains(d)).all(|d| {
                    let side = incircle_perturbed([&exact[a], &exact[b], &exact[c], &exact[d]]);
                    assert_ne!(side, 0, "the perturbation decides");
                    side < 0
                });
                if empty {
                    found.push([a, b, c].map(|v| v as u32));
                }
            }
        }
    }
    as_set(found)
}
