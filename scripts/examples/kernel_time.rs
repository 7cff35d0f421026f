//! Times the 2D kernel, on one thread.
//!
//! `kernel_time POINTS TRIANGLES` is our contestant in `scripts/bench`: one run with fresh buffers.
//! `kernel_time POINTS ROUNDS`, for tuning, runs several rounds with the same buffers, then in pieces of the
//! size of leaves, and reports the counters of the predicates. `scripts/bench` keeps its files of points in
//! its folder.

use spmesh_delaunay::delaunay2::{Kernel, Triangles};
use spmesh_experiments::files::{Paths, timed};

const LEAF_POINTS: usize = 20_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths = Paths::of_arguments()?;
    let points = paths.read_points()?;
    match paths.triangles.to_str().and_then(|word| word.parse().ok()) {
        Some(rounds) => tune(&points, rounds),
        None => compare(&paths, &points),
    }
}

/// One run with fresh buffers.
fn compare(paths: &Paths, points: &[[f64; 2]]) -> Result<(), Box<dyn std::error::Error>> {
    let mut mesh = Triangles::default();
    let (result, seconds) = timed(|| Kernel::new().triangulate(points, &mut mesh));
    result?;
    Ok(paths.write_triangles(
        points.len(),
        mesh.triangles().iter().map(|triangle| triangle.vertices),
        seconds,
    )?)
}

/// Many rounds; nothing is written.
fn tune(points: &[[f64; 2]], rounds: usize) -> Result<(), Box<dyn std::error::Error>> {
    let report = |name: &str, seconds: f64| {
        println!("{name:<14} {seconds:8.3} s  {:7.3} us/point", seconds * 1e6 / points.len() as f64);
    };
    let mut kernel = Kernel::new();
    let mut mesh = Triangles::default();
    for round in 0..rounds {
        let (result, seconds) = timed(|| kernel.triangulate(points, &mut mesh));
        result?;
        report(if round == 0 { "first" } else { "again" }, seconds);
    }
    println!(
        "{} points, {} triangles, {} duplicates",
        points.len(),
        mesh.triangles().len(),
        mesh.duplicates.len()
    );
    println!("decisions in {rounds} rounds: {:?}", kernel.counts());
    for _ in 0..rounds {
        let mut leaves = points.chunks(LEAF_POINTS);
        let (result, seconds) = timed(|| leaves.try_for_each(|leaf| kernel.triangulate(leaf, &mut mesh)));
        result?;
        report("by leaves", seconds);
    }
    Ok(())
}
