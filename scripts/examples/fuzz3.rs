//! Tries the 3D kernel on random sets, as degenerate as can be thought of, and proves every result with independent exact
//! arithmetic. A set that fails is made as small as possible and written to a file.
//!
//! ```text
//! cargo run --release --example fuzz3 -- --seconds 3600 --seed 1 --threads 1
//! ```
//!
//! The same seed gives the same sets. Set `I` of a seed alone: `--set I`. A few large sets with large cavities: `--large`.

#[path = "../../tests/kernel3/promises.rs"]
mod promises;
#[path = "../../tests/reference/mod.rs"]
#[allow(dead_code, missing_docs)]
mod reference;

use std::borrow::Cow;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::exit;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use reference::clouds::{self, Family};
use reference::sets::Random;
use reference::space::{Point, Space, distinct};
use spmesh::delaunay3::{Kernel, Tetrahedralization};
use spmesh::order::{Curve, Sequence};

/// Fuzzes the 3D kernel.
#[derive(Debug, Parser)]
struct Args {
    /// Wall time, in seconds.
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Seed of all sets.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[arg(long, default_value_t = 1)]
    threads: u64,
    /// Tries this set only.
    #[arg(long)]
    set: Option<u64>,
    /// Tries large sets with large cavities instead.
    #[arg(long)]
    large: bool,
    /// Where a set that fails goes, and the number of the set that is being tried.
    #[arg(long, default_value = "target/fuzz3")]
    out: PathBuf,
    /// Seconds of CPU after which the kernel is said to hang.
    #[arg(long, default_value_t = 60)]
    limit: u64,
}

/// What a thread is at.
#[derive(Debug, Default)]
struct Progress {
    /// The set in the kernel, and since when.
    running: Mutex<Option<(u64, Duration)>>,
    sets: AtomicU64,
    points: AtomicU64,
    tetrahedra: AtomicU64,
}

fn main() {
    let args = Args::parse();
    fs::create_dir_all(&args.out).expect("a folder for sets that fail");
    if let Some(set) = args.set {
        let points = set_of(args.seed, set);
        println!("set {set} of seed {}: {} points", args.seed, points.len());
        write(&args.out, &format!("{}-{set}", args.seed), &points);
        match attempted(set, &points) {
            Ok(()) => println!("proved"),
            Err(message) => fail(&args, set, &points, &message),
        }
    } else if args.large {
        large();
    } else {
        fuzz(&args);
    }
}

/// The points of one set: few in most, because small sets are tried fast and say clearly what is wrong.
fn set_of(seed: u64, set: u64) -> Vec<Point> {
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

/// Tetrahedralizes and proves; says when the kernel is done.
fn attempt(
    kernel: &mut Kernel,
    mesh: &mut Tetrahedralization,
    points: &[Point],
    done: impl FnOnce(),
) -> Result<(), String> {
    kernel.triangulate(Cow::Borrowed(points), mesh).map_err(|error| error.to_string())?;
    done();
    promises::prove(points, mesh)?;
    if points.len() <= 14 {
        let (kept, first) = distinct(points);
        let place =
            |i: u32| kept.iter().position(|p| *p == points[first[i as usize]]).unwrap_or_default() as u32;
        let found = promises::tetrahedra(mesh).into_iter().map(|t| t.map(place));
        if reference::tetrahedra::as_set(found) != Space::new(&kept).tetrahedra() {
            return Err("these are not the tetrahedra by definition".into());
        }
    }
    Ok(())
}

/// Panics are failures.
fn caught(attempt: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(attempt)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        Err(format!("panic: {}", text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("of unknown kind")))
    })
}

/// With a new kernel, which inserts as that of a set does.
fn attempted(set: u64, points: &[Point]) -> Result<(), String> {
    let mut kernel = Kernel::new();
    choose_order(&mut kernel, set);
    caught(|| attempt(&mut kernel, &mut Tetrahedralization::default(), points, || ()))
}

/// The order of insertion of a set: the usual one in half of them.
fn choose_order(kernel: &mut Kernel, set: u64) {
    let mut random = Random::new(set);
    let is_usual = random.integer(0, 1) == 0;
    let [curve, sequence, levels] = [3, 2, 1].map(|last| if is_usual { 0 } else { random.integer(0, last) });
    kernel.curve = Curve::ALL[curve as usize];
    kernel.sequence = [Sequence::Rounds, Sequence::Pass, Sequence::Random { seed: set }][sequence as usize];
    kernel.by_bit_levels = levels == 1;
}

/// Time of all threads on processors: others may keep them busy for minutes.
fn cpu_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // Safety: writes one struct, which is there.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

