//! Incremental insertion (Bowyer and Watson) over integer points, with a ghost vertex at infinity, in `i128`.
//!
//! Every new point is tested against every triangle: O(n^2), and simple. Floating point decides where its
//! error cannot matter, which is almost everywhere.

use super::as_set;
use std::collections::HashMap;

/// The vertex at infinity.
const GHOST: usize = usize::MAX;

type IntegerPoint = [i64; 2];

/// Canonical Delaunay triangles of distinct integer points with coordinates below 2^30 in magnitude.
pub fn triangles(points: &[IntegerPoint]) -> Vec<[u32; 3]> {
    assert!(points.iter().flatten().all(|c| c.abs() < 1 << 30));
    let Some(third) = (2..points.len()).find(|&k| area(points[0], points[1], points[k]) != 0) else {
        return Vec::new();
    };
    let [a, b, c] = if area(points[0], points[1], points[third]) > 0 { [0, 1, third] } else { [1, 0, third] };
    // A ghost triangle [v, u, GHOST] lies to the right of the hull edge from u to v.
    let mut mesh = vec![[a, b, c], [b, a, GHOST], [c, b, GHOST], [a, c, GHOST]];
    for p in (2..points.len()).filter(|&p| p != third) {
        insert(points, &mut mesh, p);
    }
    as_set(mesh.into_iter().filter(|t| !t.contains(&GHOST)).map(|t| t.map(|v| v as u32)))
}

fn insert(points: &[IntegerPoint], mesh: &mut Vec<[usize; 3]>, p: usize) {
    let mut cavity = Vec::new();
    mesh.retain(|t| {
        let is_met = in_conflict(points, *t, p);
        if is_met {
            cavity.push(*t);
        }
        !is_met
    });
    assert!(!cavity.is_empty());
    let mut sides: HashMap<[usize; 2], bool> = HashMap::new();
    for [a, b, c] in cavity {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            if sides.remove(&[v, u]).is_none() {
                sides.insert([u, v], true);
            }
        }
    }
    for [u, v] in sides.into_keys() {
        mesh.push(match (u, v) {
            (GHOST, v) => [v, p, GHOST],
            (u, GHOST) => [p, u, GHOST],
            (u, v) => [u, v, p],
        });
    }
}

fn in_conflict(points: &[IntegerPoint], [a, b, c]: [usize; 3], p: usize) -> bool {
    if c == GHOST {
        let side = area(points[a], points[b], points[p]);
        return side > 0 || side == 0 && between(points[a], points[b], points[p]);
    }
    let four = [points[a], points[b], points[c], points[p]];
    filtered_incircle(four).unwrap_or_else(|| perturbed_incircle(four))
}

/// The sign of the determinant of differences to the last point, if rounding cannot change it. Differences
/// are exact; each product has less than 10 roundings of 2^-53.
pub fn filtered_incircle(points: [IntegerPoint; 4]) -> Option<bool> {
    let [a, b, c, d] = points.map(|p| p.map(|value| value as f64));
    let [a, b, c] = [a, b, c].map(|p| [p[0] - d[0], p[1] - d[1]]);
    let (mut value, mut size) = (0.0, 0.0);
    for (p, q, r) in [(a, b, c), (b, c, a), (c, a, b)] {
        let (lift, one, other) = (p[0] * p[0] + p[1] * p[1], q[0] * r[1], q[1] * r[0]);
        value += lift * (one - other);
        size += lift * (one.abs() + other.abs());
    }
    (value.abs() > 1e-14 * size).then_some(value > 0.0)
}

fn between(u: IntegerPoint, v: IntegerPoint, p: IntegerPoint) -> bool {
    (u < p && p < v) || (v < p && p < u)
}

pub fn area(p: IntegerPoint, q: IntegerPoint, r: IntegerPoint) -> i128 {
    let [p, q, r] = [p, q, r].map(|p| p.map(i128::from));
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

pub fn perturbed_incircle(points: [IntegerPoint; 4]) -> bool {
    let [a, b, c, d] = points;
    let cofactors = [area(b, c, d), -area(a, c, d), area(a, b, d), -area(a, b, c)];
    // Lifts relative to a, so that they fit in i128; translation does not change the determinant.
    let lift = |p: IntegerPoint| {
        let [x, y] = [0, 1].map(|i| i128::from(p[i] - a[i]));
        x * x + y * y
    };
    let value: i128 = cofactors.iter().zip(points).map(|(cofactor, p)| cofactor * lift(p)).sum();
    if value != 0 {
        return value > 0;
    }
    let mut ranked = [0, 1, 2, 3];
    ranked.sort_by_key(|&i| std::cmp::Reverse(points[i]));
    ranked.iter().map(|&i| cofactors[i]).find(|&c| c != 0).expect("not all collinear") > 0
}
