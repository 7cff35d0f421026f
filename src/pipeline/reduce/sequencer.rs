//! Writes nodes in their order, and assigns the ids of vertices.

use std::collections::BTreeMap;
use std::io::Write;

use super::duplicates::Merged;
use super::node::Solved;
use super::patches::OWN;
use super::residual::{Residual, UNWRITTEN, foreign_id};
use super::schedule::Output;
use super::shared::Shared;
use super::stats::Stats;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Header, Patch, PatchBlocks, StreamWriter};

/// What a run writes: the mesh, and the residual if it goes elsewhere.
#[derive(Debug)]
pub struct Outputs<W> {
    /// The mesh.
    pub mesh: W,
    /// The residual of a part, unless the part is the root.
    pub residual: Option<W>,
}

impl<W: Write + Send> Outputs<W> {
    /// The same outputs, lent.
    pub(super) fn borrowed(&mut self) -> Outputs<&mut (dyn Write + Send + '_)> {
        Outputs { mesh: &mut self.mesh, residual: self.residual.as_mut().map(|output| output as _) }
    }
}

/// Residual points per block.
const RESIDUAL_CHUNK: usize = 1 << 14;

/// What a written node has left for the node above.
#[derive(Debug)]
struct Left {
    /// Ids of the points of its residual, or [`UNWRITTEN`].
    ids: Vec<u64>,
    /// Number of its simplices that are not final.
    active: usize,
}

/// The output: everything that must happen in the order of the stream.
pub(super) struct Sequencer<W: Write> {
    stream: StreamWriter<W>,
    left: BTreeMap<u64, Left>,
    /// Ids of the points that the nodes below the open node have left.
    ids: Vec<u64>,
    /// Id of the first vertex of the open node.
    first: u64,
    /// Vertices of other parts.
    shared: Shared,
    /// Where the residual goes, if not into the stream itself.
    residual: Option<StreamWriter<W>>,
    merged: Merged,
    live: u64,
    live_max: u64,
    points: usize,
    points_max: usize,
    active: usize,
    active_max: usize,
}

impl<W: Write> Sequencer<W> {
    /// Writes to `stream`, and what is left to `residual`, if it is given.
    pub(super) fn new(stream: StreamWriter<W>, residual: Option<StreamWriter<W>>) -> Self {
        Sequencer {
            stream,
            shared: Shared::default(),
            residual,
            left: BTreeMap::new(),
            ids: Vec::new(),
            first: 0,
            merged: Merged::default(),
            live: 0,
            live_max: 0,
            points: 0,
            points_max: 0,
            active: 0,
            active_max: 0,
        }
    }

    /// The header of the mesh.
    pub(super) fn header(&self) -> &Header {
        self.stream.header()
    }

    /// Vertices written so far.
    pub(super) fn vertices(&self) -> u64 {
        self.stream.totals().vertices
    }

    /// Writes a patch of another stream whose ids already fit this one.
    pub(super) fn forward(&mut self, patch: &Patch, rows: &[u8]) -> Result<()> {
        self.stream.patch_with_rows(patch, rows)?;
        self.live += patch.new.len() as u64;
        self.live_max = self.live_max.max(self.live);
        self.live -= patch.finalized.len() as u64;
        Ok(())
    }

    /// Takes the ids of the residual of node `number`.
    pub(super) fn leave(&mut self, number: u64, ids: Vec<u64>, active: usize) {
        self.points += ids.len();
        self.points_max = self.points_max.max(self.points);
        self.active += active;
        self.active_max = self.active_max.max(self.active);
        self.left.insert(number, Left { ids, active });
    }

    /// Writes the next node. Returns its blocks, to be used again.
    pub(super) fn write<const D: usize>(&mut self, output: Output<D>) -> Result<PatchBlocks> {
        self.open(&output.children);
        self.close(output)
    }

    /// Opens the next node, over `children`.
    pub(super) fn open(&mut self, children: &[u64]) {
        self.take_left(children);
        self.first = self.stream.totals().vertices;
    }

