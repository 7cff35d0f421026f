//! The vertices of a mesh stream that a later patch may still use.

use super::ascending::{Ascending, Place};
use super::event::Patch;
use crate::model::bounds::Point;
use spmesh_base::error::{Error, ErrorKind, Result, counted};

/// Vertices between their patch and their finalization, with a value `T` that the consumer keeps for each.
///
/// Memory grows with the width of the stream, not with its length: that of [`Ascending`].
#[derive(Debug)]
pub struct LiveVertices<T> {
    live: Ascending<T>,
    local: Vec<(u64, T)>,
    /// Where the imported vertices of the current patch are.
    places: Vec<Place>,
    live_max: usize,
    /// Most vertices that may be live.
    most: usize,
}

impl<T> Default for LiveVertices<T> {
    fn default() -> Self {
        let (local, places, most) = (Vec::new(), Vec::new(), usize::MAX);
        LiveVertices { live: Ascending::default(), local, places, live_max: 0, most }
    }
}

impl<T: Copy> LiveVertices<T> {
    /// No vertices.
    pub fn new() -> Self {
        LiveVertices::default()
    }

    /// No vertices, and memory for so many bytes of them.
    pub fn within(bytes: u64) -> Self {
        let most = usize::try_from(bytes / Self::BYTES).unwrap_or(usize::MAX);
        LiveVertices { most, ..LiveVertices::default() }
    }

    /// Bytes of a vertex.
    pub const BYTES: u64 = (size_of::<T>() + 4) as u64 * 9 / 8 + 1;

    /// Adds the new vertices of `patch`, with the values that `value_of` gives them. Returns id and value of
    /// each local vertex, and forgets the vertices that the patch finalizes. Patches come in the order of the
    /// stream.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if the patch uses a vertex that is finalized or unknown;
    /// [`spmesh_base::error::ErrorKind::Memory`] if more vertices are live than memory has room for.
    pub fn enter(&mut self, patch: &Patch, mut value_of: impl FnMut(u64, Point) -> T) -> Result<&[(u64, T)]> {
        self.local.clear();
        for (&point, id) in patch.new.iter().zip(patch.first_id..) {
            self.local.push((id, value_of(id, point)));
        }
        self.import(patch)?;
        self.live_max = self.live_max.max(self.live.len() + patch.new.len());
        // Most vertices are finalized by the patch that brings them: these never enter the map.
        let mut finalized = patch.finalized.iter().peekable();
        for (local, &(id, value)) in (0..).zip(&self.local[..patch.new.len()]) {
            if finalized.next_if_eq(&&local).is_none() {
                self.live.push(id, value);
            }
        }
        // The places of those that are finalized move to the front.
        let mut count = 0;
        for &local in finalized {
            self.places[count] = self.places[local as usize - patch.new.len()];
            count += 1;
        }
        self.live.forget(&self.places[..count]);
        if self.live.len() > self.most {
            return Err(self.too_many());
        }
        Ok(&self.local)
    }

    fn too_many(&self) -> Error {
        let (found, most) = (counted(self.live.len() as u64, "vertex is", "vertices are"), self.most);
        let message = format!("{found} not final so far, and --memory has room for {most}");
        Error::new(ErrorKind::Memory, format!("{message}: raise it, or make the mesh with spdelaunay2d"))
    }

    /// Finds the imported vertices of a patch.
    fn import(&mut self, patch: &Patch) -> Result<()> {
        self.live.find_all(&patch.imported, &mut self.places).map_err(|id| {
            Error::malformed(if id < patch.first_id {
                format!("vertex {id} referenced after finalization")
            } else {
                format!("vertex {id} referenced before it was written")
            })
        })?;
        let values = self.places.iter().map(|&place| *self.live.at(place));
        self.local.extend(patch.imported.iter().copied().zip(values));
        Ok(())
    }

    /// Forgets a live vertex that a residual point names, and returns its value: no later patch uses it.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if the vertex is finalized or unknown, or was named
    /// before.
    pub fn retire(&mut self, id: u64) -> Result<T> {
        let place = self.live.find(id, Place::default());
        let unknown = || Error::malformed(format!("residual point names vertex {id}, which is not live"));
        let place = place.ok_or_else(unknown)?;
        let value = *self.live.at(place);
        self.live.forget(&[place]);
        Ok(value)
    }

    /// Ids and values of all live vertices, in the order of ids.
    pub fn iter(&self) -> impl Iterator<Item = (u64, T)> + '_ {
        self.live.iter().map(|(id, &value)| (id, value))
    }

    /// Whether a vertex is live, so that a later patch may use it.
    pub fn contains(&self, id: u64) -> bool {
        self.live.get(id).is_some()
    }

    /// Number of live vertices.
    pub fn len(&self) -> usize {
        self.live.len()
    }

    /// What they take in memory.
    pub fn bytes(&self) -> u64 {
        self.len() as u64 * Self::BYTES
    }

    /// Whether no vertex is live.
    pub fn is_empty(&self) -> bool {
        self.live.is_empty()
    }

    /// Greatest number of vertices that were live at once: the width of the stream.
    pub fn live_max(&self) -> usize {
        self.live_max
    }
}
