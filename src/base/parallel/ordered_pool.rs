//! Jobs given one at a time, whose results come back in the order of the jobs.

use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;

use crossbeam_channel::{Receiver, Sender, bounded, unbounded};

use super::threads::spawn;
use crate::error::Result;

/// A job, and where its result goes.
type Task<J, R> = (J, Sender<Outcome<R>>);

/// A result, or the payload of a panic.
type Outcome<R> = std::result::Result<R, Box<dyn Any + Send>>;

/// Threads that turn jobs into results. The results come back in the order in which the jobs were given.
///
/// Back-pressure: every job has a weight, such as the bytes that it takes up. The caller gives no further job
/// while [`OrderedPool::is_full`], and takes a result instead.
///
/// Dropping the pool discards jobs that have not begun, and waits for the others.
pub struct OrderedPool<J, R> {
    /// `None` during the drop: without a sender, the threads end.
    jobs: Option<Sender<Task<J, R>>>,
    /// The receiving end, to be emptied in the drop.
    queue: Receiver<Task<J, R>>,
    /// The jobs under way in their order, each with the channel of its result and its weight.
    results: VecDeque<(Receiver<Outcome<R>>, u64)>,
    weight: u64,
    weight_max: u64,
    threads: Vec<JoinHandle<()>>,
}

impl<J: Send + 'static, R: Send + 'static> OrderedPool<J, R> {
    /// Starts `threads` threads. The pool is full when the jobs under way weigh `weight_max` or more.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Io`] if the system refuses a thread.
    pub fn start(
        name: &str,
        threads: usize,
        weight_max: u64,
        work: impl Fn(J) -> R + Send + Sync + 'static,
    ) -> Result<Self> {
        let (jobs, queue) = unbounded::<Task<J, R>>();
        let (results, started) = (VecDeque::new(), Vec::new());
        let mut pool =
            OrderedPool { jobs: Some(jobs), queue, results, weight: 0, weight_max, threads: started };
        let work = Arc::new(work);
        for _ in 0..threads {
            let (queue, work) = (pool.queue.clone(), Arc::clone(&work));
            let run = move || {
                for (job, result) in queue {
                    // Unwind safety: `take` resumes the panic, and the pool is not used afterwards.
                    let outcome = catch_unwind(AssertUnwindSafe(|| work(job)));
                    // Sending fails only while the pool is being dropped.
                    let _ = result.send(outcome);
                }
            };
            pool.threads.push(spawn(name, Box::new(run))?);
        }
        Ok(pool)
    }

    /// Whether the weight of the jobs under way has reached its limit.
    pub fn is_full(&self) -> bool {
        self.weight >= self.weight_max
    }

    /// Gives a job to the next thread that is free.
    pub fn give(&mut self, job: J, weight: u64) {
        let (sender, result) = bounded(1);
        self.weight += weight;
        self.results.push_back((result, weight));
        let jobs = self.jobs.as_ref().expect("the pool takes jobs until the drop");
        jobs.send((job, sender)).expect("the pool holds a receiver");
    }

    /// Waits for the result of the oldest job; `None` if no job is under way.
    ///
    /// # Panics
    /// With the payload of the job, if it panicked.
    pub fn take(&mut self) -> Option<R> {
        let (result, weight) = self.results.pop_front()?;
        self.weight -= weight;
        let outcome = result.recv().expect("a thread sends a result for every job");
        Some(outcome.unwrap_or_else(|panic| resume_unwind(panic)))
    }
}

impl<J, R> OrderedPool<J, R> {
    /// Discards the jobs that have not begun, and joins the threads when they have finished theirs.
    fn close(&mut self) {
        self.jobs = None;
        while self.queue.try_recv().is_ok() {}
    }
}

impl<J, R> Drop for OrderedPool<J, R> {
    fn drop(&mut self) {
        self.close();
        // The threads catch panics of jobs, so that joining them cannot fail.
        self.threads.drain(..).for_each(|thread| drop(thread.join()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn results_come_in_the_order_of_their_jobs() {
        for threads in [1, 2, 5] {
            let work = |job: u64| {
                // Early jobs take longest.
                (0..(50 - job) * 2000).fold(job, |sum, i| std::hint::black_box(sum ^ i ^ i)) * 2
            };
            let mut pool = OrderedPool::start("test", threads, 50, work).unwrap();
            assert_eq!(pool.take(), None);
            (0..50).for_each(|job| pool.give(job, 1));
            let results: Vec<u64> = std::iter::from_fn(|| pool.take()).collect();
            assert_eq!(results, (0..50).map(|job| job * 2).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_weight_of_jobs_under_way_fills_the_pool() {
        let mut pool = OrderedPool::start("test", 2, 10, |job: u64| job).unwrap();
        let mut weights = Vec::new();
        for job in 0..20 {
            while pool.is_full() {
                pool.take().unwrap();
                weights.remove(0);
            }
            pool.give(job, job % 4);
            weights.push(job % 4);
            assert_eq!(pool.weight, weights.iter().sum::<u64>());
            assert!(pool.weight < 10 + 3);
        }
    }

    #[test]
    fn the_drop_gives_up_jobs_that_are_not_begun() {
        let done = Arc::new(AtomicUsize::new(0));
        let (gate, opened) = bounded::<()>(0);
        let count = Arc::clone(&done);
        let work = move |_: u64| {
            let _ = opened.recv();
            count.fetch_add(1, Ordering::SeqCst);
        };
        let mut pool = OrderedPool::start("test", 2, 50, work).unwrap();
        (0..50).for_each(|job| pool.give(job, 1));
        pool.close();
        // Each of the two threads may hold a job by now, and can finish it only from here on.
        drop(gate);
        drop(pool);
        assert!(done.load(Ordering::SeqCst) <= 2);
    }

    #[test]
    fn a_panic_resumes_when_its_result_is_taken() {
        for threads in [1, 2] {
            let work = |job: u64| {
                assert!(job != 1, "of the test");
                job
            };
            let mut pool = OrderedPool::start("test", threads, 3, work).unwrap();
            (0..3).for_each(|job| pool.give(job, 1));
            assert_eq!(pool.take(), Some(0));
            let panic = catch_unwind(AssertUnwindSafe(|| pool.take())).unwrap_err();
            assert_eq!(panic.downcast_ref(), Some(&"of the test"));
            assert_eq!(pool.take(), Some(2));
        }
    }
}
