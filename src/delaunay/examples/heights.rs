//! Heights of a terrain at the nodes of a grid, interpolated in the triangle around each node.

use spmesh_delaunay::Location;
use spmesh_delaunay::delaunay2::{Triangulation, triangulate};
use spmesh_delaunay::points::Point2;

/// The height at a place; `None` outside of the hull.
fn height(mesh: &Triangulation, heights: &[f64], place: Point2) -> Option<f64> {
    match mesh.locate(place) {
        Location::Vertex(vertex) => Some(heights[vertex as usize]),
        Location::Edge([a, b]) => {
            let part = |v: u32| distance(mesh.points()[v as usize], place);
            Some((part(b) * heights[a as usize] + part(a) * heights[b as usize]) / (part(a) + part(b)))
        }
        Location::Simplex(number) => {
            let vertices = mesh.simplices().nth(number as usize)?;
            let [a, b, c] = vertices.map(|v| mesh.points()[v as usize]);
            let weights = [area(place, b, c), area(a, place, c), area(a, b, place)];
            let sum: f64 = weights.iter().zip(vertices).map(|(w, v)| w * heights[v as usize]).sum();
            Some(sum / weights.iter().sum::<f64>())
        }
        _ => None,
    }
}

fn distance(a: Point2, b: Point2) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn area(a: Point2, b: Point2, c: Point2) -> f64 {
    spmesh_delaunay::predicates::area(a, b, c)
}

fn main() -> spmesh_delaunay::Result<()> {
    // A hill, measured along a spiral.
    let points: Vec<Point2> =
        (0..400).map(|i| f64::from(i) / 10.0).map(|t| [t * t.cos(), t * t.sin()]).collect();
    let heights: Vec<f64> = points.iter().map(|&p| 100.0 - distance(p, [0.0, 0.0])).collect();
    let mesh = triangulate(&points)?;
    for row in (-3..=3).rev() {
        let places = (-3..=3).map(|column| [10.0 * f64::from(column), 10.0 * f64::from(row)]);
        let cells = places.map(|place| match height(&mesh, &heights, place) {
            Some(height) => format!("{height:6.1}"),
            None => "     -".to_string(),
        });
        println!("{}", cells.collect::<String>());
    }
    Ok(())
}
