//! Work on many items by several threads.

use std::convert::Infallible;
use std::iter::Enumerate;
use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, ScopedJoinHandle};

/// The results of `work` for all items, in the order of the items. Threads take the items one by one; the
/// calling thread is one of `threads`, and the only one if the system refuses others.
///
/// Cost: starts `threads - 1` threads per call; a lock per item. Items are therefore large pieces of work.
///
/// Memory: all results.
///
/// # Errors
/// The error of the first item that fails, in the order of the items, whatever the number of threads.
///
/// # Panics
/// If `work` panics.
pub fn map<I, R: Send, E: Send>(
    threads: NonZeroUsize,
    items: I,
    work: impl Fn(I::Item) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E>
where
    I: IntoIterator<IntoIter: ExactSizeIterator + Send>,
    I::Item: Send,
{
    let items = items.into_iter();
    let threads = threads.get().min(items.len());
    if threads <= 1 {
        return items.map(work).collect();
    }
    let shared = Shared { items: Mutex::new(items.enumerate()), stop: Stop::default() };
    let results = Mutex::new(Vec::new());
    on_threads(threads, &|| {
        let done = shared.run(&work);
        results.lock().unwrap_or_else(PoisonError::into_inner).extend(done);
    });
    let mut done = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_unstable_by_key(|&(at, _)| at);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Does `work` for all items, which cannot fail, as [`map`] does.
///
/// # Panics
/// If `work` panics.
pub fn for_each<I>(threads: NonZeroUsize, items: I, work: impl Fn(I::Item) + Sync)
where
    I: IntoIterator<IntoIter: ExactSizeIterator + Send>,
    I::Item: Send,
{
    let work = |item| {
        work(item);
        Ok::<(), Infallible>(())
    };
    let Ok(_) = map(threads, items, work);
}

/// Calls `run` on the calling thread and `threads - 1` others, or as many as the system allows. Threads are
/// started here and not where the kind of items is known, so that this is compiled once, not for each kind.
fn on_threads(threads: usize, run: &(dyn Fn() + Sync)) {
    thread::scope(|scope| {
        let start = |_| thread::Builder::new().spawn_scoped(scope, run).ok();
        let others: Vec<_> = (1..threads).map_while(start).collect();
        run();
        others.into_iter().for_each(join);
    });
}

/// Items that no thread has taken yet.
struct Shared<I> {
    items: Mutex<Enumerate<I>>,
    stop: Stop,
}

impl<I: Iterator> Shared<I> {
    /// Takes items until none is left or one failed. Items are taken in order, so every item before a failed
    /// one has been taken by then and is finished: the first error does not depend on the threads.
    fn run<R, E>(&self, work: impl Fn(I::Item) -> Result<R, E>) -> Vec<(usize, Result<R, E>)> {
        let mut done = Vec::new();
        while let Some((at, item)) = self.next() {
            let result = self.stop.guard(|| work(item));
            if result.is_err() {
                self.stop.set();
            }
            done.push((at, result));
        }
        done
    }

    fn next(&self) -> Option<(usize, I::Item)> {
        if self.stop.is_set() {
            return None;
        }
        self.items.lock().unwrap_or_else(PoisonError::into_inner).next()
    }
}

/// A flag that tells threads to begin no further item.
#[derive(Debug, Default)]
struct Stop(AtomicBool);

impl Stop {
    fn set(&self) {
        // Only the items carry data between threads; the flag may be seen late.
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Runs one item; a panic stops the others.
    fn guard<T>(&self, work: impl FnOnce() -> T) -> T {
        struct OnPanic<'a>(&'a Stop);
        impl Drop for OnPanic<'_> {
            fn drop(&mut self) {
                if thread::panicking() {
                    self.0.set();
                }
            }
        }
        let _on_panic = OnPanic(self);
        work()
    }
}

/// Waits for a thread.
///
/// # Panics
/// With the payload of the thread, if it panicked.
fn join(thread: ScopedJoinHandle<'_, ()>) {
    thread.join().unwrap_or_else(|panic| resume_unwind(panic));
}
