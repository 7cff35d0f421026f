//! Writes the filtration of weighted points: lines of `x y z weight` from stdin; without weights if there are
//! three columns. For comparison with other programs.

use spmesh_delaunay::delaunay3::{triangulate, triangulate_weighted};
use spmesh_molecules::tess3::filtration::Filtration;
use std::io::Read;

fn main() -> anyhow::Result<()> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>();
    let rows = text.lines().map(numbers).collect::<Result<Vec<_>, _>>()?;
    let points: Vec<[f64; 3]> = rows.iter().map(|row| [row[0], row[1], row[2]]).collect();
    let weights: Option<Vec<f64>> = rows.iter().map(|row| row.get(3).copied()).collect();
    let mesh = match &weights {
        Some(weights) => triangulate_weighted(&points, weights)?,
        None => triangulate(&points)?,
    };
    Filtration::new(&points, weights.as_deref(), &mesh)?.write(&mut std::io::stdout().lock(), 1.0)?;
    Ok(())
}
