//! The rules of a stream whose check takes memory: final cells and live vertices must be remembered.

use super::event::Event;
use super::finalized::FinalizedCells;
use super::header::Header;
use super::live::LiveVertices;
use crate::model::bounds::Point;
use spmesh_base::error::{Error, Result};

/// Checks what [`super::StreamReader`] leaves to programs that keep memory: no point lies in a final cell, each
/// tag adds information, no vertex is used after its finalization, and residual points are live vertices.
///
/// Every program that writes a stream from the blocks of another, or claims to verify one, must check them.
///
/// Memory: that of [`FinalizedCells`] and [`LiveVertices`].
#[derive(Debug)]
pub struct MemoryRules {
    cells: Option<FinalizedCells>,
    live: Live,
}

/// Live vertices; only a residual names the places of vertices again.
#[derive(Debug)]
enum Live {
    Ids(LiveVertices<()>),
    Places(LiveVertices<Point>),
}

impl Default for Live {
    fn default() -> Self {
        Live::Ids(LiveVertices::default())
    }
}

impl MemoryRules {
    /// The rules of a stream with this header.
    pub fn new(header: &Header) -> Self {
        let is_partial = header.kind.is_partial();
        let live = if is_partial { Live::Places(LiveVertices::new()) } else { Live::default() };
        MemoryRules { cells: header.tree.map(FinalizedCells::new), live }
    }

    /// Checks the next event of the stream.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`], if it breaks a rule.
    pub fn check(&mut self, event: &Event) -> Result<()> {
        match (event, &mut self.cells, &mut self.live) {
            (Event::Points(points), Some(cells), _) => cells.check_points(points),
            (Event::Cells(tags), Some(cells), _) => tags.iter().try_for_each(|&cell| cells.finalize(cell)),
            (Event::Patch(patch), _, Live::Ids(live)) => live.enter(patch, |_, _| ()).map(|_| ()),
            (Event::Patch(patch), _, Live::Places(live)) => live.enter(patch, |_, place| place).map(|_| ()),
            (Event::ResidualPoints(points), _, Live::Places(live)) => {
                points.iter().try_for_each(|&(id, place)| check_residual_point(live, id, place))
            }
            _ => Ok(()),
        }
    }

    /// Most vertices that were live at once: the width of the stream.
    pub fn live_max(&self) -> usize {
        match &self.live {
            Live::Ids(live) => live.live_max(),
            Live::Places(live) => live.live_max(),
        }
    }
}

fn check_residual_point(live: &mut LiveVertices<Point>, id: Option<u64>, place: Point) -> Result<()> {
    match id {
        Some(id) if live.retire(id)? != place => {
            Err(Error::malformed(format!("residual point has other coordinates than its vertex {id}")))
        }
        _ => Ok(()),
    }
}
