//! A mesh in parts as one plain stream.

use std::io::{self, Read};

use foldhash::{HashMap, HashMapExt};

use super::event::{Event, Patch, Totals};
use super::header::Header;
use super::live::LiveVertices;
use super::part::{GlobalId, PartName};
use super::reader::StreamReader;
use super::writer::StreamWriter;
use spmesh_base::error::{Error, Result};

/// The bytes of a part, with the name that messages use.
pub type OpenedPart = (Box<dyn Read + Send>, String);

/// Opens the part at a place in the list of parts.
type Open = Box<dyn FnMut(usize) -> Result<OpenedPart> + Send>;

/// Vertices of a patch that only finalizes. Each takes 12 bytes.
const PATCH_VERTICES: usize = 16_384;

/// One part of a mesh: what is known of it before it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartSize {
    /// Its name.
    pub name: PartName,
    /// Whether the joined mesh has its simplices.
    pub is_wanted: bool,
    /// Its vertices that no part before it has.
    pub vertices: u64,
    /// Its triangles or tetrahedra.
    pub simplices: u64,
}

/// Reads the parts of a mesh, one after the other, as the bytes of one stream without parts.
///
/// A vertex of several parts is written once, with the first of them that is wanted, and finalized with the
/// last. Parts that are not wanted are not opened: their simplices are left out.
///
/// Memory: 16 bytes for each part, one patch, the live vertices of one part, and 16 bytes for each vertex
/// that a later part may use: the residuals of nodes whose parent is still to come. An error of a part is the
/// inner error of the [`io::Error`].
pub struct JoinedMesh {
    open: Open,
    parts: Vec<PartSize>,
    /// The part that comes next.
    next: usize,
    shared: Shared,
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

/// What is known of vertices of several parts.
struct Shared {
    /// For each part, the number of vertices of all parts before it.
    firsts: Vec<u64>,
    /// For each part, the place of the first part below it, or its own.
    lowest: Vec<usize>,
    /// Whether all parts are wanted.
    is_whole: bool,
    /// Vertices that parts have kept for later ones: number among the vertices of all parts, and id in the
    /// joined mesh.
    kept: HashMap<u64, u64>,
    /// Ids of those that are left when all wanted parts were read.
    left: Vec<u64>,
    /// Vertices of the joined mesh so far.
    vertices: u64,
}

/// The part that is being read.
struct Current {
    reader: StreamReader<Box<dyn Read + Send>>,
    size: PartSize,
    /// Its place among all parts.
    place: usize,
    /// Its live vertices.
    live: LiveVertices<Vertex>,
    /// Vertices of its own so far.
    own: u64,
}

/// A vertex: its number among the vertices of all parts, and its id in the joined mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Vertex {
    number: u64,
    id: u64,
}

impl JoinedMesh {
    /// Joins `parts`, each directly behind all parts below it. All of them have the `stated` points, so many
    /// of which are merged with others. `header` is that of the joined mesh; what it shares with those of the
    /// parts is checked.
    ///
    /// # Errors
    /// Malformed, if a part comes before one below it; usage, if the header cannot be written.
    pub fn new(header: Header, parts: Vec<PartSize>, stated: Totals, open: Open) -> Result<JoinedMesh> {
        let (mut firsts, mut lowest) = (Vec::with_capacity(parts.len()), Vec::with_capacity(parts.len()));
        let mut vertices = 0u64;
        for (place, part) in parts.iter().enumerate() {
            let below = part.name.below;
            if below as usize > place {
                return Err(Error::malformed(format!(
                    "part {place} comes before one of the {below} below it"
                )));
            }
            firsts.push(vertices);
            lowest.push(place - below as usize);
            let sum = vertices.checked_add(part.vertices).filter(|sum| *sum < u64::MAX);
            vertices = sum.ok_or_else(|| Error::malformed("vertices beyond counting"))?;
        }
        let is_whole = parts.iter().all(|part| part.is_wanted);
        let writer = StreamWriter::new(Vec::new(), header)?;
        Ok(JoinedMesh {
            open,
            parts,
            next: 0,
            shared: Shared { firsts, lowest, is_whole, kept: HashMap::new(), left: Vec::new(), vertices: 0 },
            current: None,
            writer: Some(writer),
            bytes: Vec::new(),
            at: 0,
            merged: 0,
            stated,
        })
    }

    /// Counts of the mesh of all parts, if some of them are left out.
    pub fn whole(&self) -> Option<Totals> {
        let simplices = self.parts.iter().fold(0, |sum: u64, part| sum.saturating_add(part.simplices));
        // The constructor has checked this sum.
        let vertices = self.parts.iter().map(|part| part.vertices).sum();
        (!self.shared.is_whole).then_some(Totals { vertices, simplices, ..self.stated })
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
                let joined = current.join(&patch, &mut self.shared);
                let (patch, rows) = joined.map_err(|error| current.reader.locate(error))?;
                if patch.vertices() > 0 {
                    writer.patch_with_rows(&patch, &rows)?;
                }
            }
            self.current = Some(current);
            return Ok(());
        }
        let wanted = (self.next..self.parts.len()).find(|&place| self.parts[place].is_wanted);
        self.next = wanted.map_or(self.parts.len(), |place| place + 1);
        if let Some(place) = wanted {
            let (input, name) = (self.open)(place)?;
            let reader = StreamReader::new(input, name)?;
            let current =
                Current { reader, size: self.parts[place], place, live: LiveVertices::new(), own: 0 };
            current.check(writer.header()).map_err(|e| e.of_input(current.reader.name()))?;
            self.current = Some(current);
            return Ok(());
        }
        if let Some(patch) = self.shared.next_left() {
            return writer.patch(&patch);
        }
        let points = writer.totals().vertices + self.merged;
        if !self.shared.is_whole {
            self.stated = Totals { points, merged: self.merged, ..Totals::default() };
        }
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

