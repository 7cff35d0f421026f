//! A call again and again while other work goes on.

use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel::{RecvTimeoutError, Sender, bounded};

use super::threads::spawn;
use crate::error::Result;

/// A thread that calls a function at intervals. It ends when this is dropped.
pub struct Ticker {
    /// Nothing is sent: the thread ends when this is gone.
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Ticker {
    /// Calls `work` after every `interval`, on a thread called `name`.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Io`] if the system refuses a thread.
    pub fn start(name: &str, interval: Duration, mut work: impl FnMut() + Send + 'static) -> Result<Ticker> {
        let (stop, stopped) = bounded::<()>(0);
        let run = move || {
            while stopped.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                work();
            }
        };
        Ok(Ticker { stop: Some(stop), thread: Some(spawn(name, Box::new(run))?) })
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        self.stop = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_end_with_the_ticker() {
        let (calls, called) = bounded(0);
        let call = move || {
            // Fails once the receiver is gone.
            let _ = calls.send(());
        };
        let ticker = Ticker::start("test", Duration::ZERO, call).unwrap();
        (0..3).for_each(|_| called.recv().unwrap());
        drop(called);
        drop(ticker);
    }
}
