//! The division of the process's memory.

use spmesh_base::error::{Error, ErrorKind, Result, counted};

/// Memory beside the budget: program, one batch of points, buffers of input and output. Measured on LAZ
/// input: 26 MiB, including two threads.
const PROCESS_RESERVE: u64 = 32 << 20;

/// Memory per thread that decodes input, up to the number of threads that decode at once.
const THREAD_RESERVE: u64 = 6 << 20;
const THREADS_MAX: u64 = 16;

/// Least memory that counters, leaves and waiting points can work with.
const ENGINE_MIN: u64 = 64 << 10;

/// More memory for counters would only make the finest cells smaller than any leaf: this is enough for half a
/// million counters, and several grids coexist. With 32 MiB, 10 million points took 13 MB more.
const COUNTERS_MAX: u64 = 16 << 20;

/// Points of the batches that are under way. Their rows are held twice, alone and in records.
const BATCHES_LEN: u64 = 3 << 14;

/// Memory for counters, leaves and waiting points, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    bytes: u64,
}

impl Budget {
    /// The budget of a process with `total` bytes of memory that decodes its input with `threads` threads.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`] if that is too little.
    pub fn of_process(total: u64, threads: usize) -> Result<Budget> {
        Budget::of_engine(total.saturating_sub(process_reserve(threads))).map_err(|_| {
            Error::new(
                ErrorKind::Memory,
                format!(
                    "a memory budget of {} MiB cannot be kept, the least with {} is {} MiB",
                    total >> 20,
                    counted(threads as u64, "thread", "threads"),
                    Budget::process_min(threads).div_ceil(1 << 20)
                ),
            )
        })
    }

    /// Least memory of a process with `threads` threads, in bytes.
    pub fn process_min(threads: usize) -> u64 {
        process_reserve(threads) + ENGINE_MIN
    }

    /// A budget of `bytes` for counters, leaves and waiting points alone.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`] if it is too little.
    pub fn of_engine(bytes: u64) -> Result<Budget> {
        if bytes < ENGINE_MIN {
            return Err(Error::new(
                ErrorKind::Memory,
                format!("{bytes} bytes for counters and points are too few, the least is {ENGINE_MIN}"),
            ));
        }
        Ok(Budget { bytes })
    }

    /// What is left beside the rows of batches, if points carry rows of `row_len` bytes.
    pub(super) fn beside_rows(self, row_len: usize) -> Result<Budget> {
        let rows = BATCHES_LEN * 2 * row_len as u64;
        Budget::of_engine(self.bytes.saturating_sub(rows)).map_err(|_| {
            Error::new(
                ErrorKind::Memory,
                format!(
                    "attributes of {row_len} bytes need {} MiB more: give more memory, or take fewer",
                    (rows + ENGINE_MIN - self.bytes).div_ceil(1 << 20)
                ),
            )
        })
    }

    /// What is left beside `bytes` that `what` takes; `remedy` is another one than more memory.
    pub(super) fn beside(self, bytes: u64, what: &str, remedy: &str) -> Result<Budget> {
        Budget::of_engine(self.bytes.saturating_sub(bytes)).map_err(|_| {
            let (needed, left) = (bytes.div_ceil(1 << 20), self.bytes >> 20);
            let message = format!("{what} {needed} MiB, and the memory budget leaves {left}");
            Error::new(ErrorKind::Memory, format!("{message}: raise --memory, or {remedy}"))
        })
    }

    /// The whole budget, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Bytes for the counters of one pass whose grid can be made coarser; four such grids may coexist.
    pub(super) fn counters(&self) -> u64 {
        (self.bytes / 8).min(COUNTERS_MAX)
    }

    /// Bytes for the counters of a grid whose level the user fixed.
    pub(super) fn counters_of_fixed_level(&self) -> u64 {
        self.bytes / 2
    }

    /// Bytes for the leaves of the tree and the state of their buffers.
    pub(super) fn leaves(&self) -> u64 {
        self.bytes / 2
    }

    /// Bytes for the table of the locator.
    pub(super) fn table(&self) -> u64 {
        self.bytes / 64
    }
}

fn process_reserve(threads: usize) -> u64 {
    PROCESS_RESERVE + THREAD_RESERVE * (threads as u64).min(THREADS_MAX)
}
