//! The loop of the programs that try random sets: threads, a watch on sets that take too long, and sets that fail made as
//! small as possible and written to a file.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::exit;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Args;

/// What every such program is told.
#[derive(Debug, Args)]
pub struct Fuzzing {
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
    /// Where a set that fails goes, and the number of the set that is being tried.
    #[arg(long, default_value = concat!("target/", env!("CARGO_BIN_NAME")))]
    out: PathBuf,
    /// Seconds of CPU after which a set is said to hang.
    #[arg(long, default_value_t = 60)]
    limit: u64,
}

/// What is tried; one for all sets of a thread, as nothing of a set may be left for the next.
pub trait Trial<const D: usize>: Default {
    /// What is counted when it is proved.
    const CELLS: &str;

    /// The points of one set.
    fn points(seed: u64, set: u64) -> Vec<[f64; D]>;

    /// Makes something of points, says when that is done, and proves it. Returns how many cells there are.
    fn attempt(&mut self, set: u64, points: &[[f64; D]], done: impl FnOnce()) -> Result<u64, String>;
}

/// What a thread is at.
#[derive(Debug, Default)]
struct Progress {
    /// The set that is being tried, and since when.
    running: Mutex<Option<(u64, Duration)>>,
    sets: AtomicU64,
    points: AtomicU64,
    cells: AtomicU64,
}

impl Fuzzing {
    /// Tries one set, or as many as there is time for. A failure ends the program.
    pub fn run<const D: usize, T: Trial<D>>(&self) {
        fs::create_dir_all(&self.out).expect("a folder for sets that fail");
        let Some(set) = self.set else { return self.fuzz::<D, T>() };
        let points = T::points(self.seed, set);
        println!("set {set} of seed {}: {} points", self.seed, points.len());
        write(&self.out, &format!("{}-{set}", self.seed), &points);
        match attempted::<D, T>(set, &points) {
            Ok(_) => println!("proved"),
            Err(message) => self.fail::<D, T>(set, &points, &message),
        }
    }

    fn fuzz<const D: usize, T: Trial<D>>(&self) {
        let started = Instant::now();
        let progress: Vec<Progress> = (0..self.threads).map(|_| Progress::default()).collect();
        let is_over = AtomicBool::new(false);
        println!("seed {}, {} threads, {} s", self.seed, self.threads, self.seconds);
        std::thread::scope(|scope| {
            for (thread, progress) in (0..).zip(&progress) {
                let is_over = &is_over;
                scope.spawn(move || self.work::<D, T>(thread, progress, is_over));
            }
            let mut reported = 0;
            while started.elapsed().as_secs() < self.seconds {
                std::thread::sleep(Duration::from_secs(1));
                progress.iter().for_each(|progress| self.watch::<D, T>(progress));
                let minutes = started.elapsed().as_secs() / 60;
                if minutes > reported {
                    reported = minutes;
                    report(&progress, started, T::CELLS);
                }
            }
            is_over.store(true, Ordering::Relaxed);
        });
        report(&progress, started, T::CELLS);
        println!("no failure");
    }

    /// Ends the program if a set takes too long.
    fn watch<const D: usize, T: Trial<D>>(&self, progress: &Progress) {
        let running = *progress.running.lock().expect("no panic while locked");
        let limit = Duration::from_secs(self.limit) * self.threads as u32;
        if let Some((set, _)) = running.filter(|(_, since)| cpu_time() - *since > limit) {
            let points = T::points(self.seed, set);
            println!("set {set} of seed {} hangs: {} points", self.seed, points.len());
            write(&self.out, &format!("hang-{}-{set}", self.seed), &points);
            exit(1);
        }
    }

    fn work<const D: usize, T: Trial<D>>(&self, thread: u64, progress: &Progress, is_over: &AtomicBool) {
        let mut trial = T::default();
        let current = self.out.join(format!("current-{}-{thread}", self.seed));
        let mut set = thread;
        while !is_over.load(Ordering::Relaxed) {
            let points = T::points(self.seed, set);
            // Whatever happens, it is known which set it was.
            fs::write(&current, format!("{set}\n")).expect("a writable folder");
            let tell = |running| *progress.running.lock().expect("no panic while locked") = running;
            tell(Some((set, cpu_time())));
            let result = caught(|| trial.attempt(set, &points, || tell(None)));
            tell(None);
            let cells = result.unwrap_or_else(|message| self.fail::<D, T>(set, &points, &message));
            progress.sets.fetch_add(1, Ordering::Relaxed);
            progress.points.fetch_add(points.len() as u64, Ordering::Relaxed);
            progress.cells.fetch_add(cells, Ordering::Relaxed);
            set += self.threads;
        }
    }

    /// Writes a set that fails, and the smallest one found that does, and ends the program.
    fn fail<const D: usize, T: Trial<D>>(&self, set: u64, points: &[[f64; D]], message: &str) -> ! {
        println!("set {set} of seed {} fails, {} points: {message}", self.seed, points.len());
        write(&self.out, &format!("fail-{}-{set}", self.seed), points);
        let small = shrunk::<D, T>(set, points.to_vec());
        match attempted::<D, T>(set, &small) {
            Ok(_) => println!("not with a fresh start"),
            Err(message) => println!("{} points do: {message}\nlet points = {small:?};", small.len()),
        }
        write(&self.out, &format!("small-{}-{set}", self.seed), &small);
        exit(1);
    }
}

/// Panics are failures.
fn caught<Cells>(attempt: impl FnOnce() -> Result<Cells, String>) -> Result<Cells, String> {
    catch_unwind(AssertUnwindSafe(attempt)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        Err(format!("panic: {}", text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("of unknown kind")))
    })
}

/// With nothing left of other sets.
fn attempted<const D: usize, T: Trial<D>>(set: u64, points: &[[f64; D]]) -> Result<u64, String> {
    caught(|| T::default().attempt(set, points, || ()))
}

/// Time of all threads on processors: others may keep them busy for minutes.
fn cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

fn report(progress: &[Progress], started: Instant, name: &str) {
    let sum = |count: fn(&Progress) -> &AtomicU64| -> u64 {
        progress.iter().map(|progress| count(progress).load(Ordering::Relaxed)).sum()
    };
    let (sets, points, cells) = (sum(|p| &p.sets), sum(|p| &p.points), sum(|p| &p.cells));
    let (wall, cpu) = (started.elapsed().as_secs(), cpu_time().as_secs());
    println!("{wall} s, {cpu} s of CPU: {sets} sets, {points} points, {cells} {name} proved");
}

/// Leaves points out, and takes bits away, as long as the set fails.
fn shrunk<const D: usize, T: Trial<D>>(set: u64, mut points: Vec<[f64; D]>) -> Vec<[f64; D]> {
    std::panic::set_hook(Box::new(|_| {}));
    let fails = |points: &[[f64; D]]| attempted::<D, T>(set, points).is_err();
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
    for i in 0..D * points.len() {
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

fn write<const D: usize>(folder: &Path, name: &str, points: &[[f64; D]]) {
    let line = |point: &[f64; D]| point.map(|c| format!("{c:?}")).join(" ") + "\n";
    let path = folder.join(format!("{name}.{}", &"xyzt"[..D]));
    fs::write(&path, points.iter().map(line).collect::<String>()).expect("a writable folder");
    println!("written to {}", path.display());
}
