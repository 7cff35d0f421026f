//! Peak memory and processor time of a program.

use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, ExitStatus, Stdio};

use spmesh_reference::sets::Random;

/// What a program has taken.
#[derive(Debug)]
pub struct Measured {
    /// Exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// What it has written to stderr.
    pub message: String,
    /// Peak memory. Units: MB.
    pub megabytes: f64,
    /// Processor time. Units: seconds.
    pub seconds: f64,
}

impl Measured {
    /// Runs a program without input.
    #[allow(clippy::zombie_processes, reason = "wait4 waits, and says what the child has taken")]
    pub fn of(command: &mut Command) -> Measured {
        let command = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let mut bytes = Vec::new();
        child.stderr.take().expect("stderr is piped").read_to_end(&mut bytes).expect("stderr can be read");
        let (mut status, mut usage) = (0, std::mem::MaybeUninit::<libc::rusage>::zeroed());
        // SAFETY: the child is ours and not yet waited for; both pointers are valid for the call.
        let waited = unsafe { libc::wait4(child.id() as i32, &raw mut status, 0, usage.as_mut_ptr()) };
        assert_eq!(waited, child.id() as i32, "the program ends");
        // SAFETY: all bytes zero are a valid value, and the call has written its own.
        let usage = unsafe { usage.assume_init() };
        let seconds = |time: libc::timeval| time.tv_sec as f64 + time.tv_usec as f64 / 1e6;
        // Linux counts in KiB, others in bytes.
        let unit = if cfg!(target_os = "linux") { 1024.0 } else { 1.0 };
        Measured {
            code: ExitStatus::from_raw(status).code(),
            message: String::from_utf8_lossy(&bytes).into_owned(),
            megabytes: usage.ru_maxrss as f64 * unit / 1e6,
            seconds: seconds(usage.ru_utime) + seconds(usage.ru_stime),
        }
    }
}

/// How many times slower than an idle AMD EPYC this machine is now, at least 1: by the processor time of a
/// task that is always the same. Other programs on the same core double it.
pub fn slowness() -> f64 {
    /// Units: seconds.
    const IDLE: f64 = 0.08;
    let started = thread_time();
    let mut random = Random::new(1);
    let mut numbers: Vec<u64> = (0..1 << 21).map(|_| random.bits()).collect();
    numbers.sort_unstable();
    assert!(std::hint::black_box(&numbers).is_sorted());
    ((thread_time() - started) / IDLE).max(1.0)
}

/// Processor time of this thread. Units: seconds.
fn thread_time() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is valid for the call.
    let result = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    assert_eq!(result, 0, "threads have clocks");
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}

/// A command for a program of the project: all are beside each other.
pub fn tool(name: &str) -> Command {
    let folder = std::path::Path::new(env!("CARGO_BIN_EXE_spinfo")).parent().expect("a folder");
    Command::new(folder.join(name))
}
