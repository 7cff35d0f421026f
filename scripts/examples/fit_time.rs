//! Times least-squares fits to scattered points, step by step.
//!
//! `fit_time POINTS FUNCTIONS [THREADS] [LAMBDA]` generates observations at random points of the unit square
//! while they are read, and knots of a perturbed grid for about FUNCTIONS functions. It prints the seconds
//! for the configurations and the basis, the normal equations, the thin-plate energy and the solution, the
//! greatest residual and the peak memory.

use spmesh_base::error::Result;
use spmesh_base::random::Random;
use spmesh_splines::fitting::{
    Equations, NormalEquations, Observation, ObservationReader, Observations, SplineSpace, for_each_residual,
    thin_plate,
};
use std::num::NonZeroUsize;
use std::time::Instant;

/// Generated observations of a smooth function at `count` random points.
struct Made {
    count: u64,
}

struct Pass {
    next: u64,
    count: u64,
}

impl Observations for Made {
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>> {
        Ok(Box::new(Pass { next: 0, count: self.count }))
    }
}

impl ObservationReader for Pass {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        let end = self.count.min(self.next + (1 << 14));
        observations.extend((self.next..end).map(|index| {
            let point = [unit(2 * index), unit(2 * index + 1)];
            Observation::new(point, value(point))
        }));
        self.next = end;
        Ok(())
    }
}

fn value([x, y]: [f64; 2]) -> f64 {
    (9.0 * x).sin() * (7.0 * y).cos() + (x - y) * (x - y)
}

/// A random number in the unit interval, a function of `index` alone.
fn unit(index: u64) -> f64 {
    // The state of the generator after `index` steps from 0.
    Random::new(index.wrapping_mul(0x9e37_79b9_7f4a_7c15)).unit()
}

/// A grid of the unit square with its inner knots moved.
fn places(functions: usize) -> Vec<[f64; 2]> {
    // There are about two functions per inner knot.
    let cells = ((functions as f64 / 2.05).sqrt() as usize).max(2) - 1;
    let step = 1.0 / cells as f64;
    let mut places = Vec::new();
    for (i, j) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j))) {
        let is_inside = [i, j].iter().all(|&k| k > 0 && k < cells);
        let random = 1 << 40 | (j * (cells + 1) + i) as u64;
        let off = |axis: u64| if is_inside { 0.4 * (unit(2 * random + axis) - 0.5) } else { 0.0 };
        let at = |k: usize, axis: u64| if k == cells { 1.0 } else { (k as f64 + off(axis)) * step };
        places.push([at(i, 0), at(j, 1)]);
    }
    places
}

fn timed<T>(name: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let start = Instant::now();
    let made = work()?;
    println!("{name}: {:.3} s", start.elapsed().as_secs_f64());
    Ok(made)
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [points, functions, rest @ ..] = &words[..] else {
        return Err("usage: fit_time POINTS FUNCTIONS [THREADS] [LAMBDA]".into());
    };
    let made = Made { count: points.parse()? };
    let threads = rest.first().map_or(Ok(NonZeroUsize::MIN), |word| word.parse())?;
    let lambda: f64 = rest.get(1).map_or(Ok(0.0), |word| word.parse())?;
    let places = places(functions.parse()?);
    let space = timed("configurations and basis", || SplineSpace::of(places))?;
    println!("{} functions", space.basis.len());
    let normal = timed("normal equations", || NormalEquations::of(&space.basis, &made, threads))?;
    println!("{} entries", normal.matrix.entries_len());
    let energy = timed("energy", || thin_plate(&space.basis))?;
    let coefficients = timed("solution", || {
        let energy = (lambda > 0.0).then_some(&energy);
        let equations = Equations::new(&space.basis, &normal, energy)?;
        equations.solve(lambda * equations.unit())
    })?;
    let (mut count, mut square, mut worst) = (0u64, 0.0, 0f64);
    timed("residuals", || {
        for_each_residual(&space.basis, &coefficients, &made, threads, |found| {
            count += 1;
            square += found.residual * found.residual;
            worst = worst.max(found.residual.abs());
        })
    })?;
    println!("rms {:.3e}, worst {worst:?}", (square / count.max(1) as f64).sqrt());
    if let Some(line) =
        std::fs::read_to_string("/proc/self/status")?.lines().find(|line| line.starts_with("VmHWM"))
    {
        println!("{line}");
    }
    Ok(())
}
