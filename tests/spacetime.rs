//! Products of 4D diagrams: simplices, values, slices and surfaces.

mod meshes;
mod simplices;
mod values;

use spmesh_spacetime::diagram4::diagram;
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;

use spmesh_reference::sets::Random;

/// The diagram of points with values given by a function.
pub fn with_values(points: Vec<Point4>, value: impl Fn(Point4) -> f64) -> Diagram4 {
    let values = points.iter().map(|&point| value(point)).collect();
    diagram(points, Some(values)).expect("points span space").0
}

/// A random `share` of the integer points of a grid, and all corners, so that the hull is a box.
pub fn sampled(random: &mut Random, counts: [i64; 4], share: f64) -> Vec<Point4> {
    let site = |number: i64| {
        let mut rest = number;
        counts.map(|count| (rest % count, rest /= count).0)
    };
    let is_corner = |p: &[i64; 4]| (0..4).all(|axis| p[axis] == 0 || p[axis] == counts[axis] - 1);
    let grid = (0..counts.iter().product()).map(site);
    let kept = grid.filter(|p| is_corner(p) || random.unit() < share);
    kept.map(|p| p.map(|x| x as f64)).collect()
}

/// Random integer points.
pub fn scattered(random: &mut Random, count: usize, side: i64) -> Vec<Point4> {
    (0..count).map(|_| [(); 4].map(|()| random.integer(0, side - 1) as f64)).collect()
}

/// Determinant of integer rows.
pub fn determinant(rows: &[Vec<i128>]) -> i128 {
    let Some((first, rest)) = rows.split_first() else { return 1 };
    let without = |column: usize| -> Vec<Vec<i128>> {
        rest.iter().map(|row| [&row[..column], &row[column + 1..]].concat()).collect()
    };
    let sign = |column: usize| if column.is_multiple_of(2) { 1 } else { -1 };
    (0..first.len()).map(|column| sign(column) * first[column] * determinant(&without(column))).sum()
}

/// The determinant of a simplex: its volume times the factorial of the dimension, with coordinates in units
/// of `1 / scale`.
pub fn volume<const D: usize>(points: &[[f64; D]], simplex: &[u32], scale: f64) -> i128 {
    let at = |vertex: u32| points[vertex as usize].map(|x| exact(x * scale));
    let origin = at(simplex[0]);
    let row = |&vertex: &u32| at(vertex).iter().zip(origin).map(|(x, o)| x - o).collect();
    determinant(&simplex[1..].iter().map(row).collect::<Vec<Vec<i128>>>())
}

fn exact(x: f64) -> i128 {
    assert_eq!(x.fract(), 0.0, "{x} is not a multiple of the unit");
    x as i128
}
