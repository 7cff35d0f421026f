//! Writes what is final: patches of triangles, vertices with their first triangle and finalized with their last.

use std::io::Write;

use super::node::{PointFate, Solved};
use super::residual::{Residual, UNWRITTEN};
use crate::error::Result;
use crate::stream::{Patch, StreamWriter};

/// Triangles per patch. With three vertices of its own each, a triangle takes at most 108 bytes, so a patch
/// stays below the maximum of a block.
const PATCH_TRIANGLES: usize = 8192;

/// Isolated or imported vertices per patch, by the same reckoning.
const PATCH_VERTICES: usize = 16384;

const NONE: u32 = u32::MAX;

/// Writes the final triangles of nodes to a mesh stream, and numbers the vertices.
pub(super) struct PatchWriter<W: Write> {
    stream: StreamWriter<W>,
    /// For each point of the node, the last of its patches that uses it.
    last_use: Vec<u32>,
    /// For each point of the node, its local index in the patch that is stamped.
    local: Vec<u32>,
    stamp: Vec<u32>,
    live: u64,
    live_max: u64,
}

impl<W: Write> PatchWriter<W> {
    pub(super) fn new(stream: StreamWriter<W>) -> Self {
        let (last_use, local, stamp) = (Vec::new(), Vec::new(), Vec::new());
        PatchWriter { stream, last_use, local, stamp, live: 0, live_max: 0 }
    }

    pub(super) fn stream(&mut self) -> &mut StreamWriter<W> {
        &mut self.stream
    }

    pub(super) fn into_stream(self) -> StreamWriter<W> {
        self.stream
    }

    /// Most vertices that were written and not finalized at once: the width of the mesh.
    pub(super) fn live_max(&self) -> u64 {
        self.live_max
    }

    /// Writes a patch made elsewhere, whose ids already fit this stream.
    pub(super) fn forward(&mut self, patch: &Patch) -> Result<()> {
        self.stream.patch(patch)?;
        self.live += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live);
        self.live -= patch.finalized.len() as u64;
        Ok(())
    }

    /// Writes the final triangles of a node and finalizes its points that are done. Points that are written
    /// get their ids.
    pub(super) fn write(&mut self, solved: &mut Solved) -> Result<()> {
        self.prepare(solved);
        let unused = self.unused(solved);
        for (number, triangles) in (0..).zip(solved.triangles.chunks(PATCH_TRIANGLES)) {
            let corners = triangles.iter().flatten().copied();
            let patch = self.build(&mut solved.points, &solved.fates, number, corners, triangles);
            self.forward(&patch)?;
        }
        let next = solved.triangles.len().div_ceil(PATCH_TRIANGLES) as u32;
        for (number, vertices) in (next..).zip(unused.chunks(PATCH_VERTICES)) {
            vertices.iter().for_each(|&v| self.last_use[v as usize] = number);
            let patch = self.build(&mut solved.points, &solved.fates, number, vertices.iter().copied(), &[]);
            self.forward(&patch)?;
        }
        Ok(())
    }

    /// Finds the last patch of each point of the node.
    fn prepare(&mut self, solved: &Solved) {
        let points = solved.points.len();
        for array in [&mut self.last_use, &mut self.local, &mut self.stamp] {
            array.clear();
            array.resize(points, NONE);
        }
        for (number, triangles) in solved.triangles.chunks(PATCH_TRIANGLES).enumerate() {
            triangles.iter().flatten().for_each(|&v| self.last_use[v as usize] = number as u32);
        }
    }

    /// Points that are done but in no triangle written here: vertices of the hull whose triangles were all
    /// written below, and at the root the points of an input without triangles.
    fn unused(&self, solved: &Solved) -> Vec<u32> {
        let done = |&v: &usize| solved.fates[v] == PointFate::Done && self.last_use[v] == NONE;
        (0..solved.points.len()).filter(done).map(|v| v as u32).collect()
    }

    /// The patch `number` of a node: of `corners`, unwritten points become new vertices in order of
    /// appearance, the others are imported.
    fn build(
        &mut self,
        points: &mut Residual,
        fates: &[PointFate],
        number: u32,
        corners: impl Iterator<Item = u32>,
        triangles: &[[u32; 3]],
    ) -> Patch {
        let mut patch = Patch { first_id: self.stream.totals().vertices, ..Patch::default() };
        let mut new = Vec::new();
        let mut imported = Vec::new();
        for v in corners {
            let i = v as usize;
            if self.stamp[i] == number {
                continue;
            }
            self.stamp[i] = number;
            if points.ids[i] == UNWRITTEN {
                points.ids[i] = patch.first_id + new.len() as u64;
                self.local[i] = new.len() as u32;
                patch.new.push(points.point(i));
                new.push(v);
            } else {
                imported.push((points.ids[i], v));
            }
        }
        imported.sort_unstable();
        for (rank, &(id, v)) in imported.iter().enumerate() {
            self.local[v as usize] = (new.len() + rank) as u32;
            patch.imported.push(id);
        }
        patch.simplices.extend(triangles.iter().flatten().map(|&v| self.local[v as usize]));
        let is_last = |v: u32| fates[v as usize] == PointFate::Done && self.last_use[v as usize] == number;
        let in_local_order = new.iter().copied().chain(imported.iter().map(|&(_, v)| v));
        patch.finalized.extend(in_local_order.filter(|&v| is_last(v)).map(|v| self.local[v as usize]));
        patch
    }
}
