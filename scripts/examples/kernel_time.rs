//! Times the 2D kernel, in one thread, next to `spade`:
//! `cargo run --release --example kernel_time -- [points] [rounds] [uniform|flight-lines|lattice|decimal-lattice]`. With the name of a
//! set, that set alone and no peer, for profiling.

use spade::Triangulation as _;
use spmesh::delaunay2::{Kernel, Triangulation};
use std::time::Instant;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Random points of the unit square.
fn uniform(count: usize) -> Vec<[f64; 2]> {
    let mut random = Random(1);
    (0..count).map(|_| [random.unit(), random.unit()]).collect()
}

/// Integer coordinates (centimetres) in acquisition order: swaths that overlap, zigzag scan lines, one point per
/// half metre, jitter.
fn flight_lines(count: usize) -> Vec<[f64; 2]> {
    let mut random = Random(2);
    let (swaths, across, spacing) = (8, 600, 50.0);
    let per_swath = count.div_ceil(swaths);
    (0..count)
        .map(|i| {
            let (swath, k) = (i / per_swath, i % per_swath);
            let (line, step) = (k / across, k % across);
            let step = if line % 2 == 0 { step } else { across - 1 - step };
            let x =
                swath as f64 * across as f64 * spacing * 0.8 + (step as f64 + random.unit() * 0.6) * spacing;
            let y = (line as f64 + step as f64 / across as f64 + random.unit() * 0.2) * spacing;
            [x.round() + 48_000_000.0, y.round() + 530_000_000.0]
        })
        .collect()
}

/// Square lattice of integers, shuffled: every test between neighbours is a tie.
fn lattice(count: usize) -> Vec<[f64; 2]> {
    let side = count.isqrt();
    let mut random = Random(3);
    let mut points: Vec<[f64; 2]> =
        (0..side * side).map(|i| [(i % side) as f64 * 100.0, (i / side) as f64 * 100.0]).collect();
    for i in (1..points.len()).rev() {
        points.swap(i, (random.bits() % (i as u64 + 1)) as usize);
    }
    points
}

/// The lattice in tenths: decimals are rounded, so that ties become near ties.
fn decimal_lattice(count: usize) -> Vec<[f64; 2]> {
    lattice(count).into_iter().map(|p| p.map(|c| c / 1000.0)).collect()
}

/// Makes a set of about the given number of points.
type Generator = fn(usize) -> Vec<[f64; 2]>;

fn time<T>(what: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = what();
    (result, start.elapsed().as_secs_f64())
}

fn report(name: &str, points: &[[f64; 2]], seconds: f64) {
    println!("  {name:<14} {seconds:8.3} s  {:7.3} us/point", seconds * 1e6 / points.len() as f64);
}

fn main() -> spmesh::error::Result<()> {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let count = numbers.first().copied().unwrap_or(1_000_000);
    let rounds = numbers.get(1).copied().unwrap_or(3);
    let alone = std::env::args().nth(3);
    let sets: [(&str, Generator); 4] = [
        ("uniform", uniform),
        ("flight-lines", flight_lines),
        ("lattice", lattice),
        ("decimal-lattice", decimal_lattice),
    ];
    for (name, generate) in sets {
        if alone.as_ref().is_some_and(|alone| alone != name) {
            continue;
        }
        let points = generate(count);
        let mut kernel = Kernel::new();
        let mut mesh = Triangulation::default();
        println!("{name}, {} points", points.len());
        for round in 0..rounds {
            let (result, seconds) = time(|| kernel.triangulate(&points, &mut mesh));
            result?;
            report(if round == 0 { "kernel, first" } else { "kernel, again" }, &points, seconds);
        }
        println!("  {} triangles, {} duplicates", mesh.triangles.len(), mesh.duplicates.len());
        println!("  decisions in {rounds} rounds: {:?}", kernel.counts());
        let cell = 50_000;
        if points.len() > cell {
            let mut small = Triangulation::default();
            let (result, seconds) =
                time(|| points.chunks(cell).try_for_each(|chunk| kernel.triangulate(chunk, &mut small)));
            result?;
            report("kernel, by 50k", &points, seconds);
        }
        if alone.is_some() {
            continue;
        }
        let vertices: Vec<_> = points.iter().map(|p| spade::Point2::new(p[0], p[1])).collect();
        let (_, seconds) =
            time(|| spade::DelaunayTriangulation::<spade::Point2<f64>>::bulk_load(vertices).map(drop));
        report("spade", &points, seconds);
    }
    Ok(())
}
