//! Writes the final simplices of a node, with the points that are finalized there.

use super::super::bulk::Bulk;
use super::super::misfit::Misfit;
use super::super::patches::Flush;
use super::super::residual::Residual;
use super::{PointState, SimplexState, Solver};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{CornerParts, Corners};
use spmesh_stream::PatchBlocks;

impl<B: Bulk<D>, const D: usize> Solver<B, D> {
    /// Writes simplices, all that are left of all points, and the points that are finalized with them.
    pub(super) fn write_all(
        &mut self,
        simplices: &mut Corners,
        points: &Residual<D>,
        blocks: &mut PatchBlocks,
        flush: &mut Flush,
    ) -> Result<()> {
        let (builder, code) = (&mut self.builder, self.rules.code);
        let CornerParts { vertices, tetrahedra, .. } = simplices.parts();
        // Points take the place of vertices, for the second pass, too.
        for simplex in &mut *tetrahedra {
            *simplex = simplex.map(|v| vertices[v as usize].index);
            builder.plan(simplex);
        }
        builder.isolated(self.bulk.hidden().iter().copied(), points, code, blocks, Some(flush))?;
        for simplex in tetrahedra {
            if builder.add(simplex) {
                builder.close(points, code, blocks)?;
                flush(blocks)?;
            }
        }
        self.write_rest(points, blocks, Some(flush))
    }

    /// Writes the final simplices that were planned, after hidden points.
    pub(super) fn write_planned(
        &mut self,
        points: &Residual<D>,
        blocks: &mut PatchBlocks,
        flush: &mut Flush,
    ) -> Result<()> {
        let (builder, code) = (&mut self.builder, self.rules.code);
        for (v, _) in (0..).zip(&self.point_states).filter(|&(_, &state)| state == PointState::Residual) {
            builder.keep(v);
        }
        builder.isolated(self.bulk.hidden().iter().copied(), points, code, blocks, Some(flush))?;
        for simplex in (0..self.simplex_states.len()).map(|k| self.bulk.nth(k)) {
            let is_final = self.simplex_states[simplex as usize] == SimplexState::Open;
            if is_final && builder.add(self.bulk.written(simplex).as_ref()) {
                builder.close(points, code, blocks)?;
                flush(blocks)?;
            }
        }
        Ok(())
    }

    /// Writes the points that are finalized here without being in a simplex: vertices of the hull whose
    /// simplices were all written below, and at the root the points of an input without simplices.
    ///
    /// # Errors
    /// Those of `flush`; [`spmesh_base::error::ErrorKind::Malformed`] if a point has no simplex outside of
    /// the holes: no node leaves such a point.
    pub(super) fn write_rest(
        &mut self,
        points: &Residual<D>,
        blocks: &mut PatchBlocks,
        flush: Option<&mut Flush>,
    ) -> Result<()> {
        let (builder, code) = (&mut self.builder, self.rules.code);
        let mut unused = Vec::new();
        for (v, &state) in (0..).zip(&self.point_states) {
            match state {
                PointState::Hull if builder.is_unused(v) => unused.push(v),
                PointState::Interior if builder.is_unused(v) => {
                    let point = points.point(v as usize);
                    self.misfit = Some(Misfit::Point(v));
                    return Err(Error::malformed(format!(
                        "residual point {point:?} lies inside of a final {}",
                        B::SIMPLEX
                    )));
                }
                PointState::Residual => builder.keep(v),
                _ => {}
            }
        }
        builder.isolated(unused.into_iter(), points, code, blocks, flush)?;
        builder.finish(blocks);
        Ok(())
    }
}
