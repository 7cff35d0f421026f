//! The output: patches that pass, and patches of triangles that waited.

use std::io::Write;

use super::Stats;
use super::cut::Cut;
use super::strip::Strip;
use spmesh_base::error::Result;
use spmesh_delaunay::network::{Network, NetworkSegment};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;
use spmesh_stream::{Patch, Segment, StreamWriter};

/// Triangles, new vertices and finalized vertices of a patch at most, so that it fits a block.
const PATCH_MAX: usize = 8192;

/// Segments of a block at most.
const SEGMENTS_MAX: usize = 8192;

/// References to new vertices count down from here; all others are ids of the output.
const NEW: u64 = u64::MAX;

/// A triangle to be written.
#[derive(Debug, Clone, Copy)]
struct Triangle {
    vertices: [u64; 3],
    /// Segments of the sides opposite to the vertices.
    segments: [Option<u32>; 3],
    places: [Point2; 3],
}

/// Writes the mesh. Vertices keep their order, so ids grow by the number of vertices that were added before
/// them.
pub(super) struct Writing<W: Write> {
    writer: StreamWriter<W>,
    /// For each group of vertices that were added: the first id of the input after them, and how many were
    /// added so far.
    shifts: Vec<[u64; 2]>,
    /// Number of vertices of the input so far.
    next_id: u64,
    /// Triangles of strips, by references.
    triangles: Vec<Triangle>,
    /// Segments that were clipped.
    segments: Vec<Segment>,
    new: Vec<Point>,
    /// Ids of vertices that are final after these triangles.
    finalized: Vec<u64>,
    /// The attributes of a vertex that is added.
    row: Vec<u8>,
    cut: Cut,
}

impl<W: Write> Writing<W> {
    /// Writes the segments.
    pub(super) fn new(mut writer: StreamWriter<W>, network: &Network, cut: Cut) -> Result<Writing<W>> {
        for segments in network.segments.chunks(SEGMENTS_MAX) {
            let segment = |it: &NetworkSegment| Segment { line: it.line, ends: network.places(it) };
            writer.segments(&segments.iter().map(segment).collect::<Vec<_>>())?;
        }
        let row = writer.header().attributes.unknown_row();
        Ok(Writing {
            writer,
            shifts: Vec::new(),
            next_id: 0,
            triangles: Vec::new(),
            segments: Vec::new(),
            new: Vec::new(),
            finalized: Vec::new(),
            row,
            cut,
        })
    }

    /// The id in the output of a vertex of the input.
    fn id(&self, id: u64) -> u64 {
        let after = self.shifts.partition_point(|&[first, _]| first <= id);
        after.checked_sub(1).map_or(id, |last| id + self.shifts[last][1])
    }

    /// Whether a triangle of the input stays in its patch: it is not cut off, and cannot be later. `ids` are
    /// those of the input, `on` the segments of its sides.
    #[inline]
    pub(super) fn keeps(
        &mut self,
        places: [Point2; 3],
        on: [Option<u32>; 3],
        ids: impl FnOnce() -> [u64; 3],
    ) -> Result<bool> {
        if !self.cut.is_cut() {
            return Ok(true);
        }
        if !self.cut.keeps(places, on, [false; 2]) {
            return Ok(false);
        }
        let ids = ids().map(|id| self.id(id));
        Ok(!self.cut.waits(ids, places, on)?)
    }

    /// Whether a triangle that may be cut off has this vertex of the input.
    pub(super) fn holds(&self, id: u64) -> bool {
        self.cut.is_cut() && self.cut.holds(self.id(id))
    }

    /// Writes a patch of the input.
    pub(super) fn patch(&mut self, mut patch: Patch, rows: &[u8]) -> Result<()> {
        self.next_id = patch.first_id + patch.new.len() as u64;
        if !self.shifts.is_empty() {
            patch.first_id = self.writer.totals().vertices;
            for place in 0..patch.imported.len() {
                patch.imported[place] = self.id(patch.imported[place]);
            }
        }
        self.writer.patch_with_rows(&patch, rows)
    }

    /// Adds the triangles of a strip, whose corners have these ids in the input.
    pub(super) fn add(&mut self, ids: &[u64], finalized: &[u64], strip: &Strip) {
        let first_new = self.new.len() as u64;
        for (number, piece) in strip.pieces.iter().enumerate() {
            let places = piece.points.map(|point| strip.places[point as usize]);
            let crossed = strip.crossed.get(number).copied().unwrap_or_default();
            if self.cut.keeps(places, piece.segments, crossed) {
                let vertices = piece.points.map(|point| match (point as usize).checked_sub(ids.len()) {
                    None => self.id(ids[point as usize]),
                    Some(new) => NEW - (first_new + new as u64),
                });
                self.triangles.push(Triangle { vertices, segments: piece.segments, places });
            }
        }
        for &id in finalized {
            let id = self.id(id);
            self.finalized.push(id);
        }
        self.segments.extend(&strip.clipped);
        self.new.extend(strip.new.iter().map(|&(_, point)| point));
    }

