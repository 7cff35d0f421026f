//! Reading ahead: a thread decodes and prepares the next batches while the calling thread works on one.

use super::batch::PointBatch;
use spmesh_base::error::Result;
use spmesh_base::parallel;
use spmesh_formats::source::PointReader;

/// Batches in all: one that is being read, one that waits, and one that the calling thread works on.
const BATCHES: usize = 3;

/// Points, and what was prepared of them on the reader's thread.
#[derive(Default)]
struct Batch<T> {
    points: PointBatch,
    prepared: T,
}

/// Reads `reader` to its end. Each batch goes through `prepare` on the reader's thread, then through
/// `consume` on the calling thread, in order. `prepare` depends on the batch alone.
///
/// Memory: three batches.
pub(super) fn read_ahead<T: Default + Send>(
    reader: &mut dyn PointReader,
    mut prepare: impl FnMut(&PointBatch, &mut T) -> Result<()> + Send,
    mut consume: impl FnMut(&PointBatch, &mut T) -> Result<()>,
) -> Result<()> {
    let read = |batch: &mut Batch<T>| {
        batch.points.read(reader)?;
        if batch.points.points.is_empty() {
            return Ok(false);
        }
        prepare(&batch.points, &mut batch.prepared)?;
        Ok(true)
    };
    parallel::read_ahead("reader", BATCHES, read, |batch| consume(&batch.points, &mut batch.prepared))
}
