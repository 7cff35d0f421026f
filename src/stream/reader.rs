//! Reads a stream block by block and believes nothing: length before allocation, checksum before content,
//! content before use, totals at the end.

use std::io::Read;

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::{FRAME_LEN, Frame, Tag};
use super::event::{Event, Patch, Totals};
use super::header::{Coordinates, Header, MAGIC, PREAMBLE_LEN, VERSION};
use super::kind::Kind;
use crate::bounds::Point;
use crate::cells::CellCode;
use crate::error::{Error, Result};
use crate::limits::{BLOCK_PAYLOAD_MAX, HEADER_BODY_MAX};

/// Reads one stream.
///
/// Every error is [`crate::error::ErrorKind::Malformed`] (or I/O) and names input, block and byte.
/// Memory: one block, and its decoded event.
pub struct StreamReader<R: Read> {
    input: R,
    name: String,
    header: Header,
    payload: Vec<u8>,
    /// Number of blocks read, and the byte at which the next one starts.
    block: u64,
    offset: u64,
    totals: Totals,
    finalized: u64,
    ended: bool,
}

impl<R: Read> StreamReader<R> {
    /// Reads the header; `name` is what messages call the input.
    ///
    /// # Errors
    /// If the input is not a stream of this version, or its header is damaged.
    pub fn new(mut input: R, name: impl Into<String>) -> Result<Self> {
        let name = name.into();
        let (header, offset) =
            read_header(&mut input).map_err(|e| e.at("header at byte 0").of_input(&name))?;
        let payload = Vec::new();
        let totals = Totals::default();
        Ok(StreamReader {
            input,
            name,
            header,
            payload,
            block: 0,
            offset,
            totals,
            finalized: 0,
            ended: false,
        })
    }

    /// The header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// What messages call the input.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What was read so far.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// Bytes read so far.
    pub fn bytes_read(&self) -> u64 {
        self.offset
    }

    /// Adds input and position to an error about the block that was read last.
    pub fn locate(&self, error: Error) -> Error {
        let block = self.block.saturating_sub(1);
        let start = self.offset - (self.payload.len() + FRAME_LEN) as u64;
        error.at(format!("block {block} at byte {start}")).of_input(&self.name)
    }

    /// The next block; `None` after END, when the input ends there too.
    ///
    /// # Errors
    /// If the input ends before END, goes on after it, or a block is damaged or breaks a rule.
    pub fn next_event(&mut self) -> Result<Option<Event>> {
        if self.ended {
            return self.expect_end_of_input().map(|()| None);
        }
        let tag = match self.read_block() {
            Ok(tag) => tag,
            Err(error) => {
                let position = format!("block {} at byte {}", self.block, self.offset);
                return Err(error.at(position).of_input(&self.name));
            }
        };
        self.block += 1;
        self.offset += (FRAME_LEN + self.payload.len()) as u64;
        self.decode(tag).map(Some).map_err(|error| self.locate(error))
    }

    /// Reads frame and payload of a block and verifies all that does not depend on its content.
    fn read_block(&mut self) -> Result<Tag> {
        self.payload.clear();
        let mut bytes = [0; FRAME_LEN];
        let found = read_full(&mut self.input, &mut bytes)?;
        if found < FRAME_LEN {
            return Err(Error::malformed(format!(
                "truncated: the input ends after {found} bytes of a block's frame, without END"
            )));
        }
        let frame = Frame::decode(&bytes);
        let len = frame.len as usize;
        if len > BLOCK_PAYLOAD_MAX {
            return Err(Error::malformed(format!(
                "block of {len} bytes, the maximum is {BLOCK_PAYLOAD_MAX}: damaged, or not a spmesh stream"
            )));
        }
        self.payload.resize(len, 0);
        let found = read_full(&mut self.input, &mut self.payload)?;
        if found < len {
            return Err(Error::malformed(format!("truncated: found {found} of {len} bytes of the block")));
        }
        if !frame.verifies(&self.payload) {
            return Err(Error::malformed("checksum does not match: the block is damaged"));
        }
        if frame.sequence != self.block as u32 {
            return Err(Error::malformed(format!(
                "block has sequence number {}, expected {}: a block is missing or repeated",
                frame.sequence, self.block as u32
            )));
        }
        match frame.tag {
            Some(tag) if self.header.kind.allows(tag) => Ok(tag),
            Some(tag) => Err(Error::malformed(format!(
                "block {:?} in a stream of kind {}",
                String::from_utf8_lossy(&tag.bytes()),
                self.header.kind.name()
            ))),
            None => Err(Error::malformed("unknown block tag")),
        }
    }

