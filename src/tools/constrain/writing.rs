//! The output: patches that pass, and patches of triangles that waited.

use std::io::Write;

use super::strip::Strip;
use foldhash::HashMap;
use spmesh_core::error::Result;
use spmesh_model::bounds::Point;
use spmesh_model::network::{Network, NetworkSegment};
use spmesh_stream::{Patch, Segment, StreamWriter};

/// Triangles of a patch at most, so that it fits a block.
const TRIANGLES_MAX: usize = 8192;

/// Segments of a block at most.
const SEGMENTS_MAX: usize = 8192;

/// References to new vertices count down from here; all others are ids.
const NEW: u64 = u64::MAX;

/// Writes the mesh. Vertices keep their order, so ids grow by the number of vertices that were added before them.
pub(super) struct Writing<W: Write> {
    writer: StreamWriter<W>,
    /// For each group of vertices that were added: the first id of the input after them, and how many were
    /// added so far.
    shifts: Vec<[u64; 2]>,
    /// Ids of the input so far.
    next_id: u64,
    /// Triangles that waited, by references.
    triangles: Vec<[u64; 3]>,
    /// Segments of their sides.
    segments: Vec<[Option<u32>; 3]>,
    new: Vec<Point>,
    /// Ids of vertices that are final after these triangles.
    finalized: Vec<u64>,
    /// The attributes of a vertex that is added.
    row: Vec<u8>,
}

impl<W: Write> Writing<W> {
    /// Writes the segments.
    pub(super) fn new(mut writer: StreamWriter<W>, network: &Network) -> Result<Writing<W>> {
        for segments in network.segments.chunks(SEGMENTS_MAX) {
            let segment = |it: &NetworkSegment| Segment { line: it.line, ends: network.places(it) };
            writer.segments(&segments.iter().map(segment).collect::<Vec<_>>())?;
        }
        let row = vec![0; writer.header().attributes.row_len()];
        Ok(Writing {
            writer,
            shifts: Vec::new(),
            next_id: 0,
            triangles: Vec::new(),
            segments: Vec::new(),
            new: Vec::new(),
            finalized: Vec::new(),
            row,
        })
    }

    /// The number of triangles written.
    pub(super) fn triangles(&self) -> u64 {
        self.writer.totals().simplices
    }

    /// The id in the output of a vertex of the input.
    fn id(&self, id: u64) -> u64 {
        let after = self.shifts.partition_point(|&[first, _]| first <= id);
        after.checked_sub(1).map_or(id, |last| id + self.shifts[last][1])
    }

    /// Writes a patch of the input; `sides` are those on segments: triangle, place, segment.
    pub(super) fn patch(&mut self, mut patch: Patch, sides: Vec<[u32; 3]>, rows: &[u8]) -> Result<()> {
        patch.sides = sides;
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
        let reference = |point: u32| match (point as usize).checked_sub(ids.len()) {
            None => self.id(ids[point as usize]),
            Some(new) => NEW - (first_new + new as u64),
        };
        let triangles: Vec<[u64; 3]> = strip.pieces.iter().map(|piece| piece.points.map(reference)).collect();
        let finalized: Vec<u64> = finalized.iter().map(|&id| self.id(id)).collect();
        self.triangles.extend(triangles);
        self.segments.extend(strip.pieces.iter().map(|piece| piece.segments));
        self.new.extend(strip.new.iter().map(|&(_, point)| point));
        self.finalized.extend(finalized);
    }

    /// Writes what was added.
    pub(super) fn flush(&mut self) -> Result<()> {
        let triangles = std::mem::take(&mut self.triangles);
        let mut ids: HashMap<u64, u64> = HashMap::default();
        let is_single = triangles.len() <= TRIANGLES_MAX;
        let mut finalized = std::mem::take(&mut self.finalized);
        let segments = std::mem::take(&mut self.segments);
        for (chunk, segments) in triangles.chunks(TRIANGLES_MAX).zip(segments.chunks(TRIANGLES_MAX)) {
            let last = if is_single { &finalized[..] } else { &[] };
            let mut patch = self.chunk(chunk, &mut ids, last, is_single);
            patch.sides = (0..)
                .zip(segments)
                .flat_map(|(triangle, on)| {
                    (0..).zip(on).filter_map(move |(place, on)| Some([triangle, place, (*on)?]))
                })
                .collect();
            self.writer.patch_with_rows(&patch, &self.row.repeat(patch.new.len()))?;
        }
        if !is_single {
            finalized.extend(ids.values());
            finalized.sort_unstable();
            for ids in finalized.chunks(TRIANGLES_MAX) {
                let first_id = self.writer.totals().vertices;
                let finalized = (0..ids.len() as u32).collect();
                let patch = Patch { first_id, imported: ids.to_vec(), finalized, ..Patch::default() };
                self.writer.patch(&patch)?;
            }
        }
        if !self.new.is_empty() {
            let added = self.shifts.last().map_or(0, |shift| shift[1]) + self.new.len() as u64;
            self.shifts.push([self.next_id, added]);
        }
        self.triangles = triangles;
        self.triangles.clear();
        self.segments = segments;
        self.segments.clear();
        self.new.clear();
        finalized.clear();
        self.finalized = finalized;
        Ok(())
    }

    /// The patch of some triangles. `ids` are those of new vertices that earlier ones have. With `ends`, all new
    /// vertices are final after it, and those of `finalized`.
    fn chunk(
        &self,
        triangles: &[[u64; 3]],
        ids: &mut HashMap<u64, u64>,
        finalized: &[u64],
        ends: bool,
    ) -> Patch {
        let first_id = self.writer.totals().vertices;
        let mut patch = Patch { first_id, ..Patch::default() };
        let known =
            |reference: u64, ids: &HashMap<u64, u64>| ids.get(&reference).copied().unwrap_or(reference);
        let mut references: Vec<u64> = triangles.iter().flatten().map(|&it| known(it, ids)).collect();
        references.sort_unstable();
        references.dedup();
        let first_new = references.partition_point(|&it| NEW - it >= self.new.len() as u64);
        let new = references.split_off(first_new);
        for (&reference, id) in new.iter().zip(first_id..) {
            patch.new.push(self.new[(NEW - reference) as usize]);
            ids.insert(reference, id);
        }
        patch.imported = references;
        let local = |reference: u64| match known(reference, ids).checked_sub(first_id) {
            Some(new) => new as u32,
            None => {
                let id = known(reference, ids);
                let place = patch.imported.binary_search(&id).expect("a corner of a triangle");
                (patch.new.len() + place) as u32
            }
        };
        patch.simplices = triangles.iter().flatten().map(|&reference| local(reference)).collect();
        if ends {
            let mut locals: Vec<u32> = finalized.iter().map(|&id| local(id)).collect();
            locals.extend(0..patch.new.len() as u32);
            locals.sort_unstable();
            patch.finalized = locals;
        }
        patch
    }

    /// Ends the stream. `open` are the segments that are not wholly edges.
    pub(super) fn end(mut self, open: &[u32], points: u64, merged: u64) -> Result<W> {
        for open in open.chunks(SEGMENTS_MAX) {
            self.writer.open_segments(open)?;
        }
        self.writer.end(points, merged)
    }
}
