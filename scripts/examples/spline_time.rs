//! Times splines over uniform, clustered or gridded knots, on one thread.
//!
//! `spline_time uniform:N|clustered:N|grid:N [DEGREE]` builds the basis of clamped knots in the unit square.
//! It prints the least times of three rounds: seconds for the basis; microseconds per point for values and
//! derivatives at up to a million points, random or along a curve; nanoseconds per pixel for a raster of 2000
//! x 2000.

use spmesh_base::random::Random;
use spmesh_configurations::{self as configurations, Knots, Rule};
use spmesh_splines::bases::{Basis, Raster, Scratch};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 3;
const SIDE: usize = 2000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (source, degree) = match &words[..] {
        [source] => (source, 2),
        [source, degree] => (source, degree.parse()?),
        _ => return Err("usage: spline_time uniform:N|clustered:N|grid:N [DEGREE]".into()),
    };
    let knots = Knots::new(read(source)?)?.clamped(degree - 1)?;
    let below =
        configurations::generate(&knots, configurations::delaunay(&knots)?, &Rule::Delaunay, degree - 1)?;
    let (basis, seconds) = least(|| Basis::new(&knots, &below[degree - 1]));
    let basis = basis?;
    let mut unit = units(7);
    let scattered: Vec<[f64; 2]> =
        (0..1_000_000 >> (2 * degree.saturating_sub(2))).map(|_| [unit(), unit()]).collect();
    let coefficients: Vec<f64> = (0..basis.len()).map(|_| unit()).collect();
    let mut near = scattered.clone();
    near.sort_by_key(|x| (((x[1] * 100.0) as i64), (x[0] * 1e6) as i64));
    let mut scratch = Scratch::default();
    let (mut alive, mut used) = (0, 0);
    let mut micros = |points: &[[f64; 2]], work: &mut dyn FnMut([f64; 2], &mut Scratch)| {
        let (_, seconds) = least(|| points.iter().for_each(|&x| work(x, &mut scratch)));
        seconds * 1e6 / points.len() as f64
    };
    let of_random = micros(&scattered, &mut |x, scratch| alive += black_box(basis.at(x, scratch)).len());
    let of_near = micros(&near, &mut |x, scratch| used += black_box(basis.at(x, scratch)).len());
    let of_jets = micros(&near, &mut |x, scratch| used += black_box(basis.jets_at(x, scratch)).len());
    let of_domain = micros(&scattered, &mut |x, _| used += usize::from(black_box(basis.is_in_domain(x))));
    let side = SIDE >> (2 * degree.saturating_sub(2));
    let step = [1.0 / side as f64; 2];
    let raster = Raster { origin: [0.5 * step[0]; 2], step, columns: side, rows: side };
    let mut sum = black_box(used) as f64 * 0.0;
    let (result, raster_seconds) = least(|| {
        basis.raster(&coefficients, &raster, |row| {
            sum += row.values.iter().sum::<f64>();
            Ok(())
        })
    });
    result?;
    println!(
        "{{\"knots\": \"{source}\", \"degree\": {degree}, \"functions\": {}, \"basis_seconds\": \
         {seconds:.4}, \
         \"bytes_per_function\": {:.0}, \"alive\": {:.2}, \"us_random\": {of_random:.4}, \"us_near\": \
         {of_near:.4}, \
         \"us_jets\": {of_jets:.4}, \"us_domain\": {of_domain:.4}, \"ns_pixel\": {:.2}, \"mean\": {:.4}}}",
        basis.len(),
        basis.bytes() as f64 / basis.len() as f64,
        alive as f64 / (ROUNDS * scattered.len()) as f64,
        raster_seconds * 1e9 / (side * side) as f64,
        sum / (ROUNDS * side * side) as f64,
    );
    Ok(())
}

/// The last result, and the least time of all rounds.
fn least<T>(mut work: impl FnMut() -> T) -> (T, f64) {
    let mut best = f64::INFINITY;
    let mut round = || {
        let start = Instant::now();
        let result = work();
        best = best.min(start.elapsed().as_secs_f64());
        result
    };
    let mut result = round();
    (1..ROUNDS).for_each(|_| result = round());
    (result, best)
}

/// Random numbers in the unit interval.
fn units(seed: u64) -> impl FnMut() -> f64 {
    let mut random = Random::new(seed);
    move || random.unit()
}

fn read(source: &str) -> Result<Vec<[f64; 2]>, Box<dyn std::error::Error>> {
    let (kind, count) = source.split_once(':').ok_or("knots are named like uniform:6700")?;
    let count: usize = count.parse()?;
    let mut unit = units(1);
    let mut points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    match kind {
        "uniform" => points.extend((4..count).map(|_| [unit(), unit()])),
        // Dense towards a corner: distances shrink by powers of ten.
        "clustered" => {
            points.extend((4..count).map(|_| [10f64.powf(-6.0 * unit()), 10f64.powf(-6.0 * unit())]))
        }
        "grid" => {
            let side = (count as f64).sqrt() as usize;
            let at = |i: usize| i as f64 / (side - 1) as f64;
            points = (0..side * side).map(|i| [at(i % side), at(i / side)]).collect();
        }
        _ => return Err("knots are uniform, clustered or grid".into()),
    }
    Ok(points)
}
