//! Every set of triangles over a few points: the canonical triangulation passes and nothing else.

use spmesh_audit::Standard;

use super::Mesh;
use super::reference::{Random, canonical_triangulation, orient};

const SEED: u64 = 7;

/// Points may coincide; then no set may pass.
#[test]
fn one_of_all_sets_of_triangles_passes() {
    let mut random = Random::new(SEED);
    for round in 0..60 {
        let (len, side) = (3 + round % 3, 2 + random.below(4));
        let points: Vec<[i32; 2]> =
            (0..len).map(|_| [random.below(side) as i32, random.below(side) as i32]).collect();
        let triangles = counterclockwise_triangles(&points);
        let is_distinct = (0..len).all(|i| !points[..i].contains(&points[i]));
        let expected = is_distinct.then(|| canonical_triangulation(&points));
        let passed: Vec<Vec<[usize; 3]>> = (0..1u32 << triangles.len())
            .map(|set| subset(&triangles, set))
            .filter(|subset| Mesh::new(&points, subset).audit(Standard::Canonical).is_ok())
            .collect();
        assert_eq!(passed, Vec::from_iter(expected), "seed {SEED}, round {round}: {points:?}");
    }
}

/// The triangles in the order of the reference: by smallest index first, then by the two others.
fn counterclockwise_triangles(points: &[[i32; 2]]) -> Vec<[usize; 3]> {
    let mut triangles = Vec::new();
    for a in 0..points.len() {
        for b in a + 1..points.len() {
            for c in a + 1..points.len() {
                if orient(points[a], points[b], points[c]) > 0 {
                    triangles.push([a, b, c]);
                }
            }
        }
    }
    triangles
}

fn subset(triangles: &[[usize; 3]], set: u32) -> Vec<[usize; 3]> {
    triangles.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1).map(|(_, triangle)| *triangle).collect()
}
