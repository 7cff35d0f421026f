//! Cuts the final simplices of a node into patches. A vertex comes with its first simplex and is finalized
//! with its last.
//!
//! The thread that triangulates the node cuts it, before the number of preceding vertices in the stream is
//! known. So references stand for the ids of imported vertices. A reference is the number of a vertex among
//! the vertices that the node writes itself, or the number of a point among the points that the nodes below
//! have left.

use super::residual::{Residual, UNWRITTEN, foreign_id};
use spmesh_base::error::Result;
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;
use spmesh_stream::{PatchBlocks, PointCode};

/// Isolated or imported vertices per patch, which take 36 bytes at most; fewer if their rows are long.
const PATCH_VERTICES: usize = 16384;

/// Simplices of D + 1 corners per patch. If all their vertices are new, a triangle takes at most 108 bytes
/// and a tetrahedron 128, so that a patch stays below the maximum of a block. Fewer if rows are long.
const fn patch_simplices(dimensions: usize) -> usize {
    if dimensions == 2 { 8192 } else { 8000 }
}

/// Bits of a key for the number of a vertex within its node; the kernel takes fewer than 2^30 points.
const KEY_BITS: u32 = 30;

/// Bit of a reference to a vertex that the node writes itself.
pub(super) const OWN: u64 = 1 << 63;

/// Stands for a missing number of a vertex that the node writes, and for a missing index in `locals`.
const NO_VERTEX: u32 = u32::MAX;

/// `UNUSED` and `KEPT` stand for the number of the last patch of a point that is in no patch, or that is not
/// finalized here. No code is as great: there are fewer codes than corners of simplices.
const UNUSED: u32 = u32::MAX;
const KEPT: u32 = u32::MAX - 1;

/// Builds the patches of one node after the other, in buffers that are used again.
///
/// The vertices of a patch have codes that count up over all patches of a node, so that no code has to be
/// reset. After the last patch, the code of a vertex tells its last patch, and [`PatchBuilder::finish`]
/// finalizes the vertices of all patches.
///
/// Patches that are flushed one by one need to know that earlier. Then all final simplices are planned first,
/// in the order in which they are written: patches have a fixed number of simplices.
#[derive(Default)]
pub(super) struct PatchBuilder<const D: usize> {
    /// Whether patches are flushed one by one.
    is_planned: bool,
    /// For each point, the number of the last patch that uses it, [`UNUSED`] or [`KEPT`]; empty without a
    /// plan.
    last: Vec<u32>,
    /// Number of the patch that is planned, and simplices that it still takes.
    planned: u32,
    room: usize,
    /// Patches that are closed.
    closed: u32,
    /// Simplices and isolated vertices per patch.
    simplices_max: usize,
    vertices_max: usize,
    /// For each point, its code in the last patch so far that uses it; 0 if none does; [`KEPT`].
    codes: Vec<u32>,
    /// Code of the first vertex of the patch.
    first_code: u32,
    /// Vertices of the patch, in order of appearance: so many of the array, which has room for all that a
    /// patch takes.
    vertices: Vec<u32>,
    vertex_count: usize,
    /// Corners of the simplices of the patch, as indices into `vertices`.
    corners: Vec<u32>,
    /// For each of `vertices`, its local index.
    locals: Vec<u32>,
    /// Key and index in `vertices` of each imported vertex.
    imported: Vec<(u64, u32)>,
    /// For each point, its number among the vertices that the node writes.
    own: Vec<u32>,
    own_count: u32,
    /// Vertices of the patch in local order, behind those of earlier patches if these are not finalized yet.
    order: Vec<u32>,
    /// One past the last of `order`, and the first code of the next patch, for each patch that is not
    /// finalized yet.
    ends: Vec<[u32; 2]>,
}

/// Called after each patch, with the blocks that it has not taken yet.
pub(super) type Flush<'f> = dyn FnMut(&mut PatchBlocks) -> Result<()> + 'f;

