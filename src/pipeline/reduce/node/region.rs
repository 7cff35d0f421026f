//! A region of points in regions: its tetrahedra, without those that other regions own.

use super::super::bulk::Bulk;
use super::super::duplicates::Merged;
use super::super::misfit::overlap;
use super::super::patches::{Flush, OWN};
use super::super::residual::Residual;
use super::super::space::{Space, sphere_bounds};
use super::{PointState, Solver};
use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::{CornerParts, Corners};
use spmesh_stream::{PatchBlocks, PointRegion};

impl Solver<Space, 3> {
    /// Tetrahedralizes the points of a region, in the order of its counts. Only those that are new need no
    /// keys yet.
    ///
    /// # Errors
    /// Those of the kernel; malformed, if coinciding points are forbidden, or if earlier regions have one of
    /// them and not the other.
    pub(in crate::reduce) fn solve_region(
        &mut self,
        region: &PointRegion,
        points: &mut Residual<3>,
    ) -> Result<(Corners, Merged)> {
        self.bulk.triangulate(points, None)?;
        let merged = self.merge_in_region(region, points)?;
        let bounds = sphere_bounds(&self.rules.coordinates);
        Ok((self.bulk.take_owned(region.own, &region.bounds, bounds)?, merged))
    }

    /// Writes the tetrahedra that a region owns, which this solver has found last. Points that earlier
    /// regions have, too, have the ids of their vertices as keys. Each point becomes a vertex in its first
    /// region, and is finalized in its last.
    ///
    /// # Errors
    /// Those of `flush`.
    pub(in crate::reduce) fn write_region(
        &mut self,
        region: &PointRegion,
        points: &Residual<3>,
        owned: &mut Corners,
        blocks: &mut PatchBlocks,
        flush: &mut Flush,
    ) -> Result<()> {
        let (builder, code) = (&mut self.builder, self.rules.code);
        builder.start(points.len(), code, 0, true);
        let CornerParts { vertices, tetrahedra, .. } = owned.parts();
        for tetrahedron in &mut *tetrahedra {
            // Points take the place of vertices, for the second pass, too.
            *tetrahedron = tetrahedron.map(|vertex| vertices[vertex as usize].index);
            builder.plan(tetrahedron);
        }
        let is_vertex = |v: &u32| self.point_states[*v as usize] != PointState::Merged;
        let unused: Vec<u32> =
            (0..points.len() as u32).filter(is_vertex).filter(|&v| builder.is_unused(v)).collect();
        // Later regions use them.
        let kept = region.own as u32..(region.own + region.first + region.again) as u32;
        kept.filter(is_vertex).for_each(|v| builder.keep(v));
        for tetrahedron in tetrahedra {
            if builder.add(tetrahedron) {
                builder.close(points, code, blocks)?;
                flush(blocks)?;
            }
        }
        builder.isolated(unused.into_iter(), points, code, blocks, Some(flush))
    }

    /// Merges points that coincide: here if they are new, and as the region did that had them first if not.
    /// They are in the same regions.
    fn merge_in_region(&mut self, region: &PointRegion, points: &mut Residual<3>) -> Result<Merged> {
        self.point_states.clear();
        self.point_states.resize(points.len(), PointState::Interior);
        let (raw, coordinates) = (points.raw as u32, self.rules.coordinates);
        let ends = [region.own, region.new_points(), region.new_points() + region.again];
        let group = |v: u32| ends.iter().filter(|&&end| end <= u64::from(v)).count();
        let duplicates = self.bulk.duplicates();
        for &[point, vertex] in &*duplicates {
            if group(point) != group(vertex) {
                return Err(overlap(points, point, vertex));
            }
            self.point_states[point as usize] = PointState::Merged;
        }
        duplicates.retain(|&[point, _]| point < raw);
        self.rules.duplicates.settle(points, duplicates, &coordinates, None)
    }

    /// The number of a point among the vertices that the last region has written, if it is one.
    pub(in crate::reduce) fn number_in_region(&self, v: u32, points: &Residual<3>) -> Option<u64> {
        let reference = self.builder.reference(v, points);
        (reference != u64::MAX && reference & OWN != 0).then_some(reference & !OWN)
    }
}