fn fuzz(args: &Args) {
    let started = Instant::now();
    let progress: Vec<Progress> = (0..args.threads).map(|_| Progress::default()).collect();
    let is_over = AtomicBool::new(false);
    println!("seed {}, {} threads, {} s", args.seed, args.threads, args.seconds);
    std::thread::scope(|scope| {
        for (thread, progress) in (0..).zip(&progress) {
            let is_over = &is_over;
            scope.spawn(move || work(args, thread, progress, is_over));
        }
        let mut reported = 0;
        while started.elapsed().as_secs() < args.seconds {
            std::thread::sleep(Duration::from_secs(1));
            progress.iter().for_each(|progress| watch(args, progress));
            let minutes = started.elapsed().as_secs() / 60;
            if minutes > reported {
                reported = minutes;
                report(&progress, started);
            }
        }
        is_over.store(true, Ordering::Relaxed);
    });
    report(&progress, started);
    println!("no failure");
}

/// Ends the program if a set has been in the kernel for too long.
fn watch(args: &Args, progress: &Progress) {
    let running = *progress.running.lock().expect("no panic while locked");
    let limit = Duration::from_secs(args.limit) * args.threads as u32;
    if let Some((set, _)) = running.filter(|(_, since)| cpu_time() - *since > limit) {
        let points = set_of(args.seed, set);
        println!("set {set} of seed {} hangs: {} points", args.seed, points.len());
        write(&args.out, &format!("hang-{}-{set}", args.seed), &points);
        exit(1);
    }
}

fn report(progress: &[Progress], started: Instant) {
    let sum = |count: fn(&Progress) -> &AtomicU64| -> u64 {
        progress.iter().map(|progress| count(progress).load(Ordering::Relaxed)).sum()
    };
    let (sets, points, tetrahedra) = (sum(|p| &p.sets), sum(|p| &p.points), sum(|p| &p.tetrahedra));
    let (wall, cpu) = (started.elapsed().as_secs(), cpu_time().as_secs());
    println!("{wall} s, {cpu} s of CPU: {sets} sets, {points} points, {tetrahedra} tetrahedra proved");
}

fn work(args: &Args, thread: u64, progress: &Progress, is_over: &AtomicBool) {
    // One kernel for all: nothing of a set may be left for the next.
    let (mut kernel, mut mesh) = (Kernel::new(), Tetrahedralization::default());
    let current = args.out.join(format!("current-{}-{thread}", args.seed));
    let mut set = thread;
    while !is_over.load(Ordering::Relaxed) {
        let points = set_of(args.seed, set);
        // Whatever happens, it is known which set it was.
        fs::write(&current, format!("{set}\n")).expect("a writable folder");
        let tell = |running| *progress.running.lock().expect("no panic while locked") = running;
        choose_order(&mut kernel, set);
        tell(Some((set, cpu_time())));
        let result = caught(|| attempt(&mut kernel, &mut mesh, &points, || tell(None)));
        tell(None);
        if let Err(message) = result {
            fail(args, set, &points, &message);
        }
        progress.sets.fetch_add(1, Ordering::Relaxed);
        progress.points.fetch_add(points.len() as u64, Ordering::Relaxed);
        progress.tetrahedra.fetch_add(mesh.tetrahedra().len() as u64, Ordering::Relaxed);
        set += args.threads;
    }
}

/// Writes a set that fails, and the smallest one found that does, and ends the program.
fn fail(args: &Args, set: u64, points: &[Point], message: &str) -> ! {
    println!("set {set} of seed {} fails, {} points: {message}", args.seed, points.len());
    write(&args.out, &format!("fail-{}-{set}", args.seed), points);
    let small = shrunk(set, points.to_vec());
    match attempted(set, &small) {
        Ok(()) => println!("not with a fresh kernel"),
        Err(message) => println!("{} points do: {message}\nlet points = {small:?};", small.len()),
    }
    write(&args.out, &format!("small-{}-{set}", args.seed), &small);
    exit(1);
}

/// Leaves points out, and takes bits away, as long as the set fails.
fn shrunk(set: u64, mut points: Vec<Point>) -> Vec<Point> {
    std::panic::set_hook(Box::new(|_| {}));
    let fails = |points: &[Point]| attempted(set, points).is_err();
    let mut chunk = points.len() / 2;
    while chunk > 0 {
        let mut start = 0;
        while start < points.len() {
            let mut fewer = points.clone();
            fewer.drain(start..(start + chunk).min(points.len()));
            if fails(&fewer) {
                points = fewer;
            } else {
                start += chunk;
            }
        }
        chunk /= 2;
    }
    for i in 0..3 * points.len() {
        let simpler = |c: f64| [0.0, c.round(), (c * 1e3).round() / 1e3, f64::from(c as f32)];
        for c in simpler(points.as_flattened()[i]) {
            let mut simple = points.clone();
            simple.as_flattened_mut()[i] = c;
            if c.is_finite() && fails(&simple) {
                points = simple;
                break;
            }
        }
    }
    points
}

fn write(folder: &Path, name: &str, points: &[Point]) {
    let lines: String = points.iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}\n")).collect();
    let path = folder.join(format!("{name}.xyz"));
    fs::write(&path, lines).expect("a writable folder");
    println!("written to {}", path.display());
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
