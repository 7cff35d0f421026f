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
    let run = || shared.run(&work);
    let mut done = std::thread::scope(|scope| {
        let start = |_| std::thread::Builder::new().spawn_scoped(scope, run).ok();
        let others: Vec<_> = (1..threads).map_while(start).collect();
        let mut done = run();
        others.into_iter().for_each(|other| done.extend(join(other)));
        done
    });
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

/// The result of a thread.
///
/// # Panics
/// With the payload of the thread, if it panicked.
fn join<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| resume_unwind(panic))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};

    const THREADS: [usize; 3] = [1, 2, 5];

    fn threads(count: usize) -> NonZeroUsize {
        NonZeroUsize::new(count).unwrap()
    }

    #[test]
    fn results_have_the_order_of_the_items() {
        for count in THREADS {
            for len in [0, 1, 100u64] {
                // Early items take longest.
                let work = |item: u64| {
                    Ok::<_, String>(
                        (0..(len - item) * 1000).fold(item, |a, i| std::hint::black_box(a ^ i ^ i)),
                    )
                };
                let results = map(threads(count), (0..len).collect::<Vec<_>>(), work).unwrap();
                assert_eq!(results, (0..len).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn items_may_be_changed_in_place() {
        for count in THREADS {
            let mut items = [1, 2, 3, 4];
            let add = |item: &mut i32| {
                *item += 1;
                Ok::<(), String>(())
            };
            map(threads(count), &mut items, add).unwrap();
            assert_eq!(items, [2, 3, 4, 5]);
        }
    }

    #[test]
    fn the_first_error_counts_and_ends_the_work() {
        for count in THREADS {
            let begun = AtomicUsize::new(0);
            let work = |item: usize| {
                begun.fetch_add(1, Ordering::Relaxed);
                if item % 10 == 7 { Err(format!("item {item}")) } else { Ok(()) }
            };
            let error = map(threads(count), 0..10_000, work).unwrap_err();
            assert_eq!(error, "item 7");
            if count == 1 {
                assert_eq!(begun.into_inner(), 8);
            }
        }
    }

    #[test]
    fn a_panic_resumes_with_its_payload() {
        for count in THREADS {
            let work = |item: usize| {
                assert!(item != 3, "of the test");
                Ok::<(), String>(())
            };
            let panic = catch_unwind(AssertUnwindSafe(|| map(threads(count), 0..8, work))).unwrap_err();
            assert_eq!(panic.downcast_ref(), Some(&"of the test"));
        }
    }
}
