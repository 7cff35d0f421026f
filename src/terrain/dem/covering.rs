//! The thread that covers cells with triangles.

use std::mem::{replace, take};
use std::sync::{Arc, Mutex, PoisonError};

use super::coverage::Coverage;
use spmesh_base::error::Result;
use spmesh_base::parallel::OrderedPool;
use spmesh_formats::raster::Grid;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Triangles that go to the thread at once.
const BATCH: usize = 1024;
/// Greatest number of batches under way, which take 74 kB each.
const BATCHES_MAX: u64 = 4;

/// Corners of triangles.
type Batch = Vec<[Point; 3]>;

/// Covers cells on a thread of its own, since that takes as long as all else. The order of triangles does not
/// matter to the cells, so neither does the thread.
pub(super) struct Covering {
    grid: Grid,
    coordinates: Coordinates,
    coverage: Arc<Mutex<Coverage>>,
    pool: OrderedPool<Batch, Result<Batch>>,
    /// The triangles to go next.
    next: Batch,
}

impl Covering {
    /// Starts the thread.
    pub(super) fn start(coverage: Coverage, grid: Grid, coordinates: Coordinates) -> Result<Covering> {
        let coverage = Arc::new(Mutex::new(coverage));
        let covered = Arc::clone(&coverage);
        let cover = move |mut batch: Batch| {
            // A panic resumes where its result is taken, before anyone else locks.
            let mut coverage = covered.lock().unwrap_or_else(PoisonError::into_inner);
            for corners in batch.drain(..) {
                coverage.add(corners)?;
            }
            Ok(batch)
        };
        let pool = OrderedPool::start("covering", 1, BATCHES_MAX, cover)?;
        Ok(Covering { grid, coordinates, coverage, pool, next: Vec::with_capacity(BATCH) })
    }

    /// Adds a triangle with corners in stored coordinates and elevations of the world. Its error may come
    /// with a later triangle, or at the end.
    #[inline]
    pub(super) fn add(&mut self, corners: [Point; 3]) -> Result<()> {
        let placed = corners.map(|corner| self.placed(corner));
        self.next.push(placed);
        if self.next.len() == BATCH { self.send() } else { Ok(()) }
    }

    /// Waits until all triangles are added.
    pub(super) fn finish(mut self) -> Result<Coverage> {
        let batch = take(&mut self.next);
        self.pool.give(batch, 1);
        while let Some(outcome) = self.pool.take() {
            outcome?;
        }
        // The thread holds the other reference.
        drop(self.pool);
        let coverage = Arc::into_inner(self.coverage).expect("the thread has ended");
        Ok(coverage.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// A corner in the coordinates of cells.
    #[inline]
    fn placed(&self, corner: Point) -> Point {
        let Grid { left, top, step, .. } = self.grid;
        let [x, y, _] = self.coordinates.to_world(corner);
        // Rows count downwards.
        [(x - left) / step, (top - y) / step, corner[2]]
    }

    /// Gives the waiting triangles to the thread.
    fn send(&mut self) -> Result<()> {
        let used = if self.pool.is_full() { self.pool.take().transpose()? } else { None };
        let empty = used.unwrap_or_else(|| Vec::with_capacity(BATCH));
        self.pool.give(replace(&mut self.next, empty), 1);
        Ok(())
    }
}

impl std::fmt::Debug for Covering {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Covering").field("coverage", &self.coverage).finish_non_exhaustive()
    }
}
