//! The passes over an input.

use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Description, Input, PointReader};
use spmesh_stream::model::bounds::Point;

/// An input that can be read from its start as often as needed, the same every time.
pub trait Passes {
    /// Properties of the input, known before its points are read.
    fn description(&self) -> &Description;

    /// Starts a pass.
    fn read(&self) -> Result<Box<dyn PointReader + '_>>;

    /// The input that this one changes, if it is made of one.
    fn source(&self) -> Option<&dyn Passes> {
        None
    }

    /// Whether decoding costs more than writing decoded points to disk and reading them back.
    fn is_costly(&self) -> bool {
        self.source().is_some_and(|source| source.is_costly())
    }

    /// Name of the input in messages, if it has one.
    fn name(&self) -> Option<String> {
        self.source()?.name()
    }
}

impl Passes for Input {
    fn description(&self) -> &Description {
        Input::description(self)
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Input::read(self)
    }

    fn is_costly(&self) -> bool {
        Input::is_costly(self)
    }

    fn name(&self) -> Option<String> {
        Some(Input::name(self))
    }
}

/// Decides which points of a pass are kept.
pub(super) trait Keep: Send {
    /// Whether the next point is kept; its elevation may change.
    fn keeps(&mut self, point: &mut Point) -> bool;

    /// The pass is at its end.
    fn end(&mut self) -> Result<()>;
}

/// One pass over the points of an input that are kept.
pub(super) struct KeptPoints<'a, K> {
    reader: Box<dyn PointReader + 'a>,
    keep: K,
    row_len: usize,
    rows: Vec<u8>,
}

impl<'a, K: Keep> KeptPoints<'a, K> {
    /// Starts a pass over `input`.
    pub(super) fn new(input: &'a dyn Passes, keep: K) -> Result<KeptPoints<'a, K>> {
        let row_len = input.description().attributes.row_len();
        Ok(KeptPoints { reader: input.read()?, keep, row_len, rows: Vec::new() })
    }
}

impl<K: Keep> PointReader for KeptPoints<'_, K> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        let KeptPoints { reader, keep, row_len, rows } = self;
        rows.clear();
        loop {
            reader.next_batch(batch)?;
            if batch.is_empty() {
                return keep.end();
            }
            let mut kept = 0;
            for index in 0..batch.len() {
                if keep.keeps(&mut batch[index]) {
                    batch[kept] = batch[index];
                    kept += 1;
                    rows.extend_from_slice(&reader.rows()[index * *row_len..(index + 1) * *row_len]);
                }
            }
            batch.truncate(kept);
            if kept > 0 {
                return Ok(());
            }
        }
    }

    fn rows(&self) -> &[u8] {
        &self.rows
    }

    fn invalid(&self) -> u64 {
        self.reader.invalid()
    }
}

/// The passes over the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Finding the mean distance between points.
    Spacing,
    /// Collecting the points near shores.
    Shores,
    /// Finding the greatest weight.
    Weights,
    /// Finding the points that thinning keeps.
    Thin,
    /// Finding the bounding box.
    Bounds,
    /// Counting points per cell.
    Count,
    /// Counting the points of crowded cells on a finer grid.
    Refine,
    /// Writing points and tags.
    Write,
}

impl Pass {
    /// Name in reports and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Pass::Spacing => "spacing",
            Pass::Shores => "shores",
            Pass::Weights => "weights",
            Pass::Thin => "thin",
            Pass::Bounds => "bounds",
            Pass::Count => "count",
            Pass::Refine => "refine",
            Pass::Write => "write",
        }
    }

    /// Whether it writes the output.
    pub fn is_output(self) -> bool {
        self == Pass::Write
    }
}

/// Receives the progress of a run; `()` ignores it.
pub trait Observer {
    /// A pass starts; the input has `total` points, if that is known.
    fn pass(&mut self, _pass: Pass, _total: Option<u64>) {}

    /// `points` points of the pass are done.
    fn done(&mut self, _points: u64) {}

    /// A message for the user.
    fn notice(&mut self, _message: &str) {}
}

impl Observer for () {}

/// The error of an input that is not the same in every pass.
pub(super) fn input_changed() -> Error {
    Error::malformed("the input changed between two passes over it")
}
