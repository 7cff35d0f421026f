//! A mesh in parts as one plain stream.

use std::io::{self, Read};

use foldhash::{HashSet, HashSetExt};

use super::event::{Event, Patch, Totals};
use super::header::Header;
use super::live::LiveVertices;
use super::part::GlobalId;
use super::reader::StreamReader;
use super::writer::StreamWriter;
use spmesh_base::error::{Error, Result};

/// The bytes of a part, with the name that messages use.
pub type OpenedPart = (Box<dyn Read + Send>, String);

/// Opens part number `n`.
type Open = Box<dyn FnMut(u32) -> Result<OpenedPart> + Send>;

/// One part of a mesh: what is known of it before it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartSize {
    /// The number of the part.
    pub number: u32,
    /// Its vertices that no part before it has.
    pub vertices: u64,
    /// Its triangles or tetrahedra.
    pub simplices: u64,
}

/// Reads the parts of a mesh, one after the other, as the bytes of one stream without parts.
///
/// A vertex of several parts is written once, with the first of them, and finalized with the last. Ids of vertices
/// count up over all parts, so no table of ids is needed: the id of a vertex is its number in its part and the
/// number of vertices of the parts before.
///
/// Memory: 8 bytes for each part, one patch, the live vertices of one part, and 8 bytes for each vertex that a later
/// part may use: the residuals of nodes whose parent is still to come. An error of a part is the inner
/// error of the [`io::Error`].
pub struct JoinedMesh {
    open: Open,
    parts: std::vec::IntoIter<PartSize>,
    /// For each part number, the id of its first vertex in the joined mesh.
    first_ids: Vec<u64>,
    plan: u64,
    /// Vertices that parts have kept for later ones.
    kept: HashSet<u64>,
    current: Option<Current>,
    /// `None` after END.
    writer: Option<StreamWriter<Vec<u8>>>,
    /// Bytes that were written and not read yet, from `at` on.
    bytes: Vec<u8>,
    at: usize,
    /// Merged points of the parts so far.
    merged: u64,
    /// Points and merged points that all parts should have.
    stated: Totals,
}

/// The part that is being read.
struct Current {
    reader: StreamReader<Box<dyn Read + Send>>,
    size: PartSize,
    /// Its live vertices, each with its id in the joined mesh.
    live: LiveVertices<u64>,
    /// Vertices of its own so far.
    own: u64,
}

impl JoinedMesh {
    /// Joins `parts` of the plan `plan`, each after those whose vertices it uses. All of them have
    /// the `stated` points, so many of which are merged with others. `header` is that of the joined
    /// mesh; what it shares with those of the parts is checked.
    ///
    /// # Errors
    /// Malformed, if the parts are not numbered from 0 on; usage, if the header cannot be written.
    pub fn new(
        header: Header,
        plan: u64,
        parts: Vec<PartSize>,
        stated: Totals,
        open: Open,
    ) -> Result<JoinedMesh> {
        let mut first_ids = vec![u64::MAX; parts.len()];
        let mut vertices = 0u64;
        for part in &parts {
            let twice = || {
                Error::malformed(format!("part {} of {} comes twice, or is none", part.number, parts.len()))
            };
            let first = first_ids.get_mut(part.number as usize).filter(|first| **first == u64::MAX);
            *first.ok_or_else(twice)? = vertices;
            let sum = vertices.checked_add(part.vertices).filter(|sum| *sum < u64::MAX);
            vertices = sum.ok_or_else(|| Error::malformed("vertices beyond counting"))?;
        }
        let writer = StreamWriter::new(Vec::new(), header)?;
        let parts = parts.into_iter();
        Ok(JoinedMesh {
            open,
            parts,
            first_ids,
            plan,
            kept: HashSet::new(),
            current: None,
            writer: Some(writer),
            bytes: Vec::new(),
            at: 0,
            merged: 0,
            stated,
        })
    }

    /// Writes the next block, or END.
    fn advance(&mut self) -> Result<()> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        if let Some(mut current) = self.current.take() {
            let event = current.reader.next_event()?;
            if let Some(Event::End(totals)) = event {
                self.merged += totals.merged;
                return current.check_end(totals.simplices);
            }
            if let Some(Event::Patch(patch)) = event {
                let joined = current.join(&patch, &self.first_ids, &mut self.kept);
                let (patch, rows) = joined.map_err(|error| current.reader.locate(error))?;
                if patch.vertices() > 0 {
                    writer.patch_with_rows(&patch, &rows)?;
                }
            }
            self.current = Some(current);
            return Ok(());
        }
        if let Some(size) = self.parts.next() {
            let (input, name) = (self.open)(size.number)?;
            let reader = StreamReader::new(input, name)?;
            let current = Current { reader, size, live: LiveVertices::new(), own: 0 };
            current.check(writer.header(), self.plan).map_err(|e| e.of_input(current.reader.name()))?;
            self.current = Some(current);
            return Ok(());
        }
        let points = writer.totals().vertices + self.merged;
        for (found, stated, what) in
            [(self.merged, self.stated.merged, "merged points"), (points, self.stated.points, "points")]
        {
            if found != stated {
                return Err(Error::malformed(format!("{found} {what} in all parts, expected {stated}")));
            }
        }
        let Some(writer) = self.writer.take() else { return Ok(()) };
        self.bytes = writer.end(points, self.merged)?;
        Ok(())
    }
}

