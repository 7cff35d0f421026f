//! The vertices that a part of a mesh shares with other parts.

use std::io::Write;

use super::residual::{UNWRITTEN, foreign_id};
use spmesh_base::error::Result;
use spmesh_stream::{GlobalId, PartName, Patch, StreamWriter};

/// Vertices per patch that does nothing but finalize them. Each takes 16 bytes.
const PATCH_VERTICES: usize = 16_384;

/// Vertices of the stream that are those of other parts: id in the stream, increasing, and id in all parts.
///
/// Memory: 16 bytes for each.
#[derive(Debug, Default)]
pub(super) struct Shared {
    vertices: Vec<(u64, GlobalId)>,
}

impl Shared {
    /// Adds vertices of a node, given by their numbers in the node; the first vertex of the node has the id
    /// `first`.
    pub(super) fn extend(&mut self, vertices: impl Iterator<Item = (u32, GlobalId)>, first: u64) {
        self.vertices.extend(vertices.map(|(own, id)| (first + u64::from(own), id)));
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// The name in all parts of vertex `id` of this stream, which is part `part`. Points that are no
    /// vertices, and vertices that only other parts have, keep their names.
    pub(super) fn global(&self, part: Option<PartName>, id: u64) -> Result<u64> {
        if id == UNWRITTEN {
            return Ok(UNWRITTEN);
        }
        if let Some(foreign) = foreign_id(id) {
            return Ok(foreign.0);
        }
        match self.vertices.binary_search_by_key(&id, |&(vertex, _)| vertex) {
            Ok(found) => Ok(self.vertices[found].1.0),
            Err(before) => {
                let part = part.map_or(0, |part| part.below);
                Ok(GlobalId::new(part, id - before as u64)?.0)
            }
        }
    }

    /// Finalizes the vertices among `ids`, which are those of the residual: in this stream nothing uses them
    /// any more, but other parts do.
    pub(super) fn keep<W: Write>(&self, stream: &mut StreamWriter<W>, ids: &[u64]) -> Result<()> {
        let is_here = |&id: &u64| id != UNWRITTEN && foreign_id(id).is_none();
        let mut kept: Vec<u64> = ids.iter().copied().filter(is_here).collect();
        kept.sort_unstable();
        for imported in kept.chunks(PATCH_VERTICES) {
            let locals: Vec<u32> = (0..imported.len() as u32).collect();
            stream.patch(&Patch {
                first_id: stream.totals().vertices,
                imported: imported.to_vec(),
                finalized: locals.clone(),
                kept: locals,
                ..Patch::default()
            })?;
        }
        Ok(())
    }
}
