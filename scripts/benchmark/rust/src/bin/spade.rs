//! The `spade` crate: `bulk_load`, with the index of each point in its vertex.

use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};
use spmesh_bench::{Paths, timed};

struct Vertex {
    position: Point2<f64>,
    index: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

fn main() -> std::io::Result<()> {
    let paths = Paths::of_arguments()?;
    let points = paths.read_points()?;
    let count = points.len();
    let (triangulation, seconds) = timed(|| {
        let vertex =
            |(index, [x, y]): (usize, [f64; 2])| Vertex { position: Point2::new(x, y), index: index as u32 };
        let vertices = points.into_iter().enumerate().map(vertex).collect();
        DelaunayTriangulation::<Vertex>::bulk_load(vertices)
    });
    let triangulation = triangulation.map_err(std::io::Error::other)?;
    let triangles = triangulation.inner_faces().map(|face| face.vertices().map(|vertex| vertex.data().index));
    paths.write_triangles(count, triangles, seconds)
}
