//! Times configurations against the 2D kernel on the same knots, on one thread.
//!
//! `config_time POINTS|uniform:N [DEGREE]` reads knots as `kernel_time` does, or makes uniform ones. It runs
//! the kernel and the configurations in turn, three times, and prints the least times, in seconds and in
//! microseconds per knot, and their ratio.

use std::path::PathBuf;

use spmesh_base::random::Random;
use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_delaunay::delaunay2::{Kernel, Triangles};
use spmesh_experiments::files::{Paths, timed};

const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (source, degree) = match &words[..] {
        [source] => (source, 1),
        [source, degree] => (source, degree.parse()?),
        _ => return Err("usage: config_time POINTS|uniform:N [DEGREE]".into()),
    };
    let points = read(source)?;
    let (mut kernel_seconds, mut config_seconds, mut bytes, mut count) = (f64::INFINITY, f64::INFINITY, 0, 0);
    for _ in 0..ROUNDS {
        let mut mesh = Triangles::default();
        let (result, seconds) = timed(|| Kernel::new().triangulate(&points, &mut mesh));
        result?;
        drop(mesh);
        kernel_seconds = seconds.min(kernel_seconds);
        let copy = points.clone();
        let (result, seconds) = timed(|| {
            let knots = Knots::new(copy)?;
            configurations::generate(&knots, configurations::delaunay(&knots)?, &Rule::Delaunay, degree)
        });
        config_seconds = seconds.min(config_seconds);
        let all = result?;
        bytes = all.iter().map(configurations::Configurations::bytes).sum();
        count = all[degree].len();
    }
    let micros = |seconds: f64| seconds * 1e6 / points.len() as f64;
    println!(
        "{{\"knots\": {}, \"degree\": {degree}, \"configurations\": {count}, \"bytes\": {bytes}, \
         \"kernel_seconds\": {kernel_seconds:.6}, \"seconds\": {config_seconds:.6}, \"kernel_us_per_knot\": \
         {:.4}, \
         \"us_per_knot\": {:.4}, \"ratio\": {:.3}}}",
        points.len(),
        micros(kernel_seconds),
        micros(config_seconds),
        config_seconds / kernel_seconds,
    );
    Ok(())
}

/// Knots from a file, or uniform in the unit square with seed 1.
fn read(source: &str) -> Result<Vec<[f64; 2]>, Box<dyn std::error::Error>> {
    let Some(count) = source.strip_prefix("uniform:") else {
        return Ok(Paths { points: source.into(), triangles: PathBuf::new() }.read_points()?);
    };
    let mut random = Random::new(1);
    let mut unit = || random.unit();
    Ok((0..count.parse()?).map(|_| [unit(), unit()]).collect())
}