impl<const D: usize> PatchBuilder<D> {
    /// Begins a node of `points` points, of which so many will be `isolated` before the first simplex. If
    /// `is_planned`, all final simplices are planned before the first is added, and patches can be flushed.
    pub(super) fn start(&mut self, points: usize, code: PointCode, isolated: usize, is_planned: bool) {
        // New vertices whose rows fill a block.
        let rows_max = BLOCK_PAYLOAD_MAX.checked_div(code.row_len()).unwrap_or(usize::MAX);
        self.simplices_max = patch_simplices(D).min(rows_max / (D + 1));
        self.vertices_max = PATCH_VERTICES.min(rows_max);
        self.is_planned = is_planned;
        let planned = if is_planned { points } else { 0 };
        let arrays = [
            (&mut self.codes, points, 0),
            (&mut self.own, points, NO_VERTEX),
            (&mut self.last, planned, UNUSED),
        ];
        for (array, len, value) in arrays {
            array.clear();
            array.resize(len, value);
        }
        self.planned = isolated.div_ceil(self.vertices_max) as u32;
        self.room = self.simplices_max;
        self.closed = 0;
        self.first_code = 1;
        self.own_count = 0;
        self.vertices.resize(self.vertices_max.max((D + 1) * self.simplices_max), 0);
        self.vertex_count = 0;
        self.corners.clear();
        self.order.clear();
        self.ends.clear();
    }

    /// Whether simplices must be planned.
    pub(super) fn is_planned(&self) -> bool {
        self.is_planned
    }

    /// Plans a final simplex.
    #[inline]
    pub(super) fn plan(&mut self, simplex: &[u32]) {
        if self.room == 0 {
            self.planned += 1;
            self.room = self.simplices_max;
        }
        self.room -= 1;
        for &v in simplex {
            self.last[v as usize] = self.planned;
        }
    }

    /// Whether `v` is in no simplex that was planned, or without a plan, added.
    pub(super) fn is_unused(&self, v: u32) -> bool {
        if self.is_planned { self.last[v as usize] == UNUSED } else { self.codes[v as usize] == 0 }
    }

    /// Keeps `v` from being finalized here, because a node above uses it. Without a plan, call it when all
    /// simplices are added.
    pub(super) fn keep(&mut self, v: u32) {
        let of_vertex = if self.is_planned { &mut self.last } else { &mut self.codes };
        of_vertex[v as usize] = KEPT;
    }

    /// Adds a final simplex, in the order in which they were planned if there is a plan. Returns whether the
    /// patch is full and must be closed.
    #[inline(always)]
    pub(super) fn add(&mut self, simplex: &[u32]) -> bool {
        let first = self.corners.len();
        self.corners.extend_from_slice(simplex);
        for at in first..first + simplex.len() {
            self.corners[at] = self.index(self.corners[at]);
        }
        self.corners.len() >= (D + 1) * self.simplices_max
    }

    /// Adds vertices that are in no simplex and finalized here, in patches of their own.
    pub(super) fn isolated(
        &mut self,
        vertices: impl Iterator<Item = u32>,
        points: &Residual<D>,
        code: PointCode,
        blocks: &mut PatchBlocks,
        mut flush: Option<&mut Flush>,
    ) -> Result<()> {
        let mut close = |builder: &mut Self, blocks: &mut PatchBlocks| {
            builder.close(points, code, blocks)?;
            flush.as_mut().map_or(Ok(()), |flush| flush(blocks))
        };
        close(self, blocks)?;
        for v in vertices {
            self.index(v);
            if self.vertex_count == self.vertices_max {
                close(self, blocks)?;
            }
        }
        close(self, blocks)
    }

    /// Finalizes the vertices of all patches, when all are closed and vertices to be kept are known. With a
    /// plan, that has happened.
    pub(super) fn finish(&mut self, blocks: &mut PatchBlocks) {
        let mut start = 0;
        for (patch, [end, next_code]) in self.ends.drain(..).enumerate() {
            let vertices = &self.order[start..end as usize];
            let is_last = |v: u32| self.codes[v as usize] < next_code;
            blocks.finalize(patch, locals_where(vertices, is_last));
            start = end as usize;
        }
    }

