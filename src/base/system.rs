//! Pipes, memory, free space and write-back, as far as the operating system offers them. No result depends on
//! them: if the system refuses a request, the program goes on without it.
//!
//! `libc` serves only where `rustix` has no function (`mallopt`, `getrlimit`, `signal`, `_exit`,
//! `sync_file_range`), and before `main`.

use std::hint::black_box;
use std::os::fd::{AsFd, AsRawFd};
use std::path::Path;
use std::ptr;
#[cfg(target_os = "linux")]
use std::sync::atomic::AtomicU8;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};

use crate::upstream;

/// Which of the descriptors 0, 1 and 2 were closed when the program started, one bit each.
#[cfg(target_os = "linux")]
static CLOSED_AT_START: AtomicU8 = AtomicU8::new(0);

/// The loader calls the functions of this section before `main`. Later is too late: the start of Rust's
/// runtime opens /dev/null in place of closed descriptors.
// SAFETY: the section holds pointers to functions; the C library calls them with up to three arguments, which
// a function of the C calling convention may ignore.
#[cfg(target_os = "linux")]
#[used]
#[unsafe(link_section = ".init_array")]
static AT_START: extern "C" fn() = record_closed;

/// Only makes system calls: nothing of Rust's runtime is ready.
#[cfg(target_os = "linux")]
extern "C" fn record_closed() {
    for descriptor in 0..3 {
        // SAFETY: the call takes integers, and only reads flags.
        if unsafe { libc::fcntl(descriptor, libc::F_GETFD) } < 0 {
            CLOSED_AT_START.fetch_or(1 << descriptor, Ordering::Relaxed);
        }
    }
}

/// Whether stdin, stdout or stderr was closed when the program started (`>&-` in a shell). Then its data
/// would be lost in /dev/null without an error. `false` for other descriptors.
#[cfg(target_os = "linux")]
pub fn was_closed(standard: &impl AsRawFd) -> bool {
    let descriptor = standard.as_raw_fd();
    (0..3).contains(&descriptor) && CLOSED_AT_START.load(Ordering::Relaxed) & (1 << descriptor) != 0
}

/// `false`: not determined on this system.
#[cfg(not(target_os = "linux"))]
pub fn was_closed(_standard: &impl AsRawFd) -> bool {
    false
}

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

/// Free memory at the end of a heap that stays with the process, in bytes: decoders of LAZ and nodes of a
/// reduction allocate it again and again.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT_LEN: libc::c_int = 4 << 20;

/// From now on, large blocks of memory go back to the system when they are freed. By default, glibc raises
/// its threshold when the first large blocks are freed, and then keeps blocks of that size for each thread.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn give_back_large_blocks() {
    // SAFETY: the calls take integers and only change where later blocks lie and which free memory is kept.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE_BLOCK);
        libc::mallopt(libc::M_TRIM_THRESHOLD, KEPT_LEN);
    }
}

/// Does nothing: other systems give large blocks back on their own.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn give_back_large_blocks() {}

/// Makes all threads share one heap. By default, glibc gives each a heap of its own, where what another
/// thread frees leaves gaps. For programs that allocate rarely: threads wait for each other.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn share_heap() {
    // SAFETY: the call takes integers and only changes where later blocks lie.
    unsafe { libc::mallopt(libc::M_ARENA_MAX, 1) };
}

/// Does nothing: other systems have heaps of their own kind.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn share_heap() {}

/// If the address space of the process is limited (`ulimit -v`), makes threads share one heap. By default,
/// glibc reserves 64 MiB of address space for the heap of each thread, used or not.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn save_address_space() {
    let mut limit = libc::rlimit { rlim_cur: libc::RLIM_INFINITY, rlim_max: libc::RLIM_INFINITY };
    // SAFETY: the call writes to the struct only.
    let code = unsafe { libc::getrlimit(libc::RLIMIT_AS, &raw mut limit) };
    if code == 0 && limit.rlim_cur != libc::RLIM_INFINITY {
        share_heap();
    }
}

/// Does nothing: other systems reserve no heaps.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn save_address_space() {}

