//! Pass 3: points and tags go out (thesis 5.2).

use std::io::Write;

use super::buffer::CellBuffers;
use super::plan::Plan;
use super::survey::input_changed;
use super::{Options, Pass, Passes, Work};
use crate::bounds::{Bounds, Point};
use crate::error::Result;
use crate::stream::{StreamWriter, encode_point};

impl<P: Passes + ?Sized> Work<'_, P> {
    /// Holds the points of a leaf back until its counter is zero, then writes them and its tag.
    pub(super) fn write_chunked<W: Write>(
        &mut self,
        mut plan: Plan,
        options: &Options,
        mut writer: StreamWriter<W>,
    ) -> Result<()> {
        writer.cells(&plan.take_empty())?;
        let header = writer.header().clone();
        let bytes = options.budget.bytes() - plan.bytes();
        let mut buffers =
            CellBuffers::new(plan.leaves(), header.point_len(), bytes, options.temp_dir.clone())?;
        let mut record = Vec::with_capacity(header.point_len());
        self.read_all(Pass::Write, |batch| {
            expect_inside(&header.bounds, batch)?;
            for &point in batch {
                let (leaf, is_last) = plan.expect(point)?;
                record.clear();
                encode_point(&header, point, &mut record)?;
                buffers.push(leaf, &record)?;
                if is_last {
                    buffers.drain(leaf, |bytes| writer.encoded_points(bytes))?;
                    writer.cells(&[plan.cell(leaf)])?;
                }
            }
            Ok(())
        })?;
        plan.expect_end()?;
        buffers.report(&mut self.stats);
        writer.end(0, 0).map(drop)
    }

    /// Writes every point as it comes, and the tag of a leaf after its last point.
    pub(super) fn write_preserved<W: Write>(
        &mut self,
        mut plan: Plan,
        mut writer: StreamWriter<W>,
    ) -> Result<()> {
        writer.cells(&plan.take_empty())?;
        let bounds = writer.header().bounds;
        self.read_all(Pass::Write, |batch| {
            expect_inside(&bounds, batch)?;
            let mut written = 0;
            for (at, &point) in batch.iter().enumerate() {
                let (leaf, is_last) = plan.expect(point)?;
                if is_last {
                    writer.points(&batch[written..=at])?;
                    writer.cells(&[plan.cell(leaf)])?;
                    written = at + 1;
                }
            }
            writer.points(&batch[written..])
        })?;
        plan.expect_end()?;
        writer.end(0, 0).map(drop)
    }

    /// Copies the points of an input for which there is no tree.
    pub(super) fn write_untagged<W: Write>(&mut self, mut writer: StreamWriter<W>) -> Result<()> {
        let header = writer.header().clone();
        if header.points != Some(0) {
            self.read_all(Pass::Write, |batch| {
                expect_inside(&header.bounds, batch)?;
                writer.points(batch)
            })?;
        }
        if header.points != Some(writer.totals().points) {
            return Err(input_changed());
        }
        writer.end(0, 0).map(drop)
    }
}

/// Fails unless all points lie in the box that was found before.
fn expect_inside(bounds: &Option<Bounds>, points: &[Point]) -> Result<()> {
    let is_inside = |&point: &Point| bounds.is_some_and(|bounds| bounds.contains(point));
    if points.iter().all(is_inside) { Ok(()) } else { Err(input_changed()) }
}