    fn decode(&mut self, tag: Tag) -> Result<Event> {
        let event = match tag {
            Tag::Points => Event::Points(self.decode_points(&self.payload)?),
            Tag::Cells => Event::Cells(self.decode_cells()?),
            Tag::Patch => Event::Patch(self.decode_patch()?),
            Tag::ResidualPoints => Event::ResidualPoints(self.decode_residual_points()?),
            Tag::Walls => Event::Walls(self.decode_walls()?),
            Tag::End => Event::End(self.decode_end()?),
        };
        match &event {
            Event::Points(points) => self.totals.points += points.len() as u64,
            Event::Cells(cells) => self.totals.cells += cells.len() as u64,
            Event::Patch(patch) => {
                self.totals.vertices += patch.new.len() as u64;
                let per_simplex = self.header.kind.vertices_per_simplex();
                self.totals.simplices += (patch.simplices.len() / per_simplex) as u64;
                self.finalized += patch.finalized.len() as u64;
            }
            Event::ResidualPoints(points) => self.totals.residual_points += points.len() as u64,
            Event::Walls(walls) => self.totals.walls += walls.len() as u64,
            Event::End(_) => self.ended = true,
        }
        Ok(event)
    }

    fn decode_points(&self, bytes: &[u8]) -> Result<Vec<Point>> {
        whole_records(bytes, self.header.point_len())?
            .map(|record| decode_point(&self.header, record))
            .collect()
    }

    fn decode_cells(&self) -> Result<Vec<CellCode>> {
        let Some(tree) = &self.header.tree else {
            return Err(Error::malformed("cell tag in a stream without a finalization tree"));
        };
        whole_records(&self.payload, 8)?
            .map(|record| {
                let cell = CellCode(LE::read_u64(record));
                if tree.is_valid(cell) {
                    Ok(cell)
                } else {
                    Err(Error::malformed(format!("location code {} is not a cell of the tree", cell.0)))
                }
            })
            .collect()
    }

    fn decode_patch(&self) -> Result<Patch> {
        let bytes = &self.payload[..];
        if bytes.len() < 24 {
            return Err(Error::malformed(format!("patch of {} bytes, expected at least 24", bytes.len())));
        }
        let (counts, rest) = bytes[8..].split_at(16);
        let mut counts = counts.chunks_exact(4).map(|count| LE::read_u32(count) as usize);
        let mut count = || counts.next().expect("four counts");
        let (new, imported, simplices, finalized) = (count(), count(), count(), count());
        let per_simplex = self.header.kind.vertices_per_simplex();
        let lens = [new * self.header.point_len(), imported * 8, simplices * per_simplex * 4, finalized * 4];
        if lens.iter().sum::<usize>() != rest.len() {
            return Err(Error::malformed("the counts of the patch do not add up to its length"));
        }
        let (new, rest) = rest.split_at(lens[0]);
        let (imported, rest) = rest.split_at(lens[1]);
        let (simplices, finalized) = rest.split_at(lens[2]);
        let locals = |bytes: &[u8]| bytes.chunks_exact(4).map(LE::read_u32).collect();
        let patch = Patch {
            first_id: LE::read_u64(bytes),
            new: self.decode_points(new)?,
            imported: imported.chunks_exact(8).map(LE::read_u64).collect(),
            simplices: locals(simplices),
            finalized: locals(finalized),
        };
        check_patch(&patch, self.totals.vertices, per_simplex)?;
        Ok(patch)
    }

    fn decode_residual_points(&self) -> Result<Vec<(Option<u64>, Point)>> {
        whole_records(&self.payload, 8 + self.header.point_len())?
            .map(|record| {
                let id = LE::read_u64(record);
                if id != u64::MAX && id >= self.totals.vertices {
                    return Err(Error::malformed(format!("residual point has the id {id} of no vertex")));
                }
                let point = decode_point(&self.header, &record[8..])?;
                Ok(((id != u64::MAX).then_some(id), point))
            })
            .collect()
    }

    fn decode_walls(&self) -> Result<Vec<[u32; 2]>> {
        whole_records(&self.payload, 8)?
            .map(|record| {
                let wall = [LE::read_u32(record), LE::read_u32(&record[4..])];
                let known = wall.iter().all(|&end| u64::from(end) < self.totals.residual_points);
                if known && wall[0] != wall[1] {
                    Ok(wall)
                } else {
                    Err(Error::malformed(format!(
                        "wall {} to {} between no residual points",
                        wall[0], wall[1]
                    )))
                }
            })
            .collect()
    }

    fn decode_end(&self) -> Result<Totals> {
        let fields: Vec<u64> = whole_records(&self.payload, 8)?.map(LE::read_u64).collect();
        let Ok(fields) = <[u64; 7]>::try_from(fields) else {
            return Err(Error::malformed(format!("END of {} bytes, expected 56", self.payload.len())));
        };
        let stated = Totals::from_fields(fields);
        let mut counted = self.totals;
        if self.header.kind.vertices_per_simplex() > 0 {
            (counted.points, counted.merged) = (stated.points, stated.merged);
        }
        if stated != counted {
            return Err(Error::malformed(format!("END states {stated:?}, but the stream holds {counted:?}")));
        }
        let vertices = stated.vertices.checked_add(stated.merged);
        if self.header.kind == Kind::TriangleMesh && vertices != Some(stated.points) {
            return Err(Error::malformed("END: vertices and merged points are not all points"));
        }
        if self.header.kind == Kind::TriangleMesh && self.finalized != stated.vertices {
            return Err(Error::malformed(format!(
                "END: {} of {} vertices were finalized",
                self.finalized, stated.vertices
            )));
        }
        if self.header.kind == Kind::Points && self.header.points.is_some_and(|n| n != stated.points) {
            return Err(Error::malformed("END: the header states another number of points"));
        }
        Ok(stated)
    }

