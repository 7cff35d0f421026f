//! Times the 3D kernel, on one thread unless `--threads` names more.
//!
//! `kernel3_time POINTS` is our contestant in `scripts/bench`: one run with fresh buffers; `--threads N` is
//! the same on N threads. With `--parts` it also times the parts of insertions, the columns of thesis table 3.3;
//! this takes additional time. With `--weighted`, each point has a fourth number, its weight.
//! `kernel3_time POINTS --way WAY` inserts in `rounds`, in one `pass` along the curve or at `random`; or
//! in floating point as the program of the thesis: `float`, or `float-random`.
//! `kernel3_time POINTS ROUNDS`, for tuning, runs several rounds with the same buffers. POINTS has triples of
//! little-endian f64; `scripts/bench` keeps its files of points in its folder.

use std::borrow::Cow;
use std::error::Error;
use std::fs::File;

use spmesh_delaunay::delaunay3::{Kernel, Stats, Tetrahedralization};
use spmesh_delaunay::order::Sequence;
use spmesh_experiments::files::{read_tuples, timed};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match &words[..] {
        [points, flag] if flag == "--weighted" => compare_weighted(read_tuples(&mut File::open(points)?)?),
        [points] => run(Kernel::new(), read_tuples(&mut File::open(points)?)?),
        [points, flag] if flag == "--parts" => in_parts(read_tuples(&mut File::open(points)?)?),
        [points, flag, threads] if flag == "--threads" => {
            let mut kernel = Kernel::new();
            kernel.threads = threads.parse()?;
            run(kernel, read_tuples(&mut File::open(points)?)?)
        }
        [points, flag, way] if flag == "--way" => in_a_way(read_tuples(&mut File::open(points)?)?, way),
        [points, rounds] => tune(&read_tuples(&mut File::open(points)?)?, rounds.parse()?),
        _ => Err("usage: kernel3_time POINTS [--parts|--threads N|--weighted|--way WAY|ROUNDS]".into()),
    }
}

/// One run that times its parts.
fn in_parts(points: Vec<[f64; 3]>) -> Result<(), Box<dyn Error>> {
    let mut kernel = Kernel::new();
    kernel.is_timed = true;
    run(kernel, points)
}

/// One run with fresh buffers. The kernel takes ownership of the points, so that memory holds them once.
fn run(mut kernel: Kernel, points: Vec<[f64; 3]>) -> Result<(), Box<dyn Error>> {
    let count = points.len();
    let mut mesh = Tetrahedralization::default();
    let (result, seconds) = timed(|| kernel.triangulate(Cow::Owned(points), &mut mesh));
    result?;
    report(&mesh, count, seconds);
    Ok(())
}

/// One run with another sequence or arithmetic.
fn in_a_way(points: Vec<[f64; 3]>, way: &str) -> Result<(), Box<dyn Error>> {
    let sequence = match way {
        "rounds" => Sequence::Rounds,
        "pass" | "float" => Sequence::Pass,
        "random" | "float-random" => Sequence::Random { seed: 1 },
        _ => return Err(format!("{way}: not rounds, pass, random, float or float-random").into()),
    };
    if way.starts_with("float") {
        return in_floating_point(&points, sequence);
    }
    let mut kernel = Kernel::new();
    kernel.sequence = sequence;
    run(kernel, points)
}

fn in_floating_point(points: &[[f64; 3]], sequence: Sequence) -> Result<(), Box<dyn Error>> {
    use spmesh_molecules::float::{Options, triangulate};
    let options = Options { sequence, ..Options::default() };
    let (result, seconds) = timed(|| triangulate(points, &options));
    report(&result?.0, points.len(), seconds);
    Ok(())
}

/// One run with weights.
fn compare_weighted(balls: Vec<[f64; 4]>) -> Result<(), Box<dyn Error>> {
    let count = balls.len();
    let points = balls.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
    let weights: Vec<f64> = balls.into_iter().map(|[.., weight]| weight).collect();
    let mut mesh = Tetrahedralization::default();
    let (result, seconds) =
        timed(|| Kernel::new().triangulate_weighted(Cow::Owned(points), &weights, &mut mesh));
    result?;
    report(&mesh, count, seconds);
    Ok(())
}

fn report(mesh: &Tetrahedralization, count: usize, seconds: f64) {
    let tetrahedra = mesh.tetrahedra().len();
    let Stats { created, insphere_tests, order, locate, cavity, update, .. } = mesh.stats;
    let mut facts = format!("\"points\": {count}, \"tetrahedra\": {tetrahedra}, \"seconds\": {seconds:.6}");
    facts += &format!(", \"hidden\": {}", mesh.hidden.len());
    facts += &format!(", \"created\": {created}, \"in_sphere_tests\": {insphere_tests}");
    let parts = [("order", order), ("locate", locate), ("predicates", cavity), ("update", update)];
    for (name, part) in parts {
        facts += &format!(", \"{name}_seconds\": {:.6}", part.as_secs_f64());
    }
    println!("{{{facts}}}");
}

/// Many rounds.
fn tune(points: &[[f64; 3]], rounds: usize) -> Result<(), Box<dyn Error>> {
    let (mut kernel, mut mesh) = (Kernel::new(), Tetrahedralization::default());
    for round in 0..rounds {
        let (result, seconds) = timed(|| kernel.triangulate(Cow::Borrowed(points), &mut mesh));
        result?;
        let name = if round == 0 { "first" } else { "again" };
        println!("{name:<6} {seconds:8.3} s  {:7.3} us/point", seconds * 1e6 / points.len() as f64);
    }
    println!(
        "{} points, {} tetrahedra, {} duplicates",
        points.len(),
        mesh.tetrahedra().len(),
        mesh.duplicates.len()
    );
    Ok(())
}