    /// Writes what was added.
    pub(super) fn flush(&mut self) -> Result<()> {
        if !self.segments.is_empty() {
            self.writer.segments(&self.segments)?;
            self.segments.clear();
        }
        let mut triangles = std::mem::take(&mut self.triangles);
        let (mut finalized, new) = (std::mem::take(&mut self.finalized), std::mem::take(&mut self.new));
        let first = self.writer.totals().vertices;
        let resolve = |reference: u64| {
            let new_number = NEW - reference;
            if new_number < new.len() as u64 { first + new_number } else { reference }
        };
        for triangle in &mut triangles {
            triangle.vertices = triangle.vertices.map(resolve);
        }
        if self.cut.is_cut() {
            triangles = self.without_waiting(triangles)?;
        }
        finalized.extend(first..first + new.len() as u64);
        finalized.retain(|&id| !self.cut.holds(id));
        self.write(&new, &triangles, &mut finalized)?;
        if !new.is_empty() {
            let added = self.shifts.last().map_or(0, |shift| shift[1]) + new.len() as u64;
            self.shifts.push([self.next_id, added]);
        }
        triangles.clear();
        finalized.clear();
        (self.triangles, self.finalized) = (triangles, finalized);
        Ok(())
    }

    /// Triangles but for those that wait because they may be cut off.
    fn without_waiting(&mut self, triangles: Vec<Triangle>) -> Result<Vec<Triangle>> {
        let mut kept = Vec::with_capacity(triangles.len());
        for triangle in triangles {
            if !self.cut.waits(triangle.vertices, triangle.places, triangle.segments)? {
                kept.push(triangle);
            }
        }
        Ok(kept)
    }

    /// Writes vertices, then triangles, and finalizes vertices, in as many patches as it takes.
    fn write(&mut self, mut new: &[Point], triangles: &[Triangle], finalized: &mut [u64]) -> Result<()> {
        while new.len() > PATCH_MAX {
            let (part, rest) = new.split_at(PATCH_MAX);
            self.write_patch(part, &[], &[])?;
            new = rest;
        }
        let mut rest = triangles;
        while rest.len() > PATCH_MAX {
            let (part, others) = rest.split_at(PATCH_MAX);
            self.write_patch(std::mem::take(&mut new), part, &[])?;
            rest = others;
        }
        finalized.sort_unstable();
        let mut parts = finalized.chunks(PATCH_MAX);
        let last = parts.next().unwrap_or_default();
        if !new.is_empty() || !rest.is_empty() || !last.is_empty() {
            self.write_patch(new, rest, last)?;
        }
        parts.try_for_each(|part| self.write_patch(&[], &[], part))
    }

    /// Writes a patch of new vertices, of triangles of vertices with ids, and of vertices to be finalized.
    fn write_patch(&mut self, new: &[Point], triangles: &[Triangle], finalized: &[u64]) -> Result<()> {
        let first_id = self.writer.totals().vertices;
        let used = triangles.iter().flat_map(|triangle| triangle.vertices).chain(finalized.iter().copied());
        let mut imported: Vec<u64> = used.filter(|&id| id < first_id).collect();
        imported.sort_unstable();
        imported.dedup();
        let local = |id: u64| match id.checked_sub(first_id) {
            Some(local) => local as u32,
            None => (new.len() + imported.binary_search(&id).expect("the vertex is imported")) as u32,
        };
        let mut locals: Vec<u32> = finalized.iter().map(|&id| local(id)).collect();
        locals.sort_unstable();
        let simplices = triangles.iter().flat_map(|triangle| triangle.vertices.map(local)).collect();
        let sides = (0..).zip(triangles).flat_map(|(number, triangle)| {
            let sides = (0..).zip(triangle.segments);
            sides.filter_map(move |(place, on)| Some([number, place, on?]))
        });
        let sides = sides.collect();
        let new = new.to_vec();
        let patch =
            Patch { first_id, new, imported, simplices, finalized: locals, sides, ..Patch::default() };
        self.writer.patch_with_rows(&patch, &self.row.repeat(patch.new.len()))
    }

    /// Writes the triangles that waited and were not cut off, and ends the stream. `open` are the segments
    /// that are not wholly edges. Returns the counts with those that are known now.
    pub(super) fn end(
        mut self,
        mut open: Vec<u32>,
        points: u64,
        merged: u64,
        stats: Stats,
    ) -> Result<(W, Stats)> {
        if let Some((mut waiting, mut vertices)) = self.cut.finish()? {
            let mut triangles = Vec::with_capacity(PATCH_MAX);
            while let Some((triangle, is_kept)) = waiting.next_decided()? {
                let segments = self.cut.decide(&triangle, is_kept);
                if is_kept {
                    triangles.push(Triangle { vertices: triangle.ids, segments, places: [[0.0; 2]; 3] });
                }
                if triangles.len() == PATCH_MAX {
                    self.write(&[], &triangles, &mut [])?;
                    triangles.clear();
                }
            }
            self.write(&[], &triangles, &mut vertices)?;
        }
        open.sort_unstable();
        open.dedup();
        let open_segments = open.len() as u64;
        open.extend(self.cut.take_open());
        open.sort_unstable();
        open.dedup();
        let cut_segments = open.len() as u64 - open_segments;
        for open in open.chunks(SEGMENTS_MAX) {
            self.writer.open_segments(open)?;
        }
        let triangles = [stats.triangles[0], self.writer.totals().simplices];
        let Cut { removed, divided, .. } = self.cut;
        let stats = Stats { triangles, open_segments, cut_segments, removed, divided, ..stats };
        Ok((self.writer.end(points, merged)?, stats))
    }
}
