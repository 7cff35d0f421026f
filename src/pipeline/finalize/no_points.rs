//! An input without points, for meshes of lines alone.

use std::path::PathBuf;

use super::passes::Passes;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Description, PointReader, Reading, SourceOptions, read_breaklines};
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// No points, on the grid and in the system that options ask for.
pub(super) struct NoPoints(Description);

impl NoPoints {
    /// The system is that of the first file of lines that states one, if options name none.
    ///
    /// # Errors
    /// Those of reading lines; usage, if they are to come from stdin, since they are read again.
    pub(super) fn beside(lines: &[PathBuf], options: &SourceOptions) -> Result<NoPoints> {
        if lines.iter().any(|path| path.as_os_str() == "-") {
            return Err(Error::usage("--no-points reads lines twice: give a file of --lines, and not stdin"));
        }
        let mut crs = options.crs.clone().unwrap_or(Crs::Unknown);
        let mut files = lines.iter().filter(|_| options.crs.is_none());
        while let (Crs::Unknown, Some(path)) = (&crs, files.next()) {
            crs = read_breaklines(path, &Reading::default())?.system.crs;
        }
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
