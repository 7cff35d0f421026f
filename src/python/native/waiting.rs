//! Long work on a thread of its own, while the interpreter looks for signals and hears how far the work is.

use pyo3::prelude::*;
use spmesh_delaunay::{Error, Watch};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Points from which on work may take long: in space its growth may be quadratic.
const LONG: usize = 1_000;

/// Time between two looks.
const PAUSE: Duration = Duration::from_millis(50);

/// Does work on so many points, without the lock of the interpreter. `progress` is called with the share that
/// is done, from 0 to 1; what it raises, or a signal does, stops the work.
pub(crate) fn wait_for<T: Send>(
    py: Python<'_>,
    points: usize,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(Arc<Watch>) -> Result<T, Error> + Send,
) -> PyResult<Result<T, Error>> {
    let watch = Arc::new(Watch::default());
    if points < LONG {
        return Ok(py.detach(|| work(watch)));
    }
    let report = |share: f64| -> PyResult<()> {
        py.check_signals()?;
        progress.map_or(Ok(()), |progress| progress.call1((share,)).map(drop))
    };
    let mut raised = Ok(());
    let work = Mutex::new(Some(work));
    let take = || work.lock().unwrap_or_else(PoisonError::into_inner).take();
    let (sender, receiver) = sync_channel::<()>(1);
    let receiver = Mutex::new(receiver);
    let done = thread::scope(|scope| {
        let watch_of_work = watch.clone();
        let run = move || {
            // Dropped at the end, also of a panic, which wakes the one who waits.
            let _sender = sender;
            take().map(|work| work(watch_of_work))
        };
        let Ok(worker) = thread::Builder::new().spawn_scoped(scope, run) else {
            // The system has no thread for it: nobody looks for signals then.
            return Ok(py.detach(|| take().map(|work| work(watch.clone()))));
        };
        let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(PAUSE);
        while let Err(RecvTimeoutError::Timeout) = py.detach(wait) {
            if raised.is_ok() {
                raised = report((watch.inserted() as f64 / points as f64).min(1.0));
            }
            if raised.is_err() {
                watch.stop();
            }
        }
        worker.join()
    });
    raised?;
    let done = done.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let done = done.expect("work is taken once");
    if done.is_ok() {
        report(1.0)?;
    }
    Ok(done)
}
