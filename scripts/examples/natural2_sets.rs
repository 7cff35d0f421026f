//! Weights of natural neighbours in sets of points of the plane, for `scripts/check-cgal`.
//!
//! On stdin, each set is the number of its points and of its targets as u32, and pairs of f64: the points,
//! then the targets. On stdout go, for each target, the number of its neighbours as u32, and for each of them
//! its index as u32 and its weight as f64; none outside of the hull. All numbers are little-endian.

use spmesh_delaunay::delaunay2::interpolation::NaturalNeighbours;
use spmesh_delaunay::delaunay2::triangulate;
use std::io::{self, Read, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut input, mut output) = (io::stdin().lock(), io::BufWriter::new(io::stdout().lock()));
    while let Some(points_len) = read_count(&mut input)? {
        let targets_len = read_count(&mut input)?.ok_or("a set without a number of targets")?;
        let mesh = triangulate(&read_points(points_len, &mut input)?)?;
        let mut natural = NaturalNeighbours::new(&mesh);
        for target in read_points(targets_len, &mut input)? {
            let weights = natural.weights(target).unwrap_or_default();
            output.write_all(&(weights.len() as u32).to_le_bytes())?;
            for (vertex, weight) in weights {
                output.write_all(&vertex.to_le_bytes())?;
                output.write_all(&weight.to_le_bytes())?;
            }
        }
        output.flush()?;
    }
    Ok(())
}

/// `None` at the end of the input.
fn read_count(input: &mut impl Read) -> io::Result<Option<usize>> {
    let mut bytes = [0; 4];
    match input.read_exact(&mut bytes) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        done => done.map(|()| Some(u32::from_le_bytes(bytes) as usize)),
    }
}

fn read_points(count: usize, input: &mut impl Read) -> io::Result<Vec<[f64; 2]>> {
    let mut bytes = vec![0; 16 * count];
    input.read_exact(&mut bytes)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    let (points, _) = numbers.as_chunks::<2>();
    Ok(points.iter().map(|point| point.map(f64::from_le_bytes)).collect())
}
