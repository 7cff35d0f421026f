//! The `startin` crate, without snapping to near points. Its vertices are numbered from one, without
//! duplicates, and so are the indices in the file.

use spmesh_bench::{Paths, timed};
use startin::{InsertionStrategy, Triangulation};

fn main() -> std::io::Result<()> {
    let paths = Paths::of_arguments()?;
    let points = paths.read_points()?;
    let (triangulation, seconds) = timed(|| {
        let points = points.iter().map(|&[x, y]| [x, y, 0.0]).collect();
        let mut triangulation = Triangulation::new();
        triangulation.set_snap_tolerance(f64::MIN_POSITIVE);
        triangulation.insert(&points, InsertionStrategy::AsIs);
        triangulation
    });
    let triangles = triangulation.all_finite_triangles();
    paths.write_triangles(
        points.len(),
        triangles.iter().map(|triangle| triangle.v.map(|index| index - 1)),
        seconds,
    )
}