impl Shared {
    /// A patch that finalizes vertices which were kept for parts that are not wanted, if any are left.
    fn next_left(&mut self) -> Option<Patch> {
        if self.is_whole {
            return None;
        }
        if !self.kept.is_empty() {
            self.left = self.kept.drain().map(|(_, id)| id).collect();
            self.left.sort_unstable();
        }
        let imported = self.left.split_off(self.left.len().saturating_sub(PATCH_VERTICES));
        let finalized = (0..imported.len() as u32).collect();
        let patch = Patch { first_id: self.vertices, imported, finalized, ..Patch::default() };
        (patch.vertices() > 0).then_some(patch)
    }

    /// The number of the vertex that part `place` calls `id`, and its id in the joined mesh if a part before
    /// has kept it.
    fn vertex(&self, id: GlobalId, place: usize) -> Result<(u64, Option<u64>)> {
        let part = self.lowest[place] + id.part() as usize;
        let number = self.firsts.get(part).and_then(|first| first.checked_add(id.number()));
        let number = number.ok_or_else(|| Error::malformed("a vertex of no part"))?;
        match self.kept.get(&number) {
            None if self.is_whole => {
                Err(Error::malformed("a vertex of another part, which no part before has kept"))
            }
            known => Ok((number, known.copied())),
        }
    }
}

impl Current {
    /// Checks that the stream is the part that it should be.
    fn check(&self, joined: &Header) -> Result<()> {
        let header = self.reader.header();
        self.size.name.expect(header)?;
        if header.kind != joined.kind {
            return Err(Error::malformed("its kind is not that of the other parts").at("header at byte 0"));
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

    /// A patch with the ids of the joined mesh, and the rows of its new vertices. It has no vertices if there
    /// is nothing to say.
    fn join(&mut self, patch: &Patch, shared: &mut Shared) -> Result<(Patch, Vec<u8>)> {
        let first = shared.vertices;
        let entering = self.entering(patch, shared)?;
        let is_new = |id: u64| id >= first;
        let entered = |id: u64, _| entering[(id - patch.first_id) as usize];
        let vertices: Vec<Vertex> = self.live.enter(patch, entered)?.iter().map(|&(_, it)| it).collect();
        let used = used_of(patch);
        let mut imported: Vec<u64> = vertices
            .iter()
            .zip(&used)
            .filter(|&(it, &used)| used && !is_new(it.id))
            .map(|(it, _)| it.id)
            .collect();
        imported.sort_unstable();
        let count = shared.vertices - first;
        let local_of = |local: u32| {
            let Vertex { id, .. } = vertices[local as usize];
            let local = if is_new(id) {
                id - first
            } else {
                count + imported.partition_point(|&other| other < id) as u64
            };
            local as u32
        };
        let mut kept = patch.kept.iter().peekable();
        let mut finalized: Vec<u32> = Vec::with_capacity(patch.finalized.len());
        for local in &patch.finalized {
            let Vertex { number, id } = vertices[*local as usize];
            if kept.next_if_eq(&local).is_some() {
                shared.kept.insert(number, id);
            } else {
                shared.kept.remove(&number);
                finalized.push(local_of(*local));
            }
        }
        finalized.sort_unstable();
        let row_len = self.reader.rows().len().checked_div(patch.new.len()).unwrap_or(0);
        let places = (0..patch.new.len()).filter(|&place| is_new(entering[place].id));
        let rows =
            places.clone().flat_map(|place| &self.reader.rows()[place * row_len..][..row_len]).copied();
        let joined = Patch {
            first_id: first,
            new: places.clone().map(|place| patch.new[place]).collect(),
            simplices: patch.simplices.iter().map(|&local| local_of(local)).collect(),
            imported,
            finalized,
            ..Patch::default()
        };
        Ok((joined, rows.collect()))
    }

    /// The new vertices of a patch. Those that no part before has written are vertices of the joined mesh
    /// from now on.
    fn entering(&mut self, patch: &Patch, shared: &mut Shared) -> Result<Vec<Vertex>> {
        let mut vertices = Vec::with_capacity(patch.new.len());
        let mut origins = patch.origins.iter().peekable();
        for local in 0..patch.new.len() as u32 {
            let (number, known) = match origins.next_if(|origin| origin.local == local) {
                Some(origin) => shared.vertex(origin.id, self.place)?,
                None => {
                    self.own += 1;
                    (shared.firsts[self.place] + self.own - 1, None)
                }
            };
            let id = known.unwrap_or(shared.vertices);
            shared.vertices += u64::from(known.is_none());
            vertices.push(Vertex { number, id });
        }
        Ok(vertices)
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
