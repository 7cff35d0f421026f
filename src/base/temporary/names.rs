//! Names of incomplete files, which are removed if a signal ends the process.

use std::ffi::CString;
use std::mem::MaybeUninit;
use std::os::raw::c_char;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

/// Most names at a time; a program has a few outputs. A signal leaves further files behind.
const NAMES_MAX: usize = 64;

/// Null, or a name that is never freed: the handler may read it at any time.
static NAMES: [AtomicPtr<c_char>; NAMES_MAX] = [const { AtomicPtr::new(ptr::null_mut()) }; NAMES_MAX];

/// The name of an incomplete file. While this value exists, a signal removes the file; see
/// [`remove_names_at_signals`].
#[derive(Debug)]
pub(crate) struct Name(Option<usize>);

impl Name {
    /// The name `path`; there need not be a file yet. Each call takes the bytes of the name for good.
    pub(crate) fn new(path: &Path) -> Name {
        let Ok(path) = CString::new(path.as_os_str().as_bytes()) else { return Name(None) };
        let path = path.into_raw();
        let is_free = |slot: &AtomicPtr<c_char>| {
            slot.compare_exchange(ptr::null_mut(), path, Ordering::AcqRel, Ordering::Relaxed).is_ok()
        };
        Name(NAMES.iter().position(is_free))
    }
}

impl Drop for Name {
    fn drop(&mut self) {
        if let Some(slot) = self.0 {
            NAMES[slot].store(ptr::null_mut(), Ordering::Release);
        }
    }
}

/// From now on, an interrupt (Ctrl-C), a request to terminate, and the end of the terminal remove incomplete
/// files with names before they end the process as they would otherwise. Those of these signals that are
/// ignored, as after `nohup`, stay ignored.
pub fn remove_names_at_signals() {
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
        if is_ignored(signal) {
            continue;
        }
        let handler: extern "C" fn(libc::c_int) = remove_names;
        // SAFETY: the handler only makes async-signal-safe calls.
        unsafe { libc::signal(signal, handler as libc::sighandler_t) };
    }
}

/// Asks without a change: a signal that was not ignored for a moment could end the process.
fn is_ignored(signal: libc::c_int) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: the pointer is valid for the call, which changes nothing else.
    let result = unsafe { libc::sigaction(signal, ptr::null(), action.as_mut_ptr()) };
    // SAFETY: all bytes zero are a valid value, and the call may have written its own.
    let action = unsafe { action.assume_init() };
    result == 0 && action.sa_sigaction == libc::SIG_IGN
}

extern "C" fn remove_names(signal: libc::c_int) {
    for name in &NAMES {
        let name = name.load(Ordering::Acquire);
        if !name.is_null() {
            // SAFETY: the name ends with a zero byte and is never freed.
            unsafe { libc::unlink(name) };
        }
    }
    // SAFETY: both calls take integers. The signal is delivered again when the handler returns.
    unsafe {
        libc::signal(signal, libc::SIG_DFL);
        libc::raise(signal);
    }
}