impl Current {
    /// Checks that the stream is the part that it should be.
    fn check(&self, joined: &Header, plan: u64) -> Result<()> {
        let header = self.reader.header();
        let is_it = header.part.is_some_and(|part| part.plan == plan && part.number == self.size.number);
        if !is_it || header.kind != joined.kind {
            let message = format!("this is not part {} of the plan", self.size.number);
            return Err(Error::malformed(message).at("header at byte 0"));
        }
        if header.coordinates != joined.coordinates
            || header.has_elevation != joined.has_elevation
            || header.attributes != joined.attributes
        {
            let message = "its grid or its attributes are not those of the other parts";
            return Err(Error::malformed(message).at("header at byte 0"));
        }
        Ok(())
    }

    fn check_end(&self, simplices: u64) -> Result<()> {
        let pairs = [
            (self.own, self.size.vertices, "vertices of its own"),
            (simplices, self.size.simplices, "simplices"),
        ];
        match pairs.into_iter().find(|(found, stated, _)| found != stated) {
            None => Ok(()),
            Some((found, stated, what)) => {
                let message =
                    format!("{found} {what}, expected {stated}: it is not the part that was collected");
                Err(self.reader.locate(Error::malformed(message)))
            }
        }
    }

    /// A patch with the ids of the joined mesh, and the rows of its new vertices. It has no vertices if there is
    /// nothing to say.
    fn join(
        &mut self,
        patch: &Patch,
        first_ids: &[u64],
        kept_before: &mut HashSet<u64>,
    ) -> Result<(Patch, Vec<u8>)> {
        let id_of = |id: GlobalId| {
            let first = first_ids.get(id.part() as usize);
            first
                .and_then(|first| first.checked_add(id.number()))
                .ok_or_else(|| Error::malformed("a vertex of no part"))
        };
        let first_own = first_ids[self.size.number as usize] + self.own;
        // For each new vertex of the part, its id; those of its own count up.
        let mut ids = Vec::with_capacity(patch.new.len());
        let (mut origins, mut own) = (patch.origins.iter().peekable(), first_own);
        for local in 0..patch.new.len() as u32 {
            if let Some(origin) = origins.next_if(|origin| origin.local == local) {
                let id = id_of(origin.id)?;
                if !kept_before.contains(&id) {
                    let (part, number) = (origin.id.part(), origin.id.number());
                    let message = format!("vertex {number} of part {part}, which no part before has kept");
                    return Err(Error::malformed(message));
                }
                ids.push(id);
            } else {
                ids.push(own);
                own += 1;
            }
        }
        self.own += own - first_own;
        let new_ids = |id: u64, _| ids[(id - patch.first_id) as usize];
        let vertices: Vec<u64> = self.live.enter(patch, new_ids)?.iter().map(|&(_, id)| id).collect();
        let is_own = |id: u64| (first_own..own).contains(&id);
        let used = used_of(patch);
        let mut imported: Vec<u64> = vertices
            .iter()
            .zip(&used)
            .filter(|&(&id, &used)| used && !is_own(id))
            .map(|(&id, _)| id)
            .collect();
        imported.sort_unstable();
        let count = own - first_own;
        let local_of = |local: u32| {
            let id = vertices[local as usize];
            let local = if is_own(id) {
                id - first_own
            } else {
                count + imported.partition_point(|&other| other < id) as u64
            };
            local as u32
        };
        let mut kept = patch.kept.iter().peekable();
        let mut finalized: Vec<u32> = patch
            .finalized
            .iter()
            .filter(|&local| {
                let id = vertices[*local as usize];
                let is_kept = kept.next_if_eq(&local).is_some();
                if is_kept {
                    kept_before.insert(id)
                } else {
                    kept_before.remove(&id)
                };
                !is_kept
            })
            .map(|&local| local_of(local))
            .collect();
        finalized.sort_unstable();
        let row_len = self.reader.rows().len().checked_div(patch.new.len()).unwrap_or(0);
        let own_places = (0..patch.new.len()).filter(|&place| is_own(ids[place]));
        let rows =
            own_places.clone().flat_map(|place| &self.reader.rows()[place * row_len..][..row_len]).copied();
        let joined = Patch {
            first_id: first_own,
            new: own_places.clone().map(|place| patch.new[place]).collect(),
            simplices: patch.simplices.iter().map(|&local| local_of(local)).collect(),
            imported,
            finalized,
            ..Patch::default()
        };
        Ok((joined, rows.collect()))
    }
}

/// For each vertex of a patch, whether a simplex uses it, or it is finalized and not kept for other parts.
fn used_of(patch: &Patch) -> Vec<bool> {
    let mut used = vec![false; patch.vertices()];
    let mut kept = patch.kept.iter().peekable();
    patch.simplices.iter().for_each(|&local| used[local as usize] = true);
    for local in &patch.finalized {
        used[*local as usize] |= kept.next_if_eq(&local).is_none();
    }
    used
}

impl Read for JoinedMesh {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.at == self.bytes.len() {
            if self.writer.is_none() {
                return Ok(0);
            }
            self.at = 0;
            self.bytes.clear();
            self.advance().map_err(io::Error::other)?;
            if let Some(writer) = &mut self.writer {
                std::mem::swap(writer.output_mut(), &mut self.bytes);
            }
        }
        let count = buffer.len().min(self.bytes.len() - self.at);
        buffer[..count].copy_from_slice(&self.bytes[self.at..][..count]);
        self.at += count;
        Ok(count)
    }
}
