//! The `startin` crate, without snapping to near points. Its vertices count from one; those of equal points
//! are left out, so that indices in the file are those without them.

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
