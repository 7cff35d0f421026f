//! Tries the inputs of a seed one after the other, for a given time. Writes an input that fails to a file,
//! shrinks it, and writes the result, too.

use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use spmesh_fuzz::mutation::Inputs;
use spmesh_fuzz::{TARGETS, Target, target};

/// Fuzzes readers and kernels with mutants of sample files.
///
/// The same seed gives the same inputs. Kernels also have fuzzers that generate degenerate sets: the examples
/// fuzz3 and fuzz4.
#[derive(Debug, Parser)]
#[command(name = "scripts/fuzz")]
struct Flags {
    /// Targets; all if none is named.
    targets: Vec<String>,
    /// Wall time for each target.
    #[arg(long, default_value_t = 60, value_name = "N")]
    seconds: u64,
    /// Inputs of each target, instead of a time.
    #[arg(long, value_name = "N", conflicts_with = "seconds")]
    inputs: Option<u64>,
    /// Seed of all inputs.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Number of the first input.
    #[arg(long, default_value_t = 0, value_name = "I")]
    first: u64,
    /// Tries this file only.
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Processor time after which an input counts as hanging, in seconds.
    #[arg(long, default_value_t = 60, value_name = "N")]
    limit: u64,
    /// Most memory, in MiB; an input that needs more ends the program.
    #[arg(long, default_value_t = 2048, value_name = "N")]
    memory: u64,
    /// Folder for inputs that fail.
    #[arg(long, default_value = "target/fuzz", value_name = "FOLDER")]
    out: PathBuf,
    /// Lists the targets.
    #[arg(long)]
    list: bool,
}

/// Start of the current input, in milliseconds of processor time; 0 between inputs.
static BEGAN_MS: AtomicU64 = AtomicU64::new(0);

fn main() -> ExitCode {
    let flags = Flags::parse();
    if flags.list {
        TARGETS.iter().for_each(|target| println!("{}", target.name));
        return ExitCode::SUCCESS;
    }
    let mut targets = Vec::new();
    for name in &flags.targets {
        let Some(found) = target(name) else {
            eprintln!("there is no target {name}; --list names all");
            return ExitCode::from(2);
        };
        targets.push(found);
    }
    if targets.is_empty() {
        targets = TARGETS.to_vec();
    }
    fs::create_dir_all(&flags.out).expect("a folder for inputs that fail");
    bound_memory(flags.memory);
    watch(flags.limit);
    let is_fine = match &flags.file {
        Some(file) => {
            let bytes = fs::read(file).expect("a file that can be read");
            targets.iter().all(|target| passes(target, &bytes))
        }
        None => targets.iter().all(|target| fuzz(target, &flags)),
    };
    if is_fine { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Whether the target handles the bytes without a panic.
fn passes(target: &Target, bytes: &[u8]) -> bool {
    panic::catch_unwind(AssertUnwindSafe(|| target.run(bytes))).is_ok()
}

/// Tries inputs until time is up; false if one fails.
fn fuzz(target: &Target, flags: &Flags) -> bool {
    let inputs = Inputs::new(target.samples, flags.seed);
    let current = flags.out.join(format!("current-{}", target.name));
    let (end, mut number) = (Instant::now() + Duration::from_secs(flags.seconds), flags.first);
    let goes_on = |number| match flags.inputs {
        Some(inputs) => number - flags.first < inputs,
        None => Instant::now() < end,
    };
    while goes_on(number) {
        let bytes = inputs.input(number);
        // The file remains if the process ends: by the watchdog, or because memory ran out.
        fs::write(&current, &bytes).expect("a writable folder");
        BEGAN_MS.store(processor_ms() + 1, Ordering::Relaxed);
        let is_fine = passes(target, &bytes);
        BEGAN_MS.store(0, Ordering::Relaxed);
        if !is_fine {
            println!("{}: input {number} of seed {} fails", target.name, flags.seed);
            report(target, bytes, &flags.out.join(format!("{}-{}-{number}", target.name, flags.seed)));
            return false;
        }
        number += 1;
    }
    drop(fs::remove_file(&current));
    println!("{}: {} inputs of seed {}, no failure", target.name, number - flags.first, flags.seed);
    true
}

/// Writes a failing input and the smallest failing input found.
fn report(target: &Target, bytes: Vec<u8>, path: &Path) {
    fs::write(path, &bytes).expect("a writable folder");
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let small = shrunk(target, bytes);
    panic::set_hook(hook);
    let small_path = path.with_extension("small");
    fs::write(&small_path, &small).expect("a writable folder");
    println!("written to {} and, {} bytes of it, to {}", path.display(), small.len(), small_path.display());
}

/// Removes pieces as long as the input fails.
fn shrunk(target: &Target, mut bytes: Vec<u8>) -> Vec<u8> {
    let mut piece = bytes.len() / 2;
    while piece > 0 {
        let mut start = 0;
        while start < bytes.len() {
            let mut fewer = bytes.clone();
            fewer.drain(start..(start + piece).min(bytes.len()));
            if passes(target, &fewer) {
                start += piece;
            } else {
                bytes = fewer;
            }
        }
        piece /= 2;
    }
    bytes
}

/// Ends the program when an input takes longer than `limit` seconds.
fn watch(limit: u64) {
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let (began, now) = (BEGAN_MS.load(Ordering::Relaxed), processor_ms());
            if began > 0 && now.saturating_sub(began) > 1000 * limit {
                eprintln!("an input takes more than {limit} s; it is the file current-TARGET");
                std::process::exit(1);
            }
        }
    });
}

/// Processor time of the program. Other programs may use the processor, so the time of a clock says little.
/// Units: milliseconds.
fn processor_ms() -> u64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the structure is valid, and the call writes nothing else.
    let code = unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    assert_eq!(code, 0, "the system tells processor time");
    time.tv_sec as u64 * 1000 + time.tv_nsec as u64 / 1_000_000
}

/// Limits the address space of the program, so that allocations beyond it fail. Units: MiB.
fn bound_memory(mebibytes: u64) {
    let bytes = mebibytes << 20;
    let limit = libc::rlimit { rlim_cur: bytes, rlim_max: bytes };
    // SAFETY: the limit is a valid structure, and the call reads nothing else.
    let code = unsafe { libc::setrlimit(libc::RLIMIT_AS, &raw const limit) };
    assert_eq!(code, 0, "the limit of memory can be set");
}
