//! Pipes, memory, free space and write-back, as far as the operating system offers them. No result depends on
//! them: if the system refuses a request, the program goes on without it.
//!
//! `libc` serves only where `rustix` has no function: `mallopt`, `signal`, `_exit` and `sync_file_range`.

use std::os::fd::AsFd;
#[cfg(target_os = "linux")]
use std::os::fd::AsRawFd;
use std::path::Path;
use std::sync::OnceLock;

/// Capacity of a widened pipe, in bytes. With the default of 64 KiB, the two ends keep waiting for each
/// other.
#[cfg(target_os = "linux")]
const PIPE_LEN: usize = 1 << 20;

/// Makes a pipe hold 1 MiB. Does nothing if the pipe holds more, the file is no pipe, or the system refuses.
#[cfg(target_os = "linux")]
pub fn widen_pipe(file: &impl AsFd) {
    if rustix::pipe::fcntl_getpipe_size(file).is_ok_and(|len| len < PIPE_LEN) {
        // The system may refuse: the sum of a user's pipes is limited.
        let _ = rustix::pipe::fcntl_setpipe_size(file, PIPE_LEN);
    }
}

/// Does nothing: this system has no call for the capacity of a pipe.
#[cfg(not(target_os = "linux"))]
pub fn widen_pipe(_file: &impl AsFd) {}

/// Size from which a block of memory goes back to the system as soon as it is freed, in bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE_BLOCK: libc::c_int = 1 << 18;

/// From now on, large blocks of memory go back to the system when they are freed. By default, glibc raises
/// its threshold when the first large blocks are freed, and then keeps blocks of that size for each thread.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn give_back_large_blocks() {
    // SAFETY: the call takes integers and only changes where later blocks lie.
    unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE_BLOCK) };
}

/// Does nothing: other systems give large blocks back on their own.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn give_back_large_blocks() {}

/// The message and the exit code of an abort.
static AT_ABORT: OnceLock<(&str, u8)> = OnceLock::new();

/// From now on, an abort prints `message` on stderr and exits with `code`. Rust aborts if it cannot allocate.
/// Only the first call has an effect.
pub fn exit_at_abort(message: &'static str, code: u8) {
    let handler: extern "C" fn(libc::c_int) = exit_with_message;
    if AT_ABORT.set((message, code)).is_ok() {
        // SAFETY: the handler only makes async-signal-safe calls, and does not return.
        unsafe { libc::signal(libc::SIGABRT, handler as libc::sighandler_t) };
    }
}

extern "C" fn exit_with_message(_signal: libc::c_int) {
    let (message, code) = AT_ABORT.get().copied().unwrap_or(("", 1));
    let _ = rustix::io::write(rustix::stdio::stderr(), message.as_bytes());
    // SAFETY: the call ends the process without running anything else in it.
    unsafe { libc::_exit(code.into()) };
}

/// Starts to write `len` bytes of a file from `offset` on to the disk, and does not wait for completion.
#[cfg(target_os = "linux")]
pub(crate) fn start_write_back(file: &impl AsFd, offset: u64, len: u64) {
    let (Ok(offset), Ok(len)) = (offset.try_into(), len.try_into()) else { return };
    // SAFETY: the call takes an open descriptor and integers, and touches no memory of this process.
    unsafe { libc::sync_file_range(file.as_fd().as_raw_fd(), offset, len, libc::SYNC_FILE_RANGE_WRITE) };
}

/// Does nothing: this system has no call that only starts to write.
#[cfg(not(target_os = "linux"))]
pub(crate) fn start_write_back(_file: &impl AsFd, _offset: u64, _len: u64) {}

/// Bytes that can still be written below `folder`; `None` if the system does not tell.
#[must_use]
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let found = rustix::fs::statvfs(folder).ok()?;
    Some(found.f_bavail.saturating_mul(found.f_frsize))
}

/// Bytes of memory that this process can have at most: those of the machine with its swap space, or the limit of
/// the process (`ulimit -v`). `None` if the system does not tell.
#[must_use]
pub fn memory_limit() -> Option<u64> {
    let number = |word: &str| word.parse::<u64>().ok();
    let memory = std::fs::read_to_string("/proc/meminfo").ok()?;
    let entry = |name: &str| {
        let line = memory.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_ascii_whitespace().next().and_then(number)
    };
    let machine = (entry("MemTotal:")? + entry("SwapTotal:").unwrap_or(0)).saturating_mul(1024);
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let process = limits.lines().find_map(|line| line.strip_prefix("Max address space"));
    let process = process.and_then(|rest| rest.split_ascii_whitespace().next().and_then(number));
    Some(process.map_or(machine, |process| machine.min(process)))
}

/// Whether files in `folder` take up memory instead of disk (tmpfs, ramfs); `false` if the system does not
/// tell.
#[cfg(target_os = "linux")]
#[must_use]
pub fn is_in_memory(folder: &Path) -> bool {
    const TMPFS: u32 = 0x0102_1994;
    const RAMFS: u32 = 0x8584_58f6;
    // The width of the field differs between architectures; magic numbers have 32 bits.
    rustix::fs::statfs(folder).is_ok_and(|found| matches!(found.f_type as u32, TMPFS | RAMFS))
}

/// `false`: not determined on this system.
#[cfg(not(target_os = "linux"))]
#[must_use]
pub fn is_in_memory(_folder: &Path) -> bool {
    false
}
