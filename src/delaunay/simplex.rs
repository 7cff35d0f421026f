//! Simplices by the numbers of their corners.

/// The corners of the facets of a tetrahedron; entry `i` is the facet opposite to corner `i`.
///
/// If the tetrahedron abcd is positively oriented, det(b - a, c - a, d - a) > 0, each facet is clockwise as
/// seen from its opposite corner and counterclockwise as seen from outside: for facet pqr and a point o on
/// the inner side, det(p - o, q - o, r - o) > 0.
pub const TETRAHEDRON_FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// [`TETRAHEDRON_FACETS`] reversed: if the tetrahedron is positively oriented, each facet is counterclockwise
/// as seen from the opposite corner.
pub const TETRAHEDRON_FACETS_FROM_INSIDE: [[usize; 3]; 4] = reversed(TETRAHEDRON_FACETS);

const fn reversed(mut facets: [[usize; 3]; 4]) -> [[usize; 3]; 4] {
    let mut side = 0;
    while side < facets.len() {
        let [a, b, c] = facets[side];
        facets[side] = [a, c, b];
        side += 1;
    }
    facets
}

/// The sum of the values of vertices in these weights. A value whose weight is zero does not matter, whatever
/// it is.
pub fn weighted_sum(weights: &[(u32, f64)], value: impl Fn(u32) -> f64) -> f64 {
    let counting = weights.iter().filter(|(_, weight)| *weight != 0.0);
    counting.map(|&(vertex, weight)| weight * value(vertex)).sum()
}
