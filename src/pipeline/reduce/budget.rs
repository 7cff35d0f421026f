//! The memory of a run, estimated from the points that it holds, and its limit.

use super::bulk::Bulk;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::parallel::THREADS_DEFAULT_MAX;

/// Bytes of a point from the stream: coordinates, and room to grow.
const RAW_BYTES: usize = 28;

/// Bytes of a program that holds no points, and of each thread.
const PROGRAM_BYTES: usize = 12 << 20;
const THREAD_BYTES: usize = 4 << 20;

/// Points in memory.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Load {
    /// Points that wait for their cell.
    pub(super) held: usize,
    /// Points in nodes that no node has triangulated yet.
    pub(super) raw: usize,
    /// Points that nodes have left.
    pub(super) left: usize,
}

/// The limit of a run's memory.
///
/// The estimate counts points, so that it does not depend on what else the process did. It is an upper one:
/// the process stays below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    limit: Option<u64>,
    threads: usize,
    /// Bytes of a point from the stream, of one that waits in a residual, and of one that is being
    /// triangulated.
    bytes: [usize; 3],
    /// Points of the largest nodes so far, as many as there are threads: their kernels keep their memory.
    largest: usize,
}

impl Budget {
    /// A limit for points with rows of `row_len` bytes.
    pub(super) fn new<B: Bulk<D>, const D: usize>(
        limit: Option<u64>,
        threads: usize,
        row_len: usize,
    ) -> Self {
        // Rows have room to grow, too, and those of a node are copied into its patches.
        let raw = RAW_BYTES + row_len + row_len / 8;
        let bytes = [raw, B::WAITING_BYTES + row_len, B::KERNEL_BYTES + 2 * row_len];
        Budget { limit, threads: threads.max(1), bytes, largest: 0 }
    }

    /// Whether all `points` of the input fit into one node. The answer is for [`THREADS_DEFAULT_MAX`]: it
    /// decides what is written, which must not depend on the number of threads.
    pub(super) fn holds(&self, points: Option<u64>) -> bool {
        match (self.limit, points) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(_), Some(points)) => {
                let raw = points.min(u64::from(u32::MAX)) as usize;
                let mut budget = Budget { threads: THREADS_DEFAULT_MAX, ..*self };
                budget.check(Load { raw, ..Load::default() }, raw).is_ok()
            }
        }
    }

    /// Checks that points that wait for their cell, those in nodes, and a node of `next` points fit.
    pub(super) fn check(&mut self, Load { held, raw, left }: Load, next: usize) -> Result<()> {
        let Some(limit) = self.limit else { return Ok(()) };
        self.largest = self.largest.max(next);
        let [raw_bytes, left_bytes, kernel_bytes] = self.bytes;
        let kernels = kernel_bytes * (self.largest + (self.threads - 1) * self.largest.min(1 << 16));
        let fixed = PROGRAM_BYTES + self.threads * THREAD_BYTES;
        let needed = (fixed + raw_bytes * (held + raw) + left_bytes * left + kernels) as u64;
        if needed <= limit {
            return Ok(());
        }
        let why = if 4 * fixed as u64 > 3 * limit {
            let alone = format!("--threads {} alone takes {} MiB", self.threads, fixed.div_ceil(1 << 20));
            if self.threads > 1 { alone + ": take fewer" } else { alone }
        } else if held > raw + left {
            format!("{held} points wait for their cell to be complete: finalize them without --preserve")
        } else if next > (raw + left) / 2 {
            format!("{next} points must be triangulated at once, because their simplices reach far")
        } else {
            format!("{} points have simplices that later points may still change", raw + left)
        };
        Err(Error::new(
            ErrorKind::Memory,
            format!(
                "{} MiB are needed and --memory allows {} MiB: {why}",
                needed.div_ceil(1 << 20),
                limit >> 20
            ),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::plane::Plane;
    use super::*;

    #[test]
    fn what_does_not_fit_is_named() {
        let load = |held, raw, left| Load { held, raw, left };
        let mut unlimited = Budget::new::<Plane, 2>(None, 2, 0);
        unlimited.check(load(usize::MAX / 64, 0, 0), 0).expect("no limit");
        let mut budget = Budget::new::<Plane, 2>(Some(64 << 20), 1, 0);
        budget.check(load(1_000_000, 10_000, 0), 10_000).expect("enough");
        let refused = |budget: &mut Budget, load, next| {
            let error = budget.check(load, next).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Memory);
            error.to_string()
        };
        assert!(refused(&mut budget, load(3_000_000, 0, 10_000), 0).contains("--preserve"));
        assert!(refused(&mut budget, load(0, 0, 2_000_000), 10_000).contains("later points"));
        assert!(refused(&mut budget, load(0, 500_000, 0), 500_000).contains("at once"));
        let mut tiny = Budget::new::<Plane, 2>(Some(20 << 20), 2, 0);
        assert!(refused(&mut tiny, load(9_000, 0, 0), 9_000).contains("take fewer"));
        assert!(refused(&mut budget, Load::default(), 0).contains("MiB"), "kernels keep their memory");
        assert!(unlimited.holds(None) && !budget.holds(None));
        let holds = |threads, points| Budget::new::<Plane, 2>(Some(1 << 30), threads, 0).holds(points);
        assert!([1, 8, 64].map(|threads| holds(threads, Some(100_000))) == [true; 3]);
        assert!([1, 8, 64].map(|threads| holds(threads, Some(9_000_000))) == [false; 3]);
        assert!(!holds(1, Some(u64::MAX)));
    }
}
