//! A partial mesh that is read to be merged with others.

use super::border::Border;
use super::residual::{Residual, UNWRITTEN};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{LiveVertices, Patch};

/// A partial mesh read so far: its residual, its live vertices, and the border of its final simplices.
#[derive(Debug)]
pub(super) struct Tile<const D: usize> {
    region: Region<D>,
    /// The sum of this and an id of the tile is the id in the merged mesh.
    id_offset: u64,
    live: LiveVertices<Point>,
    border: Border<D>,
    residual: Residual<D>,
}

impl<const D: usize> Tile<D> {
    pub(super) fn new(region: Region<D>, id_offset: u64) -> Self {
        let (live, border, residual) = (LiveVertices::new(), Border::default(), Residual::default());
        Tile { region, id_offset, live, border, residual }
    }

    /// Turns the ids of a patch into those of the merged mesh.
    pub(super) fn patch(&mut self, mut patch: Patch) -> Result<Patch> {
        self.live.enter(&patch, |_, point| point)?;
        patch.first_id += self.id_offset;
        patch.imported.iter_mut().for_each(|id| *id += self.id_offset);
        self.border.simplices(&patch);
        Ok(patch)
    }

    /// Takes residual points, with a row for each if there are attributes.
    pub(super) fn residual_points(&mut self, points: &[(Option<u64>, Point)], rows: &[u8]) -> Result<()> {
        let row_len = rows.len().checked_div(points.len()).unwrap_or(0);
        (0..)
            .zip(points)
            .try_for_each(|(i, &(id, point))| self.residual_point(id, point, &rows[i * row_len..][..row_len]))
    }

    fn residual_point(&mut self, id: Option<u64>, point: Point, row: &[u8]) -> Result<()> {
        if !self.region.contains(point) {
            return Err(Error::malformed(format!(
                "residual point {point:?} lies outside of the stream's region"
            )));
        }
        if let Some(id) = id
            && self.live.retire(id)? != point
        {
            return Err(Error::malformed(format!("residual point {point:?} is not where vertex {id} is")));
        }
        self.residual.push(point, row, id.map_or(UNWRITTEN, |id| id + self.id_offset));
        Ok(())
    }

    /// Takes walls, D residual points each.
    pub(super) fn walls(&mut self, corners: &[u32]) {
        let (walls, _) = corners.as_chunks();
        for wall in walls {
            self.border.wall(wall.map(|corner| self.residual.keys[corner as usize]));
        }
        self.residual.walls.extend_from_slice(walls);
    }

    /// Checks that nothing is missing: every vertex that is not finalized is in the residual, and the walls
    /// are the border of the final simplices, so that every hole is closed.
    pub(super) fn check_end(&self) -> Result<()> {
        let lost = self.live.len();
        if lost > 0 {
            return Err(Error::malformed(format!(
                "{lost} vertices are neither finalized nor in the residual"
            )));
        }
        if !self.border.is_closed() {
            return Err(Error::malformed("the walls of the residual are not the border of what is final"));
        }
        Ok(())
    }

    pub(super) fn into_residual(self) -> Residual<D> {
        self.residual
    }
}