    /// Writes patches of the open node, and empties `blocks`.
    pub(super) fn patches(&mut self, blocks: &mut PatchBlocks) -> Result<()> {
        let (ids, first) = (&self.ids, self.first);
        self.shared.extend(blocks.shared(), first);
        let (live, live_max) = (&mut self.live, &mut self.live_max);
        self.stream.patches(
            blocks,
            |reference| id_of(reference, first, ids),
            |new, finalized| {
                *live += new;
                *live_max = (*live_max).max(*live);
                *live -= finalized;
            },
        )?;
        blocks.clear();
        Ok(())
    }

    /// Writes the rest of the open node. Returns its blocks, to be used again.
    pub(super) fn close<const D: usize>(&mut self, output: Output<D>) -> Result<PatchBlocks> {
        let Solved { mut blocks, mut references, merged, .. } = output.solved;
        self.merged += merged;
        self.patches(&mut blocks)?;
        let (ids, first) = (&self.ids, self.first);
        references.iter_mut().for_each(|reference| *reference = id_of(*reference, first, ids));
        self.leave(output.number, references, output.active);
        Ok(blocks)
    }

    /// Writes the residual of a partial run, which the nodes `children` have left. None of its points is raw:
    /// the root is always triangulated, so that coinciding points are merged.
    pub(super) fn write_residual<const D: usize>(
        &mut self,
        children: &[u64],
        residual: &Residual<D>,
    ) -> Result<()> {
        self.take_left(children);
        debug_assert!(residual.raw == 0 && self.ids.len() == residual.len());
        if self.stream.header().part.is_some() {
            self.shared.keep(&mut self.stream, &self.ids)?;
            let part = self.stream.header().part;
            for id in &mut self.ids {
                *id = self.shared.global(part, *id)?;
            }
        }
        let stream = self.residual.as_mut().unwrap_or(&mut self.stream);
        let mut chunk: Vec<(Option<u64>, Point)> = Vec::with_capacity(RESIDUAL_CHUNK);
        for (number, ids) in self.ids.chunks(RESIDUAL_CHUNK).enumerate() {
            chunk.clear();
            chunk.extend(
                (number * RESIDUAL_CHUNK..)
                    .zip(ids)
                    .map(|(i, &id)| ((id != UNWRITTEN).then_some(id), residual.point(i))),
            );
            let row_len = residual.row_len();
            let rows = &residual.rows[number * RESIDUAL_CHUNK * row_len..][..chunk.len() * row_len];
            stream.residual_points_with_rows(&chunk, rows)?;
        }
        stream.walls(residual.walls.as_flattened())
    }

    /// Adds the figures of the output to `stats`.
    pub(super) fn add_to(&self, stats: &mut Stats) {
        stats.count(self.merged);
        stats.width = self.live_max;
        stats.residual_max = self.points_max as u64;
        stats.active_max = self.active_max as u64;
        stats.vertices = self.stream.totals().vertices;
        stats.shared = self.shared.len() as u64;
        stats.simplices = self.stream.totals().simplices;
    }

    /// Writes END, for `points` of the input, of which `merged` were merged with others, `merged_here` of them in
    /// this run.
    pub(super) fn end(self, points: u64, merged: u64, merged_here: u64) -> Result<Outputs<W>> {
        let residual = self.residual.map(|stream| stream.end(points, merged)).transpose()?;
        // A part counts the vertices that it has from other parts, and not the points that it leaves.
        let (points, merged) = match self.stream.header().part {
            Some(_) => (self.stream.totals().vertices + merged_here, merged_here),
            None => (points, merged),
        };
        Ok(Outputs { mesh: self.stream.end(points, merged)?, residual })
    }

    fn take_left(&mut self, children: &[u64]) {
        self.ids.clear();
        for child in children {
            if let Some(left) = self.left.remove(child) {
                self.points -= left.ids.len();
                self.active -= left.active;
                self.ids.extend(left.ids);
            }
        }
    }
}

/// The id that a reference of a node stands for. `first` is the id of the first vertex of the node, and `ids`
/// are the ids of the points that the nodes below have left.
#[inline]
fn id_of(reference: u64, first: u64, ids: &[u64]) -> u64 {
    match reference {
        UNWRITTEN => UNWRITTEN,
        own if own & OWN != 0 => first + (own & !OWN),
        foreign if foreign_id(foreign).is_some() => foreign,
        index => ids[index as usize],
    }
}
