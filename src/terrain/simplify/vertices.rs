//! The chosen points, in a temporary file, as an input of the finalization.

use std::path::Path;

use super::cells::Codec;
use spmesh_base::error::Result;
use spmesh_base::temporary::TemporaryFile;
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::Passes;
use spmesh_stream::model::bounds::Point;

/// Points read together.
const BATCH_LEN: u64 = 1 << 14;

/// Chosen points, in the order in which they were chosen.
pub(super) struct Vertices {
    file: TemporaryFile,
    codec: Codec,
    len: u64,
    description: Description,
}

impl Vertices {
    /// None so far. `description` is that of a stream of them.
    pub(super) fn new(codec: Codec, description: Description, folder: Option<&Path>) -> Result<Vertices> {
        Ok(Vertices { file: TemporaryFile::create(folder)?, codec, len: 0, description })
    }

    pub(super) fn len(&self) -> u64 {
        self.len
    }

    /// Chooses points.
    pub(super) fn append(&mut self, points: &[Point]) -> Result<()> {
        let mut bytes = Vec::with_capacity(points.len() * self.codec.point_len());
        points.iter().for_each(|point| self.codec.encode(point, &mut bytes));
        self.file.append("writing points", &bytes)?;
        self.len += points.len() as u64;
        Ok(())
    }
}

impl Passes for Vertices {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(Reader { vertices: self, next: 0 }))
    }
}

struct Reader<'v> {
    vertices: &'v Vertices,
    next: u64,
}

impl PointReader for Reader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        let Vertices { file, codec, len, .. } = self.vertices;
        let count = BATCH_LEN.min(len - self.next);
        codec.read(file, self.next * codec.point_len() as u64, count as usize, batch)?;
        self.next += count;
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}
