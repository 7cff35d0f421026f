//! Threads that take one job after the other.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::Result;

/// Does `work` on all jobs, about in their order, and hands each result to `finish` on the calling thread. When that
/// fails, no more jobs are begun; those under way are finished and handed over as well.
///
/// # Errors
/// The first error of `finish`.
pub(super) fn run<Job: Sync, End: Send>(
    threads: usize,
    jobs: &[Job],
    work: impl Fn(&Job) -> End + Sync,
    mut finish: impl FnMut(&Job, End) -> Result<()>,
) -> Result<()> {
    let next = AtomicUsize::new(0);
    let mut result = Ok(());
    std::thread::scope(|scope| {
        let (sender, receiver) = crossbeam_channel::bounded(threads);
        for _ in 0..threads.min(jobs.len()) {
            let (sender, next, work) = (sender.clone(), &next, &work);
            scope.spawn(move || {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if sender.send((job, work(job))).is_err() {
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