/// From now on, a write beyond the largest file that this process may make (`ulimit -f`) fails as on a full
/// disk. Without this call a signal ends the process without a message.
#[cfg(unix)]
pub fn report_large_files() {
    // SAFETY: ignoring a signal runs no code.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Does nothing: other systems have no such limit.
#[cfg(not(unix))]
pub fn report_large_files() {}

/// Memory of a compressor of deflate, and of a decompressor, or more. Units: bytes.
const DEFLATE_LEN: usize = 1 << 19;
const INFLATE_LEN: usize = 1 << 18;

/// Fails like an allocation if there is no memory to compress: `zlib-rs` would panic.
pub fn expect_deflate_memory() {
    drop(black_box(Vec::<u8>::with_capacity(DEFLATE_LEN)));
}

/// Fails like an allocation if there is no memory to decompress, likewise.
pub fn expect_inflate_memory() {
    drop(black_box(Vec::<u8>::with_capacity(INFLATE_LEN)));
}

/// The message and the exit code of an abort.
type Farewell = (&'static str, u8);

/// Whether a thread has begun to end the program.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// Null, or a value that is never freed: the handler may read it at any time.
static AT_ABORT: AtomicPtr<Farewell> = AtomicPtr::new(ptr::null_mut());

/// From now on, an abort prints `message` on stderr and exits with `code`. Rust aborts if it cannot allocate.
/// A program first calls this without advice, and again when it knows what to advise: each call takes some
/// bytes for good.
pub fn exit_at_abort(message: &'static str, code: u8) {
    let handler: extern "C" fn(libc::c_int) = exit_with_message;
    let is_first = AT_ABORT.swap(Box::leak(Box::new((message, code))), Ordering::AcqRel).is_null();
    // SAFETY: the handler only makes async-signal-safe calls, and does not return.
    unsafe { libc::signal(libc::SIGABRT, handler as libc::sighandler_t) };
    if is_first {
        exit_at_panic_without_memory();
    }
}

/// How the panic of a thread begins for whose signals the system has no stack.
const NO_SIGNAL_STACK: &str = "failed to allocate an alternative stack";

/// Ends the program, likewise, when the standard library panics because a new thread finds no memory.
fn exit_at_panic_without_memory() {
    let others = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let message = panic.payload().downcast_ref::<String>();
        if message.is_some_and(|message| message.starts_with(NO_SIGNAL_STACK)) {
            exit_without_memory();
        }
        others(panic);
    }));
}

/// Ends the program as an abort would, after [`exit_at_abort`]; before that, returns.
pub(crate) fn exit_without_memory() {
    if !AT_ABORT.load(Ordering::Acquire).is_null() {
        exit_with_message(libc::SIGABRT);
    }
}

extern "C" fn exit_with_message(_signal: libc::c_int) {
    // Of several threads that end the program, one says why.
    if IS_ENDING.swap(true, Ordering::Relaxed) {
        loop {
            // SAFETY: the call only waits.
            unsafe { libc::pause() };
        }
    }
    // SAFETY: the pointer is null or was leaked.
    let (message, code) = unsafe { AT_ABORT.load(Ordering::Acquire).as_ref() }.copied().unwrap_or(("", 1));
    let _ = rustix::io::write(rustix::stdio::stderr(), message.as_bytes());
    upstream::mark_failure(code);
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

/// Processor time of all threads of this process so far, in seconds.
pub fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// The name of this machine.
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// Lets the peak memory of this process start again from what it uses now, where the system can do that.
pub fn reset_peak_memory() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Peak resident memory of this process in bytes; 0 where the system does not tell.
pub fn peak_memory() -> u64 {
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else { return 0 };
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// Bytes that can still be written below `folder`; `None` if the system does not tell.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let found = rustix::fs::statvfs(folder).ok()?;
    Some(found.f_bavail.saturating_mul(found.f_frsize))
}

/// Bytes of memory that this process can have at most: those of the machine with its swap space, or the limit
/// of the process (`ulimit -v`). `None` if the system does not tell.
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
pub fn is_in_memory(folder: &Path) -> bool {
    const TMPFS: u32 = 0x0102_1994;
    const RAMFS: u32 = 0x8584_58f6;
    // The width of the field differs between architectures; magic numbers have 32 bits.
    rustix::fs::statfs(folder).is_ok_and(|found| matches!(found.f_type as u32, TMPFS | RAMFS))
}

/// `false`: not determined on this system.
#[cfg(not(target_os = "linux"))]
pub fn is_in_memory(_folder: &Path) -> bool {
    false
}
