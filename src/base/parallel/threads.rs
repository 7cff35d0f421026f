//! Starting and joining threads.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, Builder, JoinHandle, Scope, ScopedJoinHandle};

use crate::error::{Error, Result};

/// Threads that the system runs at once: the cores that this process may use, or 1 if the system does not
/// tell.
pub fn available_threads() -> NonZeroUsize {
    thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// Most threads of a run that is not told how many to use. Each costs memory, so more must be requested.
pub const THREADS_DEFAULT_MAX: usize = 8;

/// Starts a named thread that ends within `scope`.
///
/// # Errors
/// [`crate::error::ErrorKind::Io`] if the system refuses a thread.
pub fn spawn_scoped<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    name: impl Into<String>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Result<ScopedJoinHandle<'scope, T>> {
    // What starts a thread is compiled for each type of result, not for each kind of work.
    let work: Box<dyn FnOnce() -> T + Send + 'scope> = Box::new(work);
    Builder::new().name(name.into()).spawn_scoped(scope, work).map_err(no_thread)
}

/// Starts a named thread that may outlive the caller.
pub(super) fn spawn(name: &str, work: Box<dyn FnOnce() + Send>) -> Result<JoinHandle<()>> {
    Builder::new().name(name.into()).spawn(work).map_err(no_thread)
}

/// The result of a thread.
///
/// # Panics
/// With the payload of the thread, if it panicked.
pub(super) fn join<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| resume_unwind(panic))
}

/// A flag that tells threads to begin no further item.
#[derive(Debug, Default)]
pub(super) struct Stop(AtomicBool);

impl Stop {
    pub(super) fn set(&self) {
        // Only the items carry data between threads; the flag may be seen late.
        self.0.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Runs one item; a panic stops the others.
    pub(super) fn guard<T>(&self, work: impl FnOnce() -> T) -> T {
        on_panic(|| self.set(), work)
    }
}

/// Calls `end` if `work` panics, so that other threads do not wait for it.
pub(super) fn on_panic<T>(end: impl Fn(), work: impl FnOnce() -> T) -> T {
    struct OnPanic<F: Fn()>(F);
    impl<F: Fn()> Drop for OnPanic<F> {
        fn drop(&mut self) {
            if thread::panicking() {
                self.0();
            }
        }
    }
    let _on_panic = OnPanic(end);
    work()
}

fn no_thread(cause: std::io::Error) -> Error {
    Error::io("starting a thread (take fewer --threads, or allow more threads or memory)", cause)
}
