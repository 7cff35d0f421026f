//! The memory of a run, estimated from the points that it holds, and its limit.

use super::bulk::Bulk;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::parallel::THREADS_DEFAULT_MAX;

/// Bytes of a point from the stream: coordinates, and room to grow.
const RAW_BYTES: usize = 28;

/// Bytes of a program that holds no points, and of each thread.
const PROGRAM_BYTES: usize = 12 << 20;
const THREAD_BYTES: usize = 4 << 20;

/// Bytes of a node that waits for its parent, here, in the plan and in the output, beside its points; of a
/// range of final cells; and of a wall, of which a point that is left has a few anyway.
const NODE_BYTES: usize = 640;
const RANGE_BYTES: usize = 40;
const WALL_BYTES: usize = 48;
const WALLS_PER_POINT: usize = 4;

/// What waits for its cell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Held {
    pub(super) points: usize,
    /// Bytes of the points of other cells than the next.
    pub(super) buckets: usize,
    /// Ranges of final cells.
    pub(super) ranges: usize,
}

/// What is in memory.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Load {
    pub(super) held: Held,
    /// Points in nodes that no node has triangulated yet.
    pub(super) raw: usize,
    /// Points that nodes have left, and their walls.
    pub(super) left: usize,
    pub(super) walls: usize,
    /// Nodes that wait for their parent.
    pub(super) nodes: usize,
    /// Bytes of patches that wait to be written, beyond what points usually have.
    pub(super) patches: usize,
}

impl Load {
    /// Bytes of cells.
    fn cells(&self) -> usize {
        NODE_BYTES * self.nodes + RANGE_BYTES * self.held.ranges
    }

    /// Bytes of walls beyond those that points usually have.
    fn walls_beyond(&self) -> usize {
        WALL_BYTES * self.walls.saturating_sub(WALLS_PER_POINT * self.left)
    }
}

/// The limit of a run's memory.
///
/// The estimate counts what the input can make many of, so that it does not depend on what else the process
/// did. It is an upper one: the process stays below it.
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

    /// The same limit for nodes of so many bytes for each point that is being triangulated, all of which are
    /// given together: their kernels keep no memory.
    pub(super) fn of_kernels(self, bytes: usize, row_len: usize) -> Budget {
        let [raw, waiting, _] = self.bytes;
        Budget { bytes: [raw, waiting, bytes + 2 * row_len], largest: 0, ..self }
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

    /// Checks that what waits, what is in nodes, and a node of `next` points fit. Returns what is left, in
    /// bytes.
    pub(super) fn check(&mut self, load: Load, next: usize) -> Result<u64> {
        let Some(limit) = self.limit else { return Ok(u64::MAX) };
        self.largest = self.largest.max(next);
        let [raw_bytes, left_bytes, kernel_bytes] = self.bytes;
        let kernels = kernel_bytes * (self.largest + (self.threads - 1) * self.largest.min(1 << 16));
        let points = raw_bytes * (load.held.points + load.raw) + left_bytes * load.left;
        let more = load.held.buckets + load.patches + load.cells() + load.walls_beyond();
        let needed = (self.fixed() + points + more + kernels) as u64;
        if needed <= limit {
            return Ok(limit - needed);
        }
        let (mebibytes, allowed, why) = (needed.div_ceil(1 << 20), limit >> 20, self.why(load, next));
        let message = format!("{mebibytes} MiB are needed and --memory allows {allowed} MiB: {why}");
        Err(Error::new(ErrorKind::Memory, message))
    }

    /// Bytes that do not depend on the input.
    fn fixed(&self) -> usize {
        PROGRAM_BYTES + self.threads * THREAD_BYTES
    }

    /// What takes most of the memory, with a remedy if there is one beside more memory.
    fn why(&self, load: Load, next: usize) -> String {
        let Load { held: Held { points, ranges, .. }, raw, left, walls, nodes, .. } = load;
        let of_points = self.bytes[1] * (points + raw + left) + self.bytes[2] * next;
        let fixed = self.fixed();
        if self.limit.is_some_and(|limit| 4 * fixed as u64 > 3 * limit) {
            let alone = format!("--threads {} alone takes {} MiB", self.threads, fixed.div_ceil(1 << 20));
            return if self.threads > 1 { alone + ": take fewer" } else { alone };
        }
        if load.cells() > of_points {
            let remedy = "finalize with larger cells";
            return format!("{nodes} nodes of cells and {ranges} ranges of final cells so far: {remedy}");
        }
        if load.walls_beyond() > of_points {
            return format!("{walls} walls around final simplices so far, as points on curves have");
        }
        if points > raw + left {
            return format!(
                "{points} points wait for their cell to be complete: finalize them without --preserve"
            );
        }
        if next > (raw + left) / 2 {
            return format!("{next} points must be triangulated at once, because their simplices reach far");
        }
        format!("{} points have simplices that later points may still change", raw + left)
    }
}

#[cfg(test)]
mod tests {
    use super::super::plane::Plane;
    use super::*;

    #[test]
    fn what_does_not_fit_is_named() {
        let load = |points, raw, left| Load {
            held: Held { points, ..Held::default() },
            raw,
            left,
            ..Load::default()
        };
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
        assert!(refused(&mut budget, Load::default(), 0).contains("MiB"), "kernels keep their memory");
        let mut budget = Budget::new::<Plane, 2>(Some(64 << 20), 1, 0);
        let (nodes, walls) = (100_000, 10_000_000);
        assert!(refused(&mut budget, Load { nodes, ..Load::default() }, 0).contains("100000 nodes of cells"));
        assert!(refused(&mut budget, Load { walls, ..Load::default() }, 0).contains("10000000 walls"));
        let ranges = Held { ranges: 2_000_000, ..Held::default() };
        assert!(refused(&mut budget, Load { held: ranges, ..Load::default() }, 0).contains("2000000 ranges"));
        assert!(budget.check(Load { patches: 60 << 20, ..Load::default() }, 0).is_err());
        let mut tiny = Budget::new::<Plane, 2>(Some(20 << 20), 2, 0);
        assert!(refused(&mut tiny, load(9_000, 0, 0), 9_000).contains("take fewer"));
        assert!(unlimited.holds(None) && !budget.holds(None));
        let holds = |threads, points| Budget::new::<Plane, 2>(Some(1 << 30), threads, 0).holds(points);
        assert!([1, 8, 64].map(|threads| holds(threads, Some(100_000))) == [true; 3]);
        assert!([1, 8, 64].map(|threads| holds(threads, Some(9_000_000))) == [false; 3]);
        assert!(!holds(1, Some(u64::MAX)));
    }
}
