//! Points in memory as an input of the engine.

use std::cell::Cell;

use spmesh_base::error::Result;
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::{Observer, Passes};
use spmesh_stream::Crs;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;

use super::sets::Set;

/// Points in memory as an input; passes after the second read `changed`, if it is set.
pub(super) struct Memory {
    pub(super) description: Description,
    pub(super) points: Vec<Point>,
    pub(super) changed: Option<Vec<Point>>,
    pub(super) passes: Cell<u32>,
    pub(super) name: Option<String>,
    pub(super) is_costly: bool,
}

impl Memory {
    pub(super) fn new(set: &Set) -> Memory {
        let description = Description {
            coordinates: set.coordinates,
            dims: set.dims,
            has_elevation: set.dims == 2,
            crs: Crs::Wkt("LOCAL_CS[\"test\"]".into()),
            stated_bounds: None,
            stated_points: None,
            attributes: Attributes::default(),
        };
        Memory {
            description,
            points: set.points.clone(),
            changed: None,
            passes: Cell::new(0),
            name: None,
            is_costly: false,
        }
    }
}

impl Passes for Memory {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        self.passes.set(self.passes.get() + 1);
        let points = match &self.changed {
            Some(changed) if self.passes.get() > 2 => changed,
            _ => &self.points,
        };
        Ok(Box::new(MemoryReader { rest: points }))
    }

    fn is_costly(&self) -> bool {
        self.is_costly
    }

    fn name(&self) -> Option<String> {
        self.name.clone()
    }
}

pub(super) struct MemoryReader<'a> {
    pub(super) rest: &'a [Point],
}

impl PointReader for MemoryReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        let (now, later) = self.rest.split_at(self.rest.len().min(977));
        batch.clear();
        batch.extend_from_slice(now);
        self.rest = later;
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}

#[derive(Default)]
pub(super) struct Notices(pub(super) Vec<String>);

impl Observer for Notices {
    fn notice(&mut self, message: &str) {
        self.0.push(message.into());
    }
}
