//! Results of items as they come.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use crossbeam_channel::{Sender, bounded};

use super::threads::{Stop, join, spawn_scoped};
use crate::error::Result;

/// Runs `work` on all items, roughly in their order, and gives each result to `finish` on the calling thread
/// as soon as it is ready. After a result that is a [`ControlFlow::Break`], or an error of `finish`, no
/// further item is begun; items under way are finished, and their results are given to `finish` as well.
///
/// Memory: at most two results per thread that wait for `finish`.
///
/// # Errors
/// The first error of `finish`; [`crate::error::ErrorKind::Io`] if the system refuses a thread.
///
/// # Panics
/// If `work` or `finish` panics.
pub fn for_each_result<T: Sync, R: Send>(
    threads: usize,
    items: &[T],
    work: impl Fn(&T) -> ControlFlow<R, R> + Sync,
    mut finish: impl FnMut(&T, R) -> Result<()>,
) -> Result<()> {
    let threads = threads.clamp(1, items.len().max(1));
    let shared = Shared { items, next: AtomicUsize::new(0), stop: Stop::default() };
    std::thread::scope(|scope| {
        let (results_in, results) = bounded(threads);
        let mut workers = Vec::new();
        let mut outcome = Ok(());
        for number in 0..threads {
            let (results_in, shared, work) = (results_in.clone(), &shared, &work);
            match spawn_scoped(scope, format!("worker {number}"), move || shared.run(work, &results_in)) {
                Ok(worker) => workers.push(worker),
                Err(error) => {
                    shared.stop.set();
                    outcome = Err(error);
                    break;
                }
            }
        }
        drop(results_in);
        for (item, result) in results {
            let finished = finish(item, result);
            if finished.is_err() {
                shared.stop.set();
            }
            outcome = outcome.and(finished);
        }
        workers.into_iter().for_each(join);
        outcome
    })
}

/// The items, and the first that no thread has taken yet.
struct Shared<'a, T> {
    items: &'a [T],
    next: AtomicUsize,
    stop: Stop,
}

impl<'a, T> Shared<'a, T> {
    /// Takes items until none is left, a result is the last one, or the receiver is gone.
    fn run<R>(&self, work: impl Fn(&T) -> ControlFlow<R, R>, results: &Sender<(&'a T, R)>) {
        while let Some(item) = self.next() {
            let result = match self.stop.guard(|| work(item)) {
                ControlFlow::Continue(result) => result,
                ControlFlow::Break(result) => {
                    self.stop.set();
                    result
                }
            };
            if results.send((item, result)).is_err() {
                return;
            }
        }
    }

    fn next(&self) -> Option<&'a T> {
        if self.stop.is_set() {
            return None;
        }
        self.items.get(self.next.fetch_add(1, Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::AtomicUsize;

    const THREADS: [usize; 4] = [0, 1, 2, 5];

    #[test]
    fn every_item_is_done_once() {
        for threads in THREADS {
            for len in [0, 1, 100] {
                let items: Vec<usize> = (0..len).collect();
                let mut results = vec![0; len];
                let work = |&item: &usize| ControlFlow::Continue(2 * item);
                for_each_result(threads, &items, work, |&item, result| {
                    results[item] += result;
                    Ok(())
                })
                .unwrap();
                assert!((0..len).all(|item| results[item] == 2 * item));
            }
        }
    }

    #[test]
    fn the_last_result_is_finished_too() {
        let items: Vec<usize> = (0..1000).collect();
        for threads in THREADS {
            let mut finished = Vec::new();
            let work = |&item: &usize| match item {
                5 => ControlFlow::Break(item),
                _ => ControlFlow::Continue(item),
            };
            for_each_result(threads, &items, work, |_, result| {
                finished.push(result);
                Ok(())
            })
            .unwrap();
            assert!((0..=5).all(|item| finished.contains(&item)));
            if threads <= 1 {
                assert_eq!(finished.len(), 6);
            }
        }
    }

    #[test]
    fn an_error_of_finish_ends_the_work_and_the_first_one_counts() {
        let items: Vec<usize> = (0..100_000).collect();
        for threads in THREADS {
            let begun = AtomicUsize::new(0);
            let work = |&item: &usize| {
                begun.fetch_add(1, Ordering::Relaxed);
                ControlFlow::Continue(item)
            };
            let mut calls = 0;
            let error = for_each_result(threads, &items, work, |_, _| {
                calls += 1;
                Err(Error::usage(format!("call {calls}")))
            });
            assert_eq!(error.unwrap_err().to_string(), "call 1");
            assert_eq!(calls, begun.into_inner(), "results of items under way are finished as well");
        }
    }

    #[test]
    fn a_panic_resumes_with_its_payload() {
        let items: Vec<usize> = (0..8).collect();
        for threads in THREADS {
            let work = |&item: &usize| {
                assert!(item != 3, "of the test");
                ControlFlow::<(), ()>::Continue(())
            };
            let run = || for_each_result(threads, &items, work, |_, ()| Ok(()));
            let panic = catch_unwind(AssertUnwindSafe(run)).unwrap_err();
            assert_eq!(panic.downcast_ref(), Some(&"of the test"));
        }
    }

    #[test]
    fn few_results_wait_for_the_caller() {
        let items = [(); 100];
        let (begun, mut finished) = (AtomicUsize::new(0), 0);
        let work = |(): &()| {
            begun.fetch_add(1, Ordering::SeqCst);
            ControlFlow::Continue(())
        };
        for_each_result(2, &items, work, |(), ()| {
            // Two wait in the channel and each of two threads holds another; this one has been taken out.
            assert!(begun.load(Ordering::SeqCst) <= finished + 5);
            finished += 1;
            Ok(())
        })
        .unwrap();
        assert_eq!(finished, 100);
    }
}
