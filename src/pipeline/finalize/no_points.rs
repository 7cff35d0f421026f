//! An input without points, for meshes of lines alone.

use std::path::PathBuf;

use super::passes::Passes;
use spmesh_base::error::Result;
use spmesh_formats::source::{Description, PointReader, Reading, SourceOptions, read_breaklines};
use spmesh_stream::Coordinates;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;

/// No points, on the grid and in the system that options ask for.
pub(super) struct NoPoints(Description);

impl NoPoints {
    /// The system is that of the first file of lines, if options name none.
    pub(super) fn beside(lines: &[PathBuf], options: &SourceOptions) -> Result<NoPoints> {
        let first = || lines.first().map(|path| read_breaklines(path, &Reading::default())).transpose();
        let crs = match &options.crs {
            Some(crs) => crs.clone(),
            None => first()?.unwrap_or_default().system.crs,
        };
        let grid = options.grid.map(|(scale, offset)| Coordinates::I32 { scale, offset });
        Ok(NoPoints(Description {
            coordinates: grid.unwrap_or(Coordinates::F64),
            dims: 2,
            has_elevation: true,
            crs,
            stated_bounds: None,
            attributes: Attributes::default(),
            stated_points: Some(0),
        }))
    }
}

impl Passes for NoPoints {
    fn description(&self) -> &Description {
        &self.0
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(Ended))
    }
}

/// A pass at its end.
struct Ended;

impl PointReader for Ended {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}
