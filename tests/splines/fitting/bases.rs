//! Bases, observations and evaluations shared by tests.

use spmesh_configurations::special::{Features, features};
use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_delaunay::delaunay2;
use spmesh_reference::sets::Random;
use spmesh_splines::bases::{Basis, Scratch};
use spmesh_splines::fitting::Observation;
use std::num::NonZeroUsize;

pub const ONE: NonZeroUsize = NonZeroUsize::MIN;

/// Quadratic functions over points with the border of their hull pulled apart, so that the domain is the
/// whole hull.
pub fn pulled_apart(points: &[[f64; 2]]) -> Basis {
    let knots = Knots::new(points.to_vec()).expect("finite points");
    let hull = delaunay2::triangulate(points).expect("a triangulation").arrays().hull.clone();
    let special = features(&knots, &Features { corners: hull, ..Features::default() }).expect("features");
    let all = special.generate(&Rule::Delaunay, 1).expect("configurations");
    let links = configurations::links(&special.knots, &all[1]).expect("links");
    let functions = special.functions(&links).expect("functions");
    Basis::of_functions(&special.knots, &all[1], &functions).expect("a basis")
}

/// Cubic functions over points with clamped corners.
pub fn cubic(points: &[[f64; 2]]) -> Basis {
    let knots = Knots::new(points.to_vec()).and_then(|knots| knots.clamped(2)).expect("a hull");
    let start = configurations::delaunay(&knots).expect("triangles");
    let all = configurations::generate(&knots, start, &Rule::Delaunay, 2).expect("degrees");
    Basis::new(&knots, &all[2]).expect("a basis")
}

/// Knots of a square grid over the unit square, with inner knots moved by up to `moved` times a cell.
///
/// Knots next to a corner are moved towards it. Otherwise an edge that cuts off the corner could join two
/// knots that are pulled apart, and splines may be folded along such an edge.
pub fn grid(cells: usize, moved: f64) -> Vec<[f64; 2]> {
    let mut random = Random::new(11);
    let at = |i: usize| i as f64 / cells as f64;
    let mut points = Vec::new();
    for (i, j) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j))) {
        let is_next_to_corner = [i, j].iter().all(|&k| k == 1 || k + 1 == cells);
        let mut move_inside = |k: usize| {
            let towards = if k == 1 { -1.0 } else { 1.0 };
            let by = if is_next_to_corner { towards } else { 2.0 * random.unit() - 1.0 };
            if i % cells == 0 || j % cells == 0 { at(k) } else { at(k) + moved * by / cells as f64 }
        };
        points.push([move_inside(i), move_inside(j)]);
    }
    points
}

/// Observations of a function at random points of the unit square.
pub fn scattered(count: usize, seed: u64, f: impl Fn([f64; 2]) -> f64) -> Vec<Observation> {
    let mut random = Random::new(seed);
    let points = (0..count).map(|_| [random.unit(), random.unit()]);
    points.map(|point| Observation::new(point, f(point))).collect()
}

/// The value of a spline.
pub fn value(basis: &Basis, coefficients: &[f64], x: [f64; 2]) -> f64 {
    let mut scratch = Scratch::default();
    basis.at(x, &mut scratch).iter().map(|&(function, value)| coefficients[function as usize] * value).sum()
}

/// The greatest deviation of a spline from a function, on a grid of points over the unit square.
pub fn deviation(basis: &Basis, coefficients: &[f64], side: usize, f: impl Fn([f64; 2]) -> f64) -> f64 {
    assert_eq!(basis.len(), coefficients.len());
    let at = |i: usize| i as f64 / (side - 1) as f64;
    let points = (0..side).flat_map(|j| (0..side).map(move |i| [at(i), at(j)]));
    points.map(|x| (value(basis, coefficients, x) - f(x)).abs()).fold(0.0, f64::max)
}

/// Solves dense equations by elimination with complete row exchange.
pub fn solve_dense(mut rows: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    for pivot in 0..count {
        let best = (pivot..count).max_by(|&a, &b| rows[a][pivot].abs().total_cmp(&rows[b][pivot].abs()));
        let best = best.expect("a row");
        rows.swap(pivot, best);
        right.swap(pivot, best);
        let (above, below) = rows.split_at_mut(pivot + 1);
        for (row, offset) in below.iter_mut().zip(pivot + 1..) {
            let factor = row[pivot] / above[pivot][pivot];
            row.iter_mut().zip(&above[pivot]).for_each(|(entry, of_pivot)| *entry -= factor * of_pivot);
            right[offset] -= factor * right[pivot];
        }
    }
    for pivot in (0..count).rev() {
        let known: f64 = (pivot + 1..count).map(|column| rows[pivot][column] * right[column]).sum();
        right[pivot] = (right[pivot] - known) / rows[pivot][pivot];
    }
    right
}

/// The values of all functions at points: dense rows.
pub fn dense(basis: &Basis, points: impl Iterator<Item = [f64; 2]>) -> Vec<Vec<f64>> {
    let mut scratch = Scratch::default();
    let row = |x| {
        let mut row = vec![0.0; basis.len()];
        basis.at(x, &mut scratch).iter().for_each(|&(function, value)| row[function as usize] += value);
        row
    };
    points.map(row).collect()
}
