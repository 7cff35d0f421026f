//! Batches of points, and reading ahead: a thread decodes and prepares the next batches while the calling
//! thread works on one.

use spmesh_base::error::Result;
use spmesh_base::parallel;
use spmesh_formats::source::PointReader;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Header, encode_points};

/// Points with their rows.
#[derive(Default)]
pub(super) struct PointBatch {
    pub(super) points: Vec<Point>,
    /// A row for each point, if they carry attributes.
    pub(super) rows: Vec<u8>,
}

impl PointBatch {
    /// Replaces the content by the next points; leaves it empty at the end.
    pub(super) fn read(&mut self, reader: &mut dyn PointReader) -> Result<()> {
        reader.next_batch(&mut self.points)?;
        self.rows.clear();
        self.rows.extend_from_slice(reader.rows());
        Ok(())
    }
}

/// Appends the record of each point: its encoded coordinates, then its row. `points` is a buffer.
pub(super) fn encode_records(
    header: &Header,
    batch: &PointBatch,
    points: &mut Vec<u8>,
    records: &mut Vec<u8>,
) -> Result<()> {
    let row_len = header.attributes.row_len();
    if row_len == 0 {
        return encode_points(header, &batch.points, records);
    }
    points.clear();
    encode_points(header, &batch.points, points)?;
    records.reserve(points.len() + batch.rows.len());
    for (point, row) in points.chunks_exact(header.point_len()).zip(batch.rows.chunks_exact(row_len)) {
        records.extend_from_slice(point);
        records.extend_from_slice(row);
    }
    Ok(())
}

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
