//! What the system can be asked and told about pipes, files and folders. Nothing here is needed for a right
//! result, so that what a system refuses is left as it is.

use std::ffi::CString;
use std::os::fd::{AsFd, AsRawFd};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::sync::OnceLock;

/// Bytes that a pipe holds where the system allows it; by default it is 64 KiB, and both ends wait for each other
/// all the time.
#[cfg(target_os = "linux")]
const PIPE_LEN: libc::c_int = 1 << 20;

/// Makes a pipe hold 1 MiB, unless it holds more or is none, or the system refuses.
#[cfg(target_os = "linux")]
pub fn widen_pipe(file: &impl AsFd) {
    let descriptor = file.as_fd().as_raw_fd();
    // SAFETY: both calls take an open descriptor and integers, and touch no memory of this process.
    unsafe {
        let len = libc::fcntl(descriptor, libc::F_GETPIPE_SZ);
        if (1..PIPE_LEN).contains(&len) {
            libc::fcntl(descriptor, libc::F_SETPIPE_SZ, PIPE_LEN);
        }
    }
}

/// Makes a pipe hold 1 MiB, unless it holds more or is none, or the system refuses.
#[cfg(not(target_os = "linux"))]
pub fn widen_pipe(_file: &impl AsFd) {}

/// Bytes of a block of memory that goes back to the system as soon as it is freed.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE_BLOCK: libc::c_int = 1 << 18;

/// From now on, large blocks of memory go back to the system when they are freed. glibc otherwise learns from the first
/// of them that are freed to keep such blocks, for each thread.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn give_back_large_blocks() {
    // SAFETY: the call takes integers and changes nothing but where later blocks lie.
    unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE_BLOCK) };
}

/// From now on, large blocks of memory go back to the system when they are freed, as other systems do it unasked.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn give_back_large_blocks() {}

/// What is said, and the exit code, where the process would abort.
static AT_ABORT: OnceLock<(&str, u8)> = OnceLock::new();

/// From now on, says `message` on stderr and exits with `code` where the process would abort, which Rust does when it
/// cannot have the memory that it needs. The first call counts.
pub fn exit_at_abort(message: &'static str, code: u8) {
    let handler: extern "C" fn(libc::c_int) = exit_with_message;
    if AT_ABORT.set((message, code)).is_ok() {
        // SAFETY: the handler only makes calls that are allowed in one, and does not return.
        unsafe { libc::signal(libc::SIGABRT, handler as libc::sighandler_t) };
    }
}

extern "C" fn exit_with_message(_signal: libc::c_int) {
    let (message, code) = AT_ABORT.get().copied().unwrap_or(("", 1));
    // SAFETY: the message is as long as it says, and nothing of this process runs after the second call.
    unsafe {
        libc::write(libc::STDERR_FILENO, message.as_ptr().cast(), message.len());
        libc::_exit(code.into());
    }
}

/// Starts to write `len` bytes of a file from `offset` on to the disk, and does not wait for it.
#[cfg(target_os = "linux")]
pub(crate) fn start_write_back(file: &impl AsFd, offset: u64, len: u64) {
    let (Ok(offset), Ok(len)) = (offset.try_into(), len.try_into()) else { return };
    // SAFETY: the call takes an open descriptor and integers, and touches no memory of this process.
    unsafe { libc::sync_file_range(file.as_fd().as_raw_fd(), offset, len, libc::SYNC_FILE_RANGE_WRITE) };
}

/// Starts to write `len` bytes of a file from `offset` on to the disk, and does not wait for it.
#[cfg(not(target_os = "linux"))]
pub(crate) fn start_write_back(_file: &impl AsFd, _offset: u64, _len: u64) {}

/// Bytes that can still be written below `folder`, if the system tells.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let path = CString::new(folder.as_os_str().as_bytes()).ok()?;
    let mut found = std::mem::MaybeUninit::<libc::statvfs>::uninit();
    // SAFETY: the path is NUL-terminated and the structure as long as the call expects; both outlive it.
    if unsafe { libc::statvfs(path.as_ptr(), found.as_mut_ptr()) } != 0 {
        return None;
    }
    // SAFETY: the call succeeded, so it filled the structure.
    let found = unsafe { found.assume_init() };
    #[allow(clippy::unnecessary_cast, reason = "the widths of the fields differ between systems")]
    Some((found.f_bavail as u64).saturating_mul(found.f_frsize as u64))
}

/// Whether files in `folder` take up memory instead of disk (tmpfs, ramfs), as far as the system tells.
#[cfg(target_os = "linux")]
pub fn is_in_memory(folder: &Path) -> bool {
    const TMPFS: u32 = 0x0102_1994;
    const RAMFS: u32 = 0x8584_58f6;
    let Ok(path) = CString::new(folder.as_os_str().as_bytes()) else { return false };
    let mut found = std::mem::MaybeUninit::<libc::statfs>::uninit();
    // SAFETY: the path is NUL-terminated and the structure as long as the call expects; both outlive it.
    if unsafe { libc::statfs(path.as_ptr(), found.as_mut_ptr()) } != 0 {
        return false;
    }
    // SAFETY: the call succeeded, so it filled the structure.
    let kind = unsafe { found.assume_init() }.f_type as u32;
    kind == TMPFS || kind == RAMFS
}

/// Whether files in `folder` take up memory instead of disk (tmpfs, ramfs), as far as the system tells.
#[cfg(not(target_os = "linux"))]
pub(crate) fn is_in_memory(_folder: &Path) -> bool {
    false
}
