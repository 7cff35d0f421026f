//! Peak memory and processor time of a program.

use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, ExitStatus, Stdio};

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

/// A command for a program of the project: all are beside each other.
pub fn tool(name: &str) -> Command {
    let folder = std::path::Path::new(env!("CARGO_BIN_EXE_spinfo")).parent().expect("a folder");
    Command::new(folder.join(name))
}
