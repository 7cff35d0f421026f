//! Pass 3: writes points and tags (thesis 5.2).

use std::io::Write;

use super::batch::{PointBatch, encode_records};
use super::buffer::CellBuffers;
use super::locate::Locator;
use super::options::Options;
use super::passes::Pass;
use super::passes::input_changed;
use super::plan::Plan;
use super::work::Work;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Header, StreamWriter};

/// Bytes for waiting points, at least.
const WAITING_MIN: u64 = 32 << 10;

/// Complete leaves are written after every so many points of the input. Batches play no role, so that the
/// output depends on the input alone.
const WINDOW: u64 = 1 << 16;

/// A batch of points with the leaf and the record of each.
#[derive(Default)]
struct Located {
    leaves: Vec<u32>,
    records: Vec<u8>,
    /// A buffer.
    points: Vec<u8>,
}

impl Located {
    fn prepare(&mut self, locator: &Locator, header: &Header, batch: &PointBatch) -> Result<()> {
        expect_inside(&header.bounds, &batch.points)?;
        locator.locate(&batch.points, &mut self.leaves)?;
        self.records.clear();
        encode_records(header, batch, &mut self.points, &mut self.records)
    }

    /// Every run of points in one leaf: the leaf, and the bytes of the records.
    fn runs(&self, record_len: usize) -> impl Iterator<Item = (usize, &[u8])> {
        let mut rest = &self.records[..];
        self.leaves.chunk_by(|a, b| a == b).map(move |run| {
            let (records, later) = rest.split_at(run.len() * record_len);
            rest = later;
            (run[0] as usize, records)
        })
    }
}

impl Work<'_> {
    /// Holds the points of a leaf until its counter is zero, then writes them and its tag.
    pub(super) fn write_chunked<W: Write>(
        &mut self,
        mut plan: Plan,
        options: &Options,
        mut writer: StreamWriter<W>,
    ) -> Result<()> {
        writer.cells(&plan.take_empty())?;
        let (header, bytes) = (writer.header().clone(), options.budget.bytes());
        self.hold_leaves(plan, options, &header, bytes, |leaves, cells, buffers| {
            leaves.iter().try_for_each(|&leaf| {
                buffers.drain(leaf, |bytes| writer.encoded_records(bytes))?;
                writer.cells(&[cells[leaf]])
            })
        })?;
        writer.end(0, 0).map(drop)
    }

    /// Holds the points of a leaf until its counter is zero, then gives them to `take`: the numbers of
    /// leaves, the cells of all leaves, and the buffers that have their records. Waiting points take up to
    /// `bytes`.
    ///
    /// Leaves that are complete within the same [`WINDOW`] of points come together, in the order of the tree.
    /// If the points are in random order, nearly all leaves are complete at the very end, and neighbours
    /// should follow each other.
    pub(super) fn hold_leaves(
        &mut self,
        plan: Plan,
        options: &Options,
        header: &Header,
        bytes: u64,
        mut take: impl FnMut(&mut [usize], &[CellCode], &mut CellBuffers) -> Result<()>,
    ) -> Result<()> {
        let record_len = header.record_len();
        let bytes = bytes.saturating_sub(plan.bytes()).max(WAITING_MIN);
        let records = header.points.unwrap_or(u64::MAX);
        // A temporary file has taken all points already, so it has room for some of them once more.
        let (folder, spills_cold) = (options.temp_dir.clone(), self.is_spooled());
        let mut buffers = CellBuffers::new(plan.leaves(), record_len, records, bytes, folder, spills_cold)?;
        let (locator, mut countdown) = plan.split();
        let mut take_leaves = |complete: &mut Vec<usize>, buffers: &mut CellBuffers| {
            complete.sort_unstable();
            take(complete, locator.leaves(), buffers)?;
            complete.clear();
            Ok(())
        };
        let (mut complete, mut points, mut window_end) = (Vec::new(), 0, WINDOW);
        let prepare = |batch: &PointBatch, located: &mut Located| located.prepare(&locator, header, batch);
        self.read_all(Pass::Write, prepare, |_, located| {
            for (leaf, records) in located.runs(record_len) {
                let is_complete = countdown.take(leaf, records.len() / record_len)?;
                buffers.push(leaf, records)?;
                points += (records.len() / record_len) as u64;
                if points > window_end {
                    take_leaves(&mut complete, &mut buffers)?;
                    window_end = points.next_multiple_of(WINDOW);
                }
                if is_complete {
                    complete.push(leaf);
                }
            }
            Ok(())
        })?;
        countdown.expect_end()?;
        take_leaves(&mut complete, &mut buffers)?;
        buffers.add_to(&mut self.stats);
        Ok(())
    }

    /// Writes every point as it comes, and the tag of a leaf after its last point.
    pub(super) fn write_preserved<W: Write>(
        &mut self,
        mut plan: Plan,
        mut writer: StreamWriter<W>,
    ) -> Result<()> {
        writer.cells(&plan.take_empty())?;
        let header = writer.header().clone();
        let (locator, mut countdown) = plan.split();
        let prepare = |batch: &PointBatch, located: &mut Located| located.prepare(&locator, &header, batch);
        self.read_all(Pass::Write, prepare, |_, located| {
            for (leaf, records) in located.runs(header.record_len()) {
                writer.encoded_records(records)?;
                if countdown.take(leaf, records.len() / header.record_len())? {
                    writer.cells(&[locator.leaves()[leaf]])?;
                }
            }
            Ok(())
        })?;
        countdown.expect_end()?;
        writer.end(0, 0).map(drop)
    }

    /// Copies the points of an input that has no tree.
    pub(super) fn write_untagged<W: Write>(&mut self, mut writer: StreamWriter<W>) -> Result<()> {
        let header = writer.header().clone();
        if header.points != Some(0) {
            let prepare = |batch: &PointBatch, (): &mut ()| expect_inside(&header.bounds, &batch.points);
            self.read_all(Pass::Write, prepare, |batch, ()| {
                writer.points_with_rows(&batch.points, &batch.rows)
            })?;
        }
        if header.points != Some(writer.totals().points) {
            return Err(input_changed());
        }
        writer.end(0, 0).map(drop)
    }
}

/// Checks that all points lie in the box of pass 1.
fn expect_inside(bounds: &Option<Bounds>, points: &[Point]) -> Result<()> {
    let Some(Bounds { min, max }) = bounds else { return Err(input_changed()) };
    let is_inside = |point: &Point| {
        (0..3).fold(true, |inside, axis| inside & (min[axis] <= point[axis]) & (point[axis] <= max[axis]))
    };
    // A loop without an early exit takes a few instructions per point.
    if points.iter().fold(true, |all, point| all & is_inside(point)) { Ok(()) } else { Err(input_changed()) }
}
