//! Threads that take one job after the other.

use std::sync::atomic::{AtomicUsize, Ordering};

use spmesh_core::error::Result;

/// Does `work` on all jobs, about in their order, and hands each result to `finish` on the calling thread. When that
/// fails, or `is_last` of a result, no more jobs are begun; those under way are finished and handed over as well.
///
/// # Errors
/// The first error of `finish`.
pub(super) fn run<Job: Sync, End: Send>(
    threads: usize,
    jobs: &[Job],
    work: impl Fn(&Job) -> End + Sync,
    is_last: impl Fn(&End) -> bool + Sync,
    mut finish: impl FnMut(&Job, End) -> Result<()>,
) -> Result<()> {
    let next = AtomicUsize::new(0);
    let mut result = Ok(());
    std::thread::scope(|scope| {
        let (sender, receiver) = crossbeam_channel::bounded(threads);
        for _ in 0..threads.min(jobs.len()) {
            let (sender, next, work, is_last) = (sender.clone(), &next, &work, &is_last);
            scope.spawn(move || {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let end = work(job);
                    if is_last(&end) {
                        next.store(jobs.len(), Ordering::Relaxed);
                    }
                    if sender.send((job, end)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        for (job, end) in receiver {
            let finished = finish(job, end);
            if finished.is_err() {
                next.store(jobs.len(), Ordering::Relaxed);
            }
            result = std::mem::replace(&mut result, Ok(())).and(finished);
        }
    });
    result
}
