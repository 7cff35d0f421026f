//! The points of the ground, as an input.

use std::num::NonZeroUsize;

use super::{Class, Classifier, Found};
use spmesh_base::error::Result;
use spmesh_formats::source::{Description, Input, PointReader};
use spmesh_pipeline::finalize::Passes;
use spmesh_stream::model::bounds::Point;

/// The points of an input that are on its ground.
pub struct GroundPoints<'f> {
    found: &'f Found,
    input: &'f Input,
    threads: NonZeroUsize,
    batch_len: usize,
}

impl<'f> GroundPoints<'f> {
    /// The points of the input that `found` is the ground of. `memory` is for points under way. Units: bytes.
    pub fn new(found: &'f Found, input: &'f Input, threads: NonZeroUsize, memory: u64) -> GroundPoints<'f> {
        let batch_len = (memory / POINT_LEN).clamp(BATCH_LENS[0], BATCH_LENS[1]) as usize;
        GroundPoints { found, input, threads, batch_len }
    }
}

impl Passes for GroundPoints<'_> {
    fn description(&self) -> &Description {
        self.input.description()
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        let classifier = self.found.classifier(&self.input.description().coordinates, self.threads);
        Ok(Box::new(GroundReader {
            reader: self.input.read()?,
            classifier,
            batch_len: self.batch_len,
            next: Vec::new(),
            classes: Vec::new(),
        }))
    }

    fn is_costly(&self) -> bool {
        true
    }

    fn name(&self) -> Option<String> {
        Some(self.input.name())
    }
}

/// Points whose classes are found together, at least and at most, and bytes for each.
const BATCH_LENS: [u64; 2] = [1 << 13, 1 << 18];
const POINT_LEN: u64 = 200;

struct GroundReader<'f> {
    reader: Box<dyn PointReader + 'f>,
    classifier: Classifier<'f>,
    batch_len: usize,
    next: Vec<Point>,
    classes: Vec<Class>,
}

impl PointReader for GroundReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        while batch.is_empty() {
            while batch.len() < self.batch_len {
                self.reader.next_batch(&mut self.next)?;
                if self.next.is_empty() {
                    break;
                }
                batch.append(&mut self.next);
            }
            if batch.is_empty() {
                return Ok(());
            }
            self.classifier.of(batch, &mut self.classes)?;
            let mut classes = self.classes.iter();
            batch.retain(|_| classes.next() == Some(&Class::Ground));
        }
        Ok(())
    }

    fn invalid(&self) -> u64 {
        self.reader.invalid()
    }

    fn records(&self) -> u64 {
        self.reader.records()
    }
}
