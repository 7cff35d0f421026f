//! One pass over the files of an input, one after the other.

use std::sync::{Arc, OnceLock};

use crate::source::filters::Dropped;
use crate::source::input::Source;
use crate::source::options::SourceOptions;
use crate::source::pass::{Pass, Stated};
use crate::source::placement::Placement;
use crate::source::reader::PointReader;
use crate::source::row_plan::RowPlan;
use spmesh_base::error::Result;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// What a whole pass has seen.
#[derive(Debug)]
pub(crate) struct Passed {
    /// Points that filters dropped.
    pub(crate) dropped: Dropped,
    /// Points dropped because a coordinate is not finite.
    pub(crate) invalid: u64,
    /// Points of each file in the part of the input that is wanted, dropped ones included.
    pub(crate) counts: Vec<u64>,
}

/// One pass over all files.
pub(crate) struct InputReader {
    sources: Arc<[Source]>,
    plans: Arc<[RowPlan]>,
    /// Rows of the last batch.
    rows: Vec<u8>,
    options: SourceOptions,
    coordinates: Coordinates,
    /// Number of the file after the current one.
    next: usize,
    current: Option<(Box<dyn Pass>, Placement)>,
    /// Records decoded in files before the current one.
    records: u64,
    /// Points dropped in files before the current one: not finite, and by filters.
    invalid: u64,
    dropped: Dropped,
    /// Points of each file so far: those before the current one with what was dropped.
    counts: Vec<u64>,
    /// Gets the counts at the end.
    passed: Arc<OnceLock<Passed>>,
}

impl InputReader {
    /// Opens the first file. `passed` gets the counts at the end.
    pub(crate) fn new(
        sources: Arc<[Source]>,
        plans: Arc<[RowPlan]>,
        options: SourceOptions,
        coordinates: Coordinates,
        passed: Arc<OnceLock<Passed>>,
    ) -> Result<InputReader> {
        let mut reader = InputReader {
            sources,
            plans,
            rows: Vec::new(),
            options,
            coordinates,
            next: 0,
            current: None,
            records: 0,
            invalid: 0,
            dropped: Dropped::default(),
            counts: Vec::new(),
            passed,
        };
        reader.open_next()?;
        Ok(reader)
    }

    /// Opens the next file, if there is one.
    fn open_next(&mut self) -> Result<()> {
        if let Some((pass, placement)) = self.current.take() {
            if let Some(cut) = pass.cut() {
                let _ = self.sources[self.next - 1].cut.set(cut);
            }
            self.records += pass.records();
            self.invalid += placement.invalid;
            self.counts[self.next - 1] += placement.left_out();
            self.dropped.add(&placement.dropped);
        }
        if let Some(source) = self.sources.get(self.next) {
            let plan = self.plans[self.next].clone();
            let pass = source.pass(&self.options, plan).map_err(|e| e.of_input(&source.name))?;
            let Stated { coordinates, bounds, .. } = source.content.stated;
            let placement = Placement::new(&coordinates, &self.coordinates, &self.options);
            self.current = Some((pass, placement.within(bounds)));
            self.counts.push(0);
            self.next += 1;
        } else {
            // Later passes drop the same points.
            let (dropped, invalid, counts) = (self.dropped, self.invalid, std::mem::take(&mut self.counts));
            let _ = self.passed.set(Passed { dropped, invalid, counts });
        }
        Ok(())
    }
}

impl PointReader for InputReader {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        self.rows.clear();
        while let Some((pass, placement)) = &mut self.current {
            let source = &self.sources[self.next - 1];
            let goes_on = pass.next_batch(placement, batch, &mut self.rows);
            let goes_on = goes_on.map_err(|e| e.of_input(&source.name))?;
            if !batch.is_empty() {
                self.counts[self.next - 1] += batch.len() as u64;
                return Ok(());
            }
            if !goes_on {
                self.open_next()?;
            }
        }
        Ok(())
    }

    fn rows(&self) -> &[u8] {
        &self.rows
    }

    fn invalid(&self) -> u64 {
        self.invalid + self.current.as_ref().map_or(0, |(_, placement)| placement.invalid)
    }

    fn records(&self) -> u64 {
        self.records + self.current.as_ref().map_or(0, |(pass, _)| pass.records())
    }

    fn file(&self) -> usize {
        self.next.saturating_sub(1)
    }
}