    fn expect_end_of_input(&mut self) -> Result<()> {
        match read_full(&mut self.input, &mut [0])? {
            0 => Ok(()),
            _ => Err(Error::malformed("the input goes on after END")
                .at(format!("byte {}", self.offset))
                .of_input(&self.name)),
        }
    }
}

fn read_header(input: &mut impl Read) -> Result<(Header, u64)> {
    let mut bytes = vec![0; PREAMBLE_LEN];
    let found = read_full(input, &mut bytes)?;
    if found == 0 {
        return Err(Error::malformed("the input is empty, expected a spmesh stream"));
    }
    if found < PREAMBLE_LEN || bytes[..8] != MAGIC {
        return Err(Error::malformed("not a spmesh stream, or cut off within the first bytes"));
    }
    let (version, kind) = (LE::read_u16(&bytes[8..]), LE::read_u16(&bytes[10..]));
    if version != VERSION {
        return Err(Error::malformed(format!("stream of version {version}, this program reads {VERSION}")));
    }
    let body_len = LE::read_u32(&bytes[12..]) as usize;
    if body_len > HEADER_BODY_MAX {
        return Err(Error::malformed(format!(
            "header body of {body_len} bytes, the maximum is {HEADER_BODY_MAX}"
        )));
    }
    let end = PREAMBLE_LEN + body_len;
    bytes.resize(end + 4, 0);
    let found = read_full(input, &mut bytes[PREAMBLE_LEN..])?;
    if found < body_len + 4 {
        return Err(Error::malformed(format!("truncated: found {found} of {} bytes", body_len + 4)));
    }
    if crc32c::crc32c(&bytes[..end]) != LE::read_u32(&bytes[end..]) {
        return Err(Error::malformed("checksum does not match: the header is damaged"));
    }
    let kind =
        Kind::from_code(kind).ok_or_else(|| Error::malformed(format!("unknown stream kind {kind}")))?;
    Ok((Header::decode(kind, &bytes[PREAMBLE_LEN..end])?, (end + 4) as u64))
}

/// Reads until `buffer` is full or the input ends; the number of bytes read.
fn read_full(input: &mut impl Read, buffer: &mut [u8]) -> Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match input.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(Error::io("reading", e)),
        }
    }
    Ok(filled)
}

fn whole_records(bytes: &[u8], len: usize) -> Result<std::slice::ChunksExact<'_, u8>> {
    if bytes.len().is_multiple_of(len) {
        Ok(bytes.chunks_exact(len))
    } else {
        Err(Error::malformed(format!("{} bytes are not a whole number of records of {len}", bytes.len())))
    }
}

fn decode_point(header: &Header, record: &[u8]) -> Result<Point> {
    let mut point = [0.0; 3];
    let width = header.coordinates.width();
    for (value, bytes) in point.iter_mut().zip(record.chunks_exact(width)) {
        *value = match header.coordinates {
            Coordinates::F64 => LE::read_f64(bytes),
            Coordinates::I32 { .. } => f64::from(LE::read_i32(bytes)),
        };
        if !value.is_finite() {
            return Err(Error::malformed(format!("coordinate {value}")));
        }
    }
    match &header.bounds {
        Some(bounds) if !bounds.contains(point) => {
            Err(Error::malformed(format!("point {point:?} lies outside of the header's bounding box")))
        }
        _ => Ok(point),
    }
}

/// The rules of a patch that need no memory of earlier patches.
fn check_patch(patch: &Patch, vertices_before: u64, per_simplex: usize) -> Result<()> {
    if patch.first_id != vertices_before {
        return Err(Error::malformed(format!(
            "patch starts with vertex {}, expected {vertices_before}",
            patch.first_id
        )));
    }
    let increasing = |ids: &[u64]| ids.windows(2).all(|pair| pair[0] < pair[1]);
    if !increasing(&patch.imported) || patch.imported.last().is_some_and(|&id| id >= patch.first_id) {
        return Err(Error::malformed("imported vertices are not increasing ids of earlier patches"));
    }
    let vertices = patch.vertices();
    if !patch.finalized.windows(2).all(|pair| pair[0] < pair[1])
        || patch.finalized.last().is_some_and(|&local| local as usize >= vertices)
    {
        return Err(Error::malformed("finalized vertices are not increasing indices of the patch"));
    }
    for simplex in patch.simplices.chunks_exact(per_simplex) {
        if let Some(&local) = simplex.iter().find(|&&local| local as usize >= vertices) {
            return Err(Error::malformed(format!("simplex uses vertex {local} of {vertices} in its patch")));
        }
        if (1..per_simplex).any(|i| simplex[..i].contains(&simplex[i])) {
            return Err(Error::malformed(format!("simplex {simplex:?} uses a vertex twice")));
        }
    }
    Ok(())
}
