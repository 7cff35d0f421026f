//! Delaunay configurations by their definition: circles with k knots inside, in exact arithmetic.

use super::exact::{ExactPoint, exact_points, incircle_perturbed, orientation};
use super::normalised;
use num_bigint::BigInt;

/// A configuration: boundary triple, counterclockwise, the least first, and sorted interior set.
pub type Configuration = ([u32; 3], Vec<u32>);

/// Configurations of all degrees up to `degree_max`, each degree sorted by interior set, then by boundary.
///
/// Knots at one place are told apart by a numeric displacement: the j-th is moved by e (j, j²), for an e so
/// small that it changes no sign between different places. Cost: O(n⁴).
pub fn by_definition(points: &[[f64; 2]], degree_max: usize) -> Vec<Vec<Configuration>> {
    let points = moved(points);
    let count = points.len() as u32;
    let mut degrees = vec![Vec::new(); degree_max + 1];
    for a in 0..count {
        for b in a + 1..count {
            for c in b + 1..count {
                if let Some((boundary, interior)) = configuration(&points, [a, b, c], degree_max) {
                    degrees[interior.len()].push((boundary, interior));
                }
            }
        }
    }
    degrees.iter_mut().for_each(|degree| degree.sort_by(|p, q| (&p.1, p.0).cmp(&(&q.1, q.0))));
    degrees
}

/// The configuration of three knots, if its degree is at most `degree_max`.
fn configuration(points: &[ExactPoint], [a, b, c]: [u32; 3], degree_max: usize) -> Option<Configuration> {
    let at = |id: u32| &points[id as usize];
    let boundary = match orientation(at(a), at(b), at(c)) {
        0 => return None,
        1 => [a, b, c],
        _ => [a, c, b],
    };
    let mut interior = Vec::new();
    for d in (0..points.len() as u32).filter(|d| !boundary.contains(d)) {
        if incircle_perturbed([at(boundary[0]), at(boundary[1]), at(boundary[2]), at(d)]) > 0 {
            interior.push(d);
            if interior.len() > degree_max {
                return None;
            }
        }
    }
    Some((normalised(boundary), interior))
}

/// Exact positions, all distinct.
pub fn moved(points: &[[f64; 2]]) -> Vec<ExactPoint> {
    let exact = exact_points(points);
    let rank = |id: usize| BigInt::from(exact[..id].iter().filter(|p| **p == exact[id]).count());
    if (0..exact.len()).all(|id| rank(id) == BigInt::ZERO) {
        return exact;
    }
    // Determinants have degree 4 in coordinates of some bits and in ranks below 2^100, so coefficients of
    // powers of e are below 1 / e.
    let bits = 4 * exact.iter().flatten().map(BigInt::bits).max().unwrap_or(0) + 600;
    let moved = (0..exact.len()).map(|id| {
        let [x, y] = &exact[id];
        [(x << bits) + rank(id), (y << bits) + &rank(id) * &rank(id)]
    });
    moved.collect()
}

/// The directed lines through two points that have `degree` points to the left or between the two, each with
/// these points.
pub fn lines(points: &[[f64; 2]], degree: usize) -> Vec<([u32; 2], Vec<u32>)> {
    let points = moved(points);
    let count = points.len() as u32;
    let at = |id: u32| &points[id as usize];
    let mut lines = Vec::new();
    for p in 0..count {
        for q in (0..count).filter(|&q| q != p) {
            let is_left = |r: u32| match orientation(at(p), at(q), at(r)) {
                0 => (at(r) < at(p)) != (at(r) < at(q)),
                sign => sign > 0,
            };
            let left: Vec<u32> = (0..count).filter(|&r| r != p && r != q && is_left(r)).collect();
            if left.len() == degree {
                lines.push(([p, q], left));
            }
        }
    }
    lines
}
