//! Writes points in space as a stream, in a coherent order: in slabs from bottom to top, or along a z-order
//! curve. The same arguments give the same points everywhere.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use spmesh_base::random::Random;
use spmesh_stream::model::bits::spread3;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter};

/// Points that are written in one batch.
const BATCH: usize = 1 << 16;
/// Points per cell of a z-order curve through random points.
const CELL_POINTS: u64 = 256;
/// Bits per axis of a key along the curve.
const KEY_BITS: u32 = 20;
/// Approximate number of leaf corners per finest cell of a horizontal plane, in the octree near the sheet.
const SHEET: f64 = 30.0;
/// Periods of the gyroid per side of the cube.
const WAVES: f64 = 4.0;

type Failure = Box<dyn std::error::Error>;

/// Write a seeded point cloud in space as a stream.
#[derive(Parser)]
struct Arguments {
    /// Distribution of the points
    #[arg(long, value_enum, default_value_t = Family::Random)]
    family: Family,
    /// Order of the points
    #[arg(long, value_enum, default_value_t = Order::Slabs)]
    order: Order,
    /// Approximate number of points
    #[arg(long, default_value_t = 1_000_000)]
    points: u64,
    /// Seed of all randomness
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// File to write
    #[arg(short, long)]
    output: PathBuf,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Family {
    /// Uniform in a cube
    Random,
    /// Integer points of a cube
    Grid,
    /// Corners of the leaves of an octree that is fine near a wavy sheet
    Octree,
    /// A sphere
    Sphere,
    /// A gyroid: a surface that winds through all of a cube
    Gyroid,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Order {
    /// From bottom to top
    Slabs,
    /// Along a z-order curve
    Curve,
}

fn point(random: &mut Random) -> Point {
    [random.unit(), random.unit(), random.unit()]
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("gen_volume: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let side = (arguments.points as f64).cbrt().round() as i64;
    let leaf_level = (arguments.points as f64 / SHEET).log2().max(0.0) / 2.0;
    let (coordinates, size) = match arguments.family {
        Family::Random | Family::Sphere | Family::Gyroid => (Coordinates::F64, 1.0),
        Family::Grid => (integers(), side as f64),
        Family::Octree => (integers(), f64::from(1 << leaf_level.round() as i32)),
    };
    let mut header = Header::new(Kind::Points, coordinates, 3, false);
    header.bounds = Some(Bounds { min: [0.0; 3], max: [size; 3] });
    let mut sink = Sink {
        stream: StreamWriter::new(BufWriter::new(File::create(&arguments.output)?), header)?,
        batch: Vec::with_capacity(BATCH),
    };
    let mut random = Random::new(arguments.seed);
    match arguments.family {
        Family::Random => spread(arguments, &mut random, &mut sink)?,
        Family::Grid => sink.put_sorted(lattice(side), size, arguments.order)?,
        Family::Octree => {
            let mut leaves = Vec::new();
            divide([0; 3], leaf_level.round() as u32, size, &mut leaves);
            sink.put_sorted(leaves, size, arguments.order)?;
        }
        Family::Sphere => sink.put_sorted(sphere(arguments.points, &mut random), size, arguments.order)?,
        Family::Gyroid => sink.put_sorted(gyroid(arguments.points, &mut random), size, arguments.order)?,
    }
    sink.end()
}

fn integers() -> Coordinates {
    Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] }
}

/// The output stream.
struct Sink {
    stream: StreamWriter<BufWriter<File>>,
    batch: Vec<Point>,
}

impl Sink {
    fn put(&mut self, point: Point) -> Result<(), Failure> {
        self.batch.push(point);
        if self.batch.len() == BATCH { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), Failure> {
        self.stream.points(&self.batch)?;
        self.batch.clear();
        Ok(())
    }

    /// Writes points of a cube of the given size in the given order.
    fn put_sorted(&mut self, mut points: Vec<Point>, size: f64, order: Order) -> Result<(), Failure> {
        let cell = |x: f64| ((x / size * f64::from(1 << KEY_BITS)) as u32).min((1 << KEY_BITS) - 1);
        match order {
            Order::Slabs => points.sort_by(|p, q| p[2].total_cmp(&q[2])),
            Order::Curve => points.sort_by_cached_key(|p| {
                let [x, y, z] = p.map(|x| spread3(cell(x)));
                x | y << 1 | z << 2
            }),
        }
        points.into_iter().try_for_each(|point| self.put(point))
    }

    fn end(mut self) -> Result<(), Failure> {
        self.flush()?;
        self.stream.end(0, 0)?;
        Ok(())
    }
}

/// Random points, the same number in each slab or cell, so that memory does not depend on the total.
fn spread(arguments: &Arguments, random: &mut Random, sink: &mut Sink) -> Result<(), Failure> {
    let (points, is_curve) = (arguments.points, arguments.order == Order::Curve);
    let cells = points.div_ceil(CELL_POINTS).max(1);
    let level = if is_curve { (cells.ilog2() / 3).min(KEY_BITS) } else { 0 };
    let parts = if is_curve { 1 << (3 * level) } else { cells };
    for part in 0..parts {
        let count = (part + 1) * points / parts - part * points / parts;
        for _ in 0..count {
            let mut point = point(random);
            if is_curve {
                let side = f64::from(1 << level);
                for (axis, x) in point.iter_mut().enumerate() {
                    *x = (*x + f64::from(spmesh_stream::model::bits::gather3(part >> axis))) / side;
                }
            } else {
                point[2] = (point[2] + part as f64) / parts as f64;
            }
            sink.put(point)?;
        }
    }
    Ok(())
}

fn lattice(side: i64) -> Vec<Point> {
    let point = |i| [i % side, i / side % side, i / (side * side)].map(|x: i64| x as f64);
    (0..side.pow(3)).map(point).collect()
}

/// Adds the least corners of the leaves below a cell; `level` is its level above the finest cells.
fn divide(corner: [u32; 3], level: u32, size: f64, leaves: &mut Vec<Point>) {
    let half = f64::from(1u32 << level) / 2.0;
    let centre = corner.map(|x| (f64::from(x) + half) / size);
    let sheet = 0.5 + 0.2 * (TAU * centre[0]).sin() * (TAU * centre[1]).cos();
    if level == 0 || (centre[2] - sheet).abs() > 4.0 * half / size + 0.01 {
        leaves.push(corner.map(f64::from));
        return;
    }
    for child in 0..8u32 {
        let corner = std::array::from_fn(|axis| corner[axis] + ((child >> axis & 1) << (level - 1)));
        divide(corner, level - 1, size, leaves);
    }
}

fn sphere(count: u64, random: &mut Random) -> Vec<Point> {
    let point = |_| {
        let (z, turn) = (2.0 * random.unit() - 1.0, TAU * random.unit());
        let r = (1.0 - z * z).sqrt();
        [r * turn.cos(), r * turn.sin(), z].map(|x| 0.5 + 0.5 * x)
    };
    (0..count).map(point).collect()
}

/// Random points of a cube, moved along the gradient to a zero of the gyroid's function; a few miss it.
fn gyroid(count: u64, random: &mut Random) -> Vec<Point> {
    let mut points = Vec::with_capacity(count as usize);
    while (points.len() as u64) < count {
        let mut p = point(random).map(|x| x * WAVES * TAU);
        let mut value = f64::INFINITY;
        for _ in 0..8 {
            let [x, y, z] = p;
            value = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
            let gradient = [
                x.cos() * y.cos() - z.sin() * x.sin(),
                y.cos() * z.cos() - x.sin() * y.sin(),
                z.cos() * x.cos() - y.sin() * z.sin(),
            ];
            let square = gradient.iter().map(|g| g * g).sum::<f64>().max(1e-3);
            (0..3).for_each(|axis| p[axis] -= value * gradient[axis] / square);
        }
        let point = p.map(|x| x / (WAVES * TAU));
        if value.abs() < 1e-9 && point.iter().all(|x| (0.0..1.0).contains(x)) {
            points.push(point);
        }
    }
    points
}
