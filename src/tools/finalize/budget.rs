//! How the memory of the process is divided.

use spmesh_core::error::{Error, ErrorKind, Result};

/// What the process needs beside the budget: program, one batch of points, buffers of input and output.
/// Measured on LAZ input, with two threads, 26 MiB together with those.
const PROCESS_RESERVE: u64 = 32 << 20;

/// What every thread that decodes input needs, up to the number of threads that decode together.
const THREAD_RESERVE: u64 = 6 << 20;
const THREADS_MAX: u64 = 16;

/// Least memory that counters, leaves and waiting points can work with.
const ENGINE_MIN: u64 = 64 << 10;

/// More memory for counters would only make the finest cells smaller than any leaf: half a million and more of them
/// are known, and several grids of them coexist. With 32 MiB 10 million points took 13 MB more.
const COUNTERS_MAX: u64 = 16 << 20;

/// Memory for counters, leaves and waiting points, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    bytes: u64,
}

impl Budget {
    /// What is left of the memory `total` of a whole process that decodes its input with `threads` threads.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`] if that is too little to work with.
    pub fn of_process(total: u64, threads: usize) -> Result<Budget> {
        Budget::of_engine(total.saturating_sub(process_reserve(threads))).map_err(|_| {
            Error::new(
                ErrorKind::Memory,
                format!(
                    "a memory budget of {} MiB cannot be kept, the least with {threads} threads is {} MiB",
                    total >> 20,
                    Budget::process_min(threads).div_ceil(1 << 20)
                ),
            )
        })
    }

    /// Least memory that a process with `threads` threads can be told to keep to, in bytes.
    #[must_use]
    pub fn process_min(threads: usize) -> u64 {
        process_reserve(threads) + ENGINE_MIN
    }

    /// A budget for counters, leaves and waiting points alone.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`] if it is too little to work with.
    pub fn of_engine(bytes: u64) -> Result<Budget> {
        if bytes < ENGINE_MIN {
            return Err(Error::new(
                ErrorKind::Memory,
                format!("{bytes} bytes for counters and points are too few, the least is {ENGINE_MIN}"),
            ));
        }
        Ok(Budget { bytes })
    }

    /// All of it, in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// For the counters of one pass whose grid can be made coarser; four such passes may coexist.
    pub(super) fn counters(&self) -> u64 {
        (self.bytes / 8).min(COUNTERS_MAX)
    }

    /// For the counters of a grid of a level that the user fixed.
    pub(super) fn counters_of_fixed_level(&self) -> u64 {
        self.bytes / 2
    }

    /// For the leaves of the tree and the state of their buffers.
    pub(super) fn leaves(&self) -> u64 {
        self.bytes / 2
    }

    /// For the table that tells the leaf of a point.
    pub(super) fn table(&self) -> u64 {
        self.bytes / 64
    }
}

fn process_reserve(threads: usize) -> u64 {
    PROCESS_RESERVE + THREAD_RESERVE * (threads as u64).min(THREADS_MAX)
}
