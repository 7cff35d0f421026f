//! The main loop of the fuzzers: threads, a watchdog for sets that hang, and shrinking of failing sets, which
//! are written to a file.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::exit;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Args;

/// The flags of a fuzzer.
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
    /// Tries only this set.
    #[arg(long)]
    set: Option<u64>,
    /// Folder for failing sets and for the numbers of the current sets [default: in Cargo's target folder].
    #[arg(long, default_value_os_t = default_folder(), hide_default_value = true)]
    out: PathBuf,
    /// Seconds of CPU time after which a set counts as hanging.
    #[arg(long, default_value_t = 60)]
    limit: u64,
}

/// A folder named after the program, in Cargo's target folder.
fn default_folder() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let program = std::env::current_exe().unwrap_or_default();
    PathBuf::from(target).join(program.file_name().unwrap_or_else(|| "fuzzing".as_ref()))
}

/// The engine under test. A thread uses one for all its sets, to prove that no state of a set leaks into the
/// next.
pub trait Trial<const D: usize>: Default {
    /// The plural of the counted cells.
    const CELLS: &str;

    /// The points of one set.
    fn points(seed: u64, set: u64) -> Vec<[f64; D]>;

    /// Triangulates points, calls `done`, and proves the result. Returns the number of cells.
    fn attempt(&mut self, set: u64, points: &[[f64; D]], done: impl FnOnce()) -> Result<u64, String>;
}

/// The progress of a thread.
#[derive(Debug, Default)]
struct Progress {
    /// The current set, and its start in CPU time.
    running: Mutex<Option<(u64, Duration)>>,
    sets: AtomicU64,
    points: AtomicU64,
    cells: AtomicU64,
}

impl Fuzzing {
    /// Tries one set, or as many as the time allows. A failure ends the program.
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
            // If the process dies, the file names the set.
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

    /// Writes a failing set and the smallest failing subset found, and ends the program.
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

/// Counts a panic as a failure.
fn caught<Cells>(attempt: impl FnOnce() -> Result<Cells, String>) -> Result<Cells, String> {
    catch_unwind(AssertUnwindSafe(attempt)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        Err(format!("panic: {}", text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("of unknown kind")))
    })
}

/// Tries a set with a fresh engine.
fn attempted<const D: usize, T: Trial<D>>(set: u64, points: &[[f64; D]]) -> Result<u64, String> {
    caught(|| T::default().attempt(set, points, || ()))
}

/// CPU time of all threads. Wall time would count the load of other processes.
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

/// Removes points, and clears bits of coordinates, as long as the set fails.
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
