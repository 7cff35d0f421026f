//! Jobs for several threads, whose results come back in the order in which the jobs were given.

use std::collections::VecDeque;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Receiver, Sender, bounded, unbounded};

use spmesh_core::error::{Error, Result};

type Task<J, R> = (J, Sender<R>);

/// Threads that wait for jobs. The caller bounds how many jobs are under way.
pub(super) struct Ordered<J, R> {
    /// Gone when no more jobs come, which ends the threads.
    jobs: Option<Sender<Task<J, R>>>,
    queue: Receiver<Task<J, R>>,
    results: VecDeque<Receiver<R>>,
    threads: Vec<JoinHandle<()>>,
}

impl<J: Send + 'static, R: Send + 'static> Ordered<J, R> {
    /// Starts `threads` threads that turn jobs into results.
    ///
    /// # Errors
    /// If the system refuses a thread.
    pub(super) fn start(threads: usize, work: impl Fn(J) -> R + Send + Sync + 'static) -> Result<Self> {
        let (jobs, queue) = unbounded::<Task<J, R>>();
        let mut ordered = Ordered { jobs: Some(jobs), queue, results: VecDeque::new(), threads: Vec::new() };
        let work = Arc::new(work);
        for _ in 0..threads {
            let (queue, work) = (ordered.queue.clone(), Arc::clone(&work));
            let run = move || {
                // Nobody waits for the result of a pass that was given up.
                queue.iter().for_each(|(job, result)| drop(result.send(work(job))));
            };
            let thread = thread::Builder::new().name("decoder".into()).spawn(run);
            ordered.threads.push(thread.map_err(|e| Error::io("starting a thread", e))?);
        }
        Ok(ordered)
    }

    /// Gives a job to the next thread that is free.
    pub(super) fn give(&mut self, job: J) {
        let (sender, result) = bounded(1);
        self.results.push_back(result);
        let jobs = self.jobs.as_ref().expect("jobs are taken until the drop");
        jobs.send((job, sender)).expect("the queue has a receiver here");
    }

    /// Waits for the result of the oldest job; `None` if there is none.
    pub(super) fn take(&mut self) -> Option<R> {
        let result = self.results.pop_front()?;
        Some(result.recv().expect("work does not panic"))
    }
}

impl<J, R> Drop for Ordered<J, R> {
    fn drop(&mut self) {
        self.jobs = None;
        while self.queue.try_recv().is_ok() {}
        self.threads.drain(..).for_each(|thread| drop(thread.join()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_their_jobs() {
        for threads in [1, 2, 5] {
            let mut ordered = Ordered::start(threads, |job: u64| {
                // Early jobs take longest.
                (0..(50 - job) * 2000).fold(job, |sum, i| std::hint::black_box(sum ^ i ^ i)) * 2
            })
            .expect("threads start");
            (0..50).for_each(|job| ordered.give(job));
            let results: Vec<u64> = std::iter::from_fn(|| ordered.take()).collect();
            assert_eq!(results, (0..50).map(|job| job * 2).collect::<Vec<_>>());
        }
    }

    #[test]
    fn jobs_without_a_receiver_do_not_block() {
        let mut ordered = Ordered::start(2, |job: u64| job).expect("threads start");
        (0..50).for_each(|job| ordered.give(job));
        assert_eq!(ordered.take(), Some(0));
        drop(ordered);
    }
}
