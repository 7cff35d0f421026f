//! Values of simplex splines and B-splines, at points in general position.

use spmesh_configurations::{self as configurations, FARAWAY, Knots};

pub fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
}

/// Simplex spline by Micchelli's recurrence on the triple of knots with the largest area. Domain: points in
/// general position.
pub fn simplex_spline(x: [f64; 2], knots: &[[f64; 2]]) -> f64 {
    let count = knots.len();
    let mut best = (0.0, [0, 0, 0]);
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                let size = area(knots[i], knots[j], knots[k]);
                if size.abs() > best.0 {
                    best = (size.abs(), if size > 0.0 { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    let (size, places) = best;
    if size == 0.0 {
        return 0.0;
    }
    let [a, b, c] = places.map(|place| knots[place]);
    let shares = [area(x, b, c), area(a, x, c), area(a, b, x)].map(|part| part / size);
    if count == 3 {
        return if shares.iter().all(|&share| share >= 0.0) { 1.0 / size } else { 0.0 };
    }
    let without = |place: usize| -> Vec<[f64; 2]> { [&knots[..place], &knots[place + 1..]].concat() };
    (0..3).map(|i| shares[i] * simplex_spline(x, &without(places[i]))).sum()
}

/// Sum of all normalised simplex splines of a degree.
pub fn sum_at(knots: &Knots, configurations: &configurations::Configurations, x: [f64; 2]) -> f64 {
    let terms = configurations.iter().map(|(boundary, interior)| {
        let [a, b, c] = boundary.map(|id| knots.at(id));
        let size = area(a, b, c);
        let all: Vec<[f64; 2]> = boundary.iter().chain(interior).map(|&id| knots.at(id)).collect();
        if size == 0.0 { 0.0 } else { size * simplex_spline(x, &all) }
    });
    terms.sum()
}

/// The B-spline of a link, a sum over its edges (equation 8.1 of the thesis). Its degree is the size of the
/// link's set.
pub fn b_spline(knots: &Knots, link: configurations::Link<'_>, x: [f64; 2]) -> f64 {
    let edges = link.edges().filter(|edge| !edge.contains(&FARAWAY));
    let terms = edges.map(|edge| {
        let [a, b] = edge.map(|id| knots.at(id));
        let all: Vec<[f64; 2]> = link.set.iter().chain(&edge).map(|&id| knots.at(id)).collect();
        if a == b { 0.0 } else { area(x, a, b) * simplex_spline(x, &all) }
    });
    terms.sum()
}
