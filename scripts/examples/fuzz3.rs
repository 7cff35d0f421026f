//! Fuzzes the 3D kernel with random, highly degenerate sets, and proves each result with independent exact
//! arithmetic. Shrinks a failing set and writes it to a file.
//!
//! ```text
//! cargo run --release --package spmesh-experiments --example fuzz3 -- --seconds 3600 --seed 1 --threads 1
//! ```
//!
//! `--set I` tries set `I` of a seed alone. `--large` tries a few large sets with large cavities.

#[path = "../../tests/geometry/kernel3/promises.rs"]
mod promises;

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::process::exit;
use std::time::Instant;

use clap::Parser;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_experiments::fuzzing::{Fuzzing, Trial};
use spmesh_reference::clouds::{self, Family};
use spmesh_reference::sets::Random;
use spmesh_reference::space::{Point, Space, distinct};

/// Fuzzes the 3D kernel.
#[derive(Debug, Parser)]
struct Args {
    #[command(flatten)]
    fuzzing: Fuzzing,
    /// Tries large sets with large cavities instead.
    #[arg(long, conflicts_with = "set")]
    large: bool,
}

fn main() {
    let args = Args::parse();
    if args.large {
        large();
    } else {
        args.fuzzing.run::<3, Meshes>();
    }
}

#[derive(Default)]
struct Meshes {
    kernel: Kernel,
    mesh: Tetrahedralization,
}

impl Trial<3> for Meshes {
    const CELLS: &str = "tetrahedra";

    /// Most sets have few points: small sets are fast, and their failures are easy to read.
    fn points(seed: u64, set: u64) -> Vec<Point> {
        let mut random = Random::new(seed.wrapping_mul(0x9e6c_63d0_876a_9a37) ^ Random::new(set).bits());
        let (low, high) = match random.integer(0, 99) {
            0..40 => (1, 14),
            40..75 => (15, 60),
            75..96 => (61, 300),
            96..99 => (301, 1000),
            _ => (1001, 4000),
        };
        let count = random.integer(low, high) as usize;
        clouds::mixture(&mut random, count)
    }

    fn attempt(&mut self, set: u64, points: &[Point], done: impl FnOnce()) -> Result<u64, String> {
        let Meshes { kernel, mesh } = self;
        choose_way(kernel, set);
        kernel.triangulate(Cow::Borrowed(points), mesh).map_err(|error| error.to_string())?;
        done();
        promises::prove(points, mesh)?;
        if points.len() <= 14 {
            let (kept, first) = distinct(points);
            let place =
                |i: u32| kept.iter().position(|p| *p == points[first[i as usize]]).unwrap_or_default() as u32;
            let found = promises::tetrahedra(mesh).into_iter().map(|t| t.map(place));
            if spmesh_reference::tetrahedra::as_set(found) != Space::new(&kept).tetrahedra() {
                return Err("these are not the tetrahedra by definition".into());
            }
        }
        Ok(mesh.tetrahedra().len() as u64)
    }
}

/// The order of insertion of a set, the default order in half of them, and the threads: up to four, with
/// parts of a few points.
fn choose_way(kernel: &mut Kernel, set: u64) {
    let mut random = Random::new(set);
    let is_usual = random.integer(0, 1) == 0;
    let [curve, sequence, levels] = [3, 2, 1].map(|last| if is_usual { 0 } else { random.integer(0, last) });
    kernel.curve = Curve::ALL[curve as usize];
    kernel.sequence = [Sequence::Rounds, Sequence::Pass, Sequence::Random { seed: set }][sequence as usize];
    kernel.by_bit_levels = levels == 1;
    kernel.threads = NonZeroUsize::MIN.saturating_add(random.integer(0, 3) as usize);
    kernel.points_per_thread = random.integer(0, 12) as usize;
}

/// Sets whose cavities are large or many.
fn large() {
    let mut random = Random::new(1);
    let mut with_center = |family, count: usize| {
        let mut points = clouds::of(&mut random, family, count);
        points.push([0.0; 3]);
        points
    };
    let sphere = with_center(Family::RoundedSphere, 10_000);
    let grid = |side: i64| (0..side * side).map(move |i| [i % side, i / side]);
    let integer_sphere: Vec<Point> = grid(2 * 74 + 1)
        .flat_map(|[x, y]| {
            let (x, y) = (x - 74, y - 74);
            let z = ((5_525 - x * x - y * y).max(0) as f64).sqrt().round() as i64;
            [[x, y, z], [x, y, -z]]
        })
        .filter(|[x, y, z]| x * x + y * y + z * z == 5_525)
        .chain([[0; 3]])
        .map(|p| p.map(|c| c as f64))
        .collect();
    let lines = |n: i64, height: f64| -> Vec<Point> {
        (0..n).flat_map(|i| [[i as f64, 0.0, 0.0], [n as f64 / 2.0, (i - n / 2) as f64, height]]).collect()
    };
    let sets: [(&str, Vec<Point>); 10] = [
        ("sphere and center", sphere),
        ("integer sphere and center", integer_sphere),
        ("two lines of 400", lines(400, 3.0)),
        ("two lines of 400, rounded", lines(400, 3.0).iter().map(|p| p.map(|c| c * 0.1)).collect()),
        ("moment curve of 600", clouds::of(&mut random, Family::MomentCurve, 600)),
        (
            "moment curve of 300, rounded",
            clouds::of(&mut random, Family::MomentCurve, 300).iter().map(|p| p.map(|c| c * 1e-3)).collect(),
        ),
        (
            "parabola and a line",
            (0..500)
                .flat_map(|i| [[f64::from(i), f64::from(i * i), 0.0], [-3.0, -1.0, f64::from(i)]])
                .collect(),
        ),
        ("paraboloid", clouds::of(&mut random, Family::Paraboloid, 6_000)),
        ("cylinder", clouds::of(&mut random, Family::Cylinder, 5_000)),
        (
            "axis of a cylinder",
            (0..3_000)
                .map(|i| f64::from(i) * 0.01)
                .flat_map(|t| [[t.sin(), t.cos(), 0.1 * t], [0.0, 0.0, 0.1 * t]])
                .collect(),
        ),
    ];
    let (mut kernel, mut mesh) = (Kernel::new(), Tetrahedralization::default());
    for (name, points) in sets {
        let started = Instant::now();
        kernel.triangulate(Cow::Borrowed(&points), &mut mesh).expect("finite points");
        let kernel_s = started.elapsed().as_secs_f64();
        let mut degrees = vec![0; points.len()];
        mesh.tetrahedra().iter().flat_map(|t| t.vertices).for_each(|v| degrees[v as usize] += 1);
        let degree = degrees.into_iter().max().unwrap_or(0);
        println!(
            "{name}: {} points, {} tetrahedra, up to {degree} around a point, {kernel_s:.3} s",
            points.len(),
            mesh.tetrahedra().len(),
        );
        match promises::prove(&points, &mesh) {
            Ok(()) => println!("    proved in {:.1} s", started.elapsed().as_secs_f64() - kernel_s),
            Err(message) => {
                println!("    {message}");
                exit(1);
            }
        }
    }
}
