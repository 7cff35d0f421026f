//! Cuts the final triangles of a node into patches: vertices with their first triangle and finalized with their
//! last.
//!
//! All of it happens where the node is triangulated, before it is known how many vertices precede it in the
//! stream. So references stand for the ids of imported vertices: the number of a vertex among those that the node
//! writes itself, or the number of a point among those that the nodes below have left.

use std::ops::Range;

use super::residual::{Residual, UNWRITTEN};
use crate::error::Result;
use crate::stream::{PatchBlocks, PointCode};

/// Triangles per patch. With three vertices of its own each, a triangle takes at most 108 bytes, so a patch
/// stays below the maximum of a block.
const PATCH_TRIANGLES: usize = 8192;

/// Isolated or imported vertices per patch, by the same reckoning.
const PATCH_VERTICES: usize = 16384;

/// Bits of a key that count the vertices of a node, of which there are fewer than the kernel takes points.
const KEY_BITS: u32 = 30;

/// Bit of a reference to a vertex that the node writes itself.
pub(super) const OWN: u64 = 1 << 63;

const NONE: u32 = u32::MAX;

/// Builds the patches of one node after the other, in buffers that are used again.
///
/// The vertices of a patch have codes, counting up over all patches of a node; so the code of a vertex in its
/// last patch, which stays, tells which patch that was.
#[derive(Default)]
pub(super) struct PatchBuilder {
    /// For each point, its code in the last patch that uses it; 0 if none does.
    codes: Vec<u32>,
    /// Code of the first vertex of the patch.
    first_code: u32,
    /// Vertices of the patch, in order of appearance.
    vertices: Vec<u32>,
    /// Corners of the triangles of the patch, as indices into `vertices`.
    corners: Vec<u32>,
    /// For each of `vertices`, its local index.
    locals: Vec<u32>,
    /// Key and index in `vertices` of the imported ones.
    imported: Vec<(u64, u32)>,
    /// For each point, its number among the vertices that the node writes.
    own: Vec<u32>,
    own_count: u32,
    /// Vertices of all patches, by patch in local order, and where each patch has its own.
    order: Vec<u32>,
    patches: Vec<Range<usize>>,
}

impl PatchBuilder {
    /// Begins with a node of `points` points.
    pub(super) fn start(&mut self, points: usize) {
        for (array, value) in [(&mut self.codes, 0), (&mut self.own, NONE)] {
            array.clear();
            array.resize(points, value);
        }
        self.first_code = 1;
        self.own_count = 0;
        self.vertices.clear();
        self.corners.clear();
        self.order.clear();
        self.patches.clear();
    }

    /// Adds a final triangle.
    ///
    /// # Errors
    /// As [`PatchBlocks::push`].
    #[inline]
    pub(super) fn triangle(
        &mut self,
        triangle: &[u32; 3],
        points: &Residual,
        code: PointCode,
        blocks: &mut PatchBlocks,
    ) -> Result<()> {
        let corners = triangle.map(|v| self.index(v));
        self.corners.extend_from_slice(&corners);
        if self.corners.len() == 3 * PATCH_TRIANGLES { self.close(points, code, blocks) } else { Ok(()) }
    }

    /// Ends the triangles, and adds the vertices that are in none of them.
    ///
    /// # Errors
    /// As [`PatchBlocks::push`].
    pub(super) fn finish(
        &mut self,
        unused: impl Iterator<Item = u32>,
        points: &Residual,
        code: PointCode,
        blocks: &mut PatchBlocks,
    ) -> Result<()> {
        self.close(points, code, blocks)?;
        for v in unused {
            self.index(v);
            if self.vertices.len() == PATCH_VERTICES {
                self.close(points, code, blocks)?;
            }
        }
        self.close(points, code, blocks)
    }

    /// Finalizes in each patch the vertices for which it is the last, if they are done.
    pub(super) fn finalize(&self, is_done: impl Fn(u32) -> bool, blocks: &mut PatchBlocks) {
        for (number, range) in self.patches.iter().enumerate() {
            let codes = range.start as u32 + 1..range.end as u32 + 1;
            let is_last = |v: u32| codes.contains(&self.codes[v as usize]) && is_done(v);
            let locals = (0..).zip(&self.order[range.clone()]);
            blocks.finalize(number, locals.filter(|&(_, &v)| is_last(v)).map(|(local, _)| local));
        }
    }

    /// Whether `v` is in no patch so far.
    pub(super) fn is_unused(&self, v: u32) -> bool {
        self.codes[v as usize] == 0
    }

    /// A reference to a point that is a vertex by now; [`UNWRITTEN`] for one that is none.
    pub(super) fn reference(&self, v: u32, points: &Residual) -> u64 {
        match self.own[v as usize] {
            NONE if points.key(v as usize) == UNWRITTEN => UNWRITTEN,
            NONE => u64::from(v) - points.raw as u64,
            own => OWN | u64::from(own),
        }
    }

    /// Key of a point: vertices of node `number` come behind those of nodes with lesser numbers.
    pub(super) fn key(&self, v: u32, number: u64, points: &Residual) -> u64 {
        match self.own[v as usize] {
            NONE => points.key(v as usize),
            own => number << KEY_BITS | u64::from(own),
        }
    }

    /// Index of `v` in the patch, which it enters if it is new to it.
    #[inline]
    fn index(&mut self, v: u32) -> u32 {
        let code = &mut self.codes[v as usize];
        if *code < self.first_code {
            *code = self.first_code + self.vertices.len() as u32;
            self.vertices.push(v);
        }
        *code - self.first_code
    }

    /// Writes the patch, if there is anything in it: unwritten points become new vertices in order of appearance,
    /// the others are imported.
    fn close(&mut self, points: &Residual, code: PointCode, blocks: &mut PatchBlocks) -> Result<()> {
        if self.vertices.is_empty() {
            return Ok(());
        }
        let start = self.order.len();
        self.locals.clear();
        self.imported.clear();
        for (i, &v) in (0..).zip(&self.vertices) {
            let own = &mut self.own[v as usize];
            let key = if *own == NONE { points.key(v as usize) } else { OWN | u64::from(*own) };
            if key == UNWRITTEN {
                *own = self.own_count;
                self.own_count += 1;
                self.locals.push((self.order.len() - start) as u32);
                self.order.push(v);
            } else {
                self.locals.push(NONE);
                self.imported.push((key, i));
            }
        }
        let imported_start = self.order.len();
        self.imported.sort_unstable();
        for &(_, i) in &self.imported {
            self.locals[i as usize] = (self.order.len() - start) as u32;
            self.order.push(self.vertices[i as usize]);
        }
        let new = self.order[start..imported_start].iter().map(|&v| points.point(v as usize));
        let imported = self.order[imported_start..].iter().map(|&v| self.reference(v, points));
        let simplices = self.corners.iter().map(|&i| self.locals[i as usize]);
        blocks.push(code, new, imported, simplices)?;
        self.patches.push(start..self.order.len());
        self.first_code += self.vertices.len() as u32;
        self.vertices.clear();
        self.corners.clear();
        Ok(())
    }
}
