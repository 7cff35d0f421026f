//! How far a kernel has come, and a way to stop it.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Points between two looks at a [`Watch`].
const INTERVAL: usize = 1 << 8;

/// What a kernel and those who wait for it have in common.
#[derive(Debug, Default)]
pub struct Watch {
    inserted: AtomicUsize,
    is_stopped: AtomicBool,
}

// Nothing else goes from thread to thread by these numbers, and they may be seen late.
impl Watch {
    /// Number of points inserted so far, to some hundreds. Those that a kernel must insert twice count
    /// twice.
    pub fn inserted(&self) -> usize {
        self.inserted.load(Ordering::Relaxed)
    }

    /// Makes the kernel give up after some hundreds of points, with [`Error::Stopped`]. What comes before and
    /// after insertion, such as sorting, is not stopped.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    /// # Errors
    /// If the work is to be stopped.
    pub(crate) fn check(watch: Option<&Watch>) -> Result<()> {
        match watch {
            Some(watch) if watch.is_stopped.load(Ordering::Relaxed) => Err(Error::Stopped),
            _ => Ok(()),
        }
    }
}

/// Counts the points that one thread inserts.
#[derive(Debug)]
pub(crate) struct Pace<'w> {
    watch: Option<&'w Watch>,
    until_look: usize,
}

impl<'w> Pace<'w> {
    pub(crate) fn of(watch: Option<&'w Watch>) -> Pace<'w> {
        Pace { watch, until_look: INTERVAL }
    }

    /// Counts a point; returns whether the work is to be stopped.
    #[inline(always)]
    pub(crate) fn is_stopped(&mut self) -> bool {
        self.until_look -= 1;
        self.until_look == 0 && self.look()
    }

    #[cold]
    #[inline(never)]
    fn look(&mut self) -> bool {
        self.until_look = INTERVAL;
        if let Some(watch) = self.watch {
            watch.inserted.fetch_add(INTERVAL, Ordering::Relaxed);
        }
        Watch::check(self.watch).is_err()
    }
}
