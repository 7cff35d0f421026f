//! Fuzzes the 4D engine with random degenerate sets. The diagram must be the same for any order of the
//! points, for integers and fractions, and by both routes. An exact
//! audit that shares no code with the engine must pass.
//!
//! ```text
//! cargo run --release --package spmesh-experiments --example fuzz4 -- --seconds 600 --seed 1
//! ```
//!
//! `--set I` tries set `I` of a seed alone. Shrinks a failing set and writes it to a file.

use clap::Parser;
use spmesh_audit::diagram::check;
use spmesh_experiments::fuzzing::{Fuzzing, Trial};
use spmesh_reference::sets::Random;
use spmesh_spacetime::diagram4::{Route, diagram_by};
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::model::diagram4::Diagram4;
use std::num::NonZeroUsize;

/// Fuzzes the 4D engine.
#[derive(Debug, Parser)]
struct Args {
    #[command(flatten)]
    fuzzing: Fuzzing,
}

fn main() {
    Args::parse().fuzzing.run::<4, Diagrams>();
}

#[derive(Default)]
struct Diagrams;

impl Trial<4> for Diagrams {
    const CELLS: &str = "cells";

    fn points(seed: u64, set: u64) -> Vec<Point4> {
        points(&mut Random::new(seed.wrapping_mul(1_000_003).wrapping_add(set)))
    }

    fn attempt(&mut self, set: u64, points: &[Point4], done: impl FnOnce()) -> Result<u64, String> {
        let cells = try_set(points, &mut Random::new(set));
        done();
        Ok(cells as u64)
    }
}

/// Checks a set and returns its number of cells.
fn try_set(points: &[Point4], random: &mut Random) -> usize {
    let simplices = by(Route::Simplices, 1, points);
    assert_eq!(by(Route::Direct, 1, points), simplices, "the direct route");
    let Some(diagram) = simplices else { return 0 };
    check(&diagram.points, &diagram.cells).expect("a proof");
    let mut shuffled = points.to_vec();
    random.shuffle(&mut shuffled);
    let threads = random.integer(2, 4) as usize;
    let other = by(Route::Simplices, threads, &shuffled);
    assert_eq!(other.as_ref(), Some(&diagram), "another order, on {threads} threads");
    // These factors are exact in f64. They change the arithmetic, but not the cells.
    for factor in [0.125, 2f64.powi(-400), 2f64.powi(300), 65_536.0] {
        let scaled: Vec<Point4> = points.iter().map(|p| p.map(|x| x * factor)).collect();
        let scaled = by(Route::Simplices, 1, &scaled).expect("as many dimensions");
        assert_eq!(scaled.cells, diagram.cells, "times {factor:e}");
    }
    diagram.cells.len()
}

/// The diagram, unless all points are in a hyperplane.
fn by(route: Route, threads: usize, points: &[Point4]) -> Option<Diagram4> {
    let threads = NonZeroUsize::new(threads).expect("a thread or more");
    match diagram_by(route, threads, points.to_vec(), None) {
        Ok((diagram, _)) => Some(diagram),
        Err(error) => {
            assert!(error.to_string().contains("dimensions"), "{error}");
            None
        }
    }
}

/// A set of a random kind: integers up to 2^20 apart.
fn points(random: &mut Random) -> Vec<Point4> {
    // Threads share the joining of cells where there are thousands of simplices.
    let most = if random.integer(0, 9) == 0 { 600 } else { 40 };
    let count = random.integer(0, most);
    let side = [2, 2, 3, 3, 4, 5, 8, 16, 100, 171, 700, 20_000, 1 << 20][random.integer(0, 12) as usize];
    let shift = [0, 0, 1 << 10, -(1 << 30)][random.integer(0, 3) as usize];
    let flat = random.integer(0, 7);
    let shell = random.integer(0, 3) == 0 && side <= 16;
    let mut points = Vec::new();
    for _ in 0..count {
        let mut point = [(); 4].map(|()| random.integer(0, side - 1));
        if shell {
            // All permutations and sign changes of one vector lie on one sphere.
            let mut vector = [1, side, 2 * side, 5];
            random.shuffle(&mut vector);
            point = vector.map(|x| if random.integer(0, 1) == 0 { x } else { -x });
        }
        match flat {
            0 if random.integer(0, 4) > 0 => point[3] = 1,
            1 if random.integer(0, 4) > 0 => point[2] = point[0] + point[1],
            2 => (point[2], point[3]) = (point[0] * point[0] % 7, point[0] % 3),
            3 if random.integer(0, 20) > 0 => (point[1], point[2], point[3]) = (0, point[0], 2 * point[0]),
            _ => {}
        }
        points.push(point.map(|x| (x + shift) as f64));
    }
    points
}
