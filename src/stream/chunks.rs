//! The promise of a chunked points stream: one tag of the run after some points has a cell that holds all of
//! them. Blocks without records neither start nor end a run.

use crate::model::bounds::Bounds;
use crate::model::cells::{CellCode, CellTree};
use spmesh_base::error::{Error, Result};

/// Checks the promise with the bounding box of the points since the last tag.
#[derive(Debug)]
pub(crate) struct ChunkCheck {
    tree: CellTree,
    waiting: Option<Bounds>,
    /// Whether the last block held tags.
    in_tags: bool,
}

impl ChunkCheck {
    pub(crate) fn new(tree: CellTree) -> Self {
        ChunkCheck { tree, waiting: None, in_tags: false }
    }

    /// Adds points with the bounding box `bounds`.
    pub(crate) fn points(&mut self, bounds: Bounds) -> Result<()> {
        if self.in_tags {
            self.end()?;
            self.in_tags = false;
        }
        self.waiting = Some(self.waiting.map_or(bounds, |waiting| waiting.union(bounds)));
        Ok(())
    }

    pub(crate) fn cells(&mut self, cells: &[CellCode]) {
        self.in_tags |= !cells.is_empty();
        if let Some(Bounds { min, max }) = self.waiting {
            let holds = |&cell: &CellCode| {
                let level = self.tree.level(cell);
                self.tree.cell_of(min, level) == cell && self.tree.cell_of(max, level) == cell
            };
            if cells.iter().any(holds) {
                self.waiting = None;
            }
        }
    }

    pub(crate) fn end(&self) -> Result<()> {
        match self.waiting {
            None => Ok(()),
            Some(_) => Err(Error::malformed(
                "the stream is chunked, but the points before the last tag do not lie in one cell of it",
            )),
        }
    }
}
