//! The `delaunator` crate.

use delaunator::Point;
use spmesh_bench::{Paths, timed};

fn main() -> std::io::Result<()> {
    let paths = Paths::of_arguments()?;
    let points = paths.read_points()?;
    let count = points.len();
    let (triangulation, seconds) = timed(|| {
        let points: Vec<Point> = points.into_iter().map(|[x, y]| Point { x, y }).collect();
        delaunator::triangulate(&points)
    });
    let triangles =
        triangulation.triangles.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]);
    paths.write_triangles(count, triangles, seconds)
}