    /// A reference to a point that is a written vertex; the key of a vertex that only other parts have;
    /// [`UNWRITTEN`] for other points.
    pub(super) fn reference(&self, v: u32, points: &Residual<D>) -> u64 {
        match self.own[v as usize] {
            NO_VERTEX if points.key(v as usize) == UNWRITTEN => UNWRITTEN,
            NO_VERTEX if foreign_id(points.key(v as usize)).is_some() => points.key(v as usize),
            NO_VERTEX => u64::from(v) - points.raw as u64,
            own => OWN | u64::from(own),
        }
    }

    /// Key of a point: vertices of node `number` follow those of nodes with lesser numbers.
    pub(super) fn key(&self, v: u32, number: u64, points: &Residual<D>) -> u64 {
        match self.own[v as usize] {
            NO_VERTEX => points.key(v as usize),
            own => number << KEY_BITS | u64::from(own),
        }
    }

    /// Index of `v` in the patch. Adds it if it is new to the patch. Without a branch, which would be hard to
    /// predict.
    #[inline(always)]
    fn index(&mut self, v: u32) -> u32 {
        let code = &mut self.codes[v as usize];
        let is_new = *code < self.first_code;
        *code = if is_new { self.first_code + self.vertex_count as u32 } else { *code };
        self.vertices[self.vertex_count] = v;
        self.vertex_count += usize::from(is_new);
        *code - self.first_code
    }

    /// Encodes the patch, unless it is empty. Points that this stream does not have yet become new vertices
    /// in order of appearance, the others are imported. Vertices that are in no later patch and not kept are
    /// finalized.
    pub(super) fn close(
        &mut self,
        points: &Residual<D>,
        code: PointCode,
        blocks: &mut PatchBlocks,
    ) -> Result<()> {
        if self.vertex_count == 0 {
            return Ok(());
        }
        // Without a plan, the vertices of earlier patches stay.
        if self.is_planned {
            self.order.clear();
        }
        self.locals.clear();
        self.imported.clear();
        let start = self.order.len();
        for (i, &v) in (0..).zip(&self.vertices[..self.vertex_count]) {
            let own = &mut self.own[v as usize];
            let key = if *own == NO_VERTEX { points.key(v as usize) } else { OWN | u64::from(*own) };
            if key == UNWRITTEN || foreign_id(key).is_some() {
                *own = self.own_count;
                self.own_count += 1;
                self.locals.push((self.order.len() - start) as u32);
                self.order.push(v);
            } else {
                self.locals.push(NO_VERTEX);
                self.imported.push((key, i));
            }
        }
        let new_end = self.order.len();
        self.imported.sort_unstable();
        for &(_, i) in &self.imported {
            self.locals[i as usize] = (self.order.len() - start) as u32;
            self.order.push(self.vertices[i as usize]);
        }
        let (new, imported) = self.order[start..].split_at(new_end - start);
        let simplices = self.corners.iter().map(|&i| self.locals[i as usize]);
        let rows = new.iter().map(|&v| points.row(v as usize));
        let references = imported.iter().map(|&v| self.reference(v, points));
        blocks.push(code, new.iter().map(|&v| points.point(v as usize)), references, simplices, rows)?;
        for (local, &v) in (0..).zip(new) {
            if let Some(id) = foreign_id(points.key(v as usize)) {
                blocks.origin(local, self.own[v as usize], id);
            }
        }
        let next_code = self.first_code + self.vertex_count as u32;
        if self.is_planned {
            let is_last = |v: u32| self.last[v as usize] == self.closed || self.last[v as usize] == UNUSED;
            blocks.finalize(blocks.count() - 1, locals_where(&self.order, is_last));
        } else {
            self.ends.push([self.order.len() as u32, next_code]);
        }
        self.closed += 1;
        self.first_code = next_code;
        self.vertex_count = 0;
        self.corners.clear();
        Ok(())
    }
}

/// The local indices of the vertices of a patch that satisfy a condition.
fn locals_where(vertices: &[u32], mut condition: impl FnMut(u32) -> bool) -> impl Iterator<Item = u32> {
    (0..).zip(vertices).filter(move |&(_, &v)| condition(v)).map(|(local, _)| local)
}
