use num_bigint::BigInt;
use spmesh_reference::exact::sign;
use spmesh_reference::exact3::{self, orientation};
use spmesh_reference::sets::Random;
use spmesh_reference::tetrahedra::{as_set, dot, exact_points, tetrahedra, volume};

/// The perturbation carried out in integers: with a base greater than all coefficients, the lift of the point
/// of rank r is `|p|^2 * base^n + base^r`, and no five lifts are in a hyperplane.
#[test]
fn the_perturbation_is_that_of_real_lifts() {
    let mut random = Random::new(5);
    for round in 0..40 {
        let (count, side) = (6 + round % 4, 1 + i64::from(round > 20));
        let mut points: Vec<[f64; 3]> =
            (0..count).map(|_| [0; 3].map(|_| random.integer(0, side) as f64)).collect();
        points.sort_by(|p, q| p.partial_cmp(q).unwrap());
        points.dedup();
        let exact = exact_points(&points);
        let base = BigInt::from(1u64 << 32);
        let lifts: Vec<BigInt> = (0u32..)
            .zip(&exact)
            .map(|(rank, p)| dot(p, p) * base.pow(points.len() as u32) + base.pow(rank))
            .collect();
        let height = |corners: [usize; 4], e: usize| {
            let mut height = &lifts[e] * volume(corners.map(|i| &exact[i]));
            for (i, &corner) in corners.iter().enumerate() {
                let mut replaced = corners.map(|i| &exact[i]);
                replaced[i] = &exact[e];
                height -= &lifts[corner] * volume(replaced);
            }
            sign(&height)
        };
        let mut lower = Vec::new();
        for i in 0..points.len().pow(4) {
            let corners = [0, 1, 2, 3].map(|digit| i / points.len().pow(digit) % points.len());
            if orientation(corners.map(|i| &exact[i])) <= 0 {
                continue;
            }
            let [a, b, c, d] = corners.map(|i| &exact[i]);
            let others = (0..points.len()).filter(|e| !corners.contains(e));
            let heights: Vec<i32> = others.clone().map(|e| height(corners, e)).collect();
            let depths = others.map(|e| -exact3::insphere_perturbed([a, b, c, d, &exact[e]]));
            assert_eq!(heights, depths.collect::<Vec<_>>(), "{corners:?} of {points:?}");
            if heights.iter().all(|&height| height > 0) {
                lower.push(corners.map(|v| v as u32));
            }
        }
        let mut lower = as_set(lower);
        lower.dedup();
        assert_eq!(tetrahedra(&points), lower, "{points:?}");
    }
}
