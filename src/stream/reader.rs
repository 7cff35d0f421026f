//! Reads a stream block by block and verifies everything: lengths before it allocates, checksums before it
//! decodes, contents before it returns them, totals at the end.

use std::io::Read;

use super::block::{FRAME_LEN, Frame, Tag};
use super::cell_words::CellWords;
use super::compression::Decompressor;
use super::configurations::ConfigurationBlock;
use super::constraints;
use super::event::{Event, Patch, Totals};
use super::functions;
use super::head::{read_full, read_header};
use super::header::Header;
use super::part;
use super::payload;
use super::points4::{self, Points4};
use super::regions::PointRegion;
use super::tally::Tally;
use super::weights::Weights;
use crate::model::bounds::{Bounds, Point};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

/// The block that must come next.
#[derive(Debug, Clone, Copy)]
enum Wanted {
    /// Any but rows.
    Event,
    /// As many rows.
    Rows(usize),
    /// The patch of the block before, which says more about it, or another block of that patch.
    Patch,
}

/// Reads one stream.
///
/// Every error is [`ErrorKind::Malformed`], [`ErrorKind::Unsupported`] if the stream needs what this version
/// does not know, or I/O. It names input, block and byte.
/// Memory: one block, compressed and not, with its decoded event, and the incomplete words of a 4D cell that
/// spans blocks.
pub struct StreamReader<R: Read> {
    input: R,
    name: String,
    header: Header,
    weights: Option<Weights>,
    payload: Vec<u8>,
    /// The rows of the points of the last event.
    rows: Vec<u8>,
    /// The compressed form of the payload, if the block has one.
    compressed: Vec<u8>,
    decompressor: Decompressor,
    /// The byte at which the next block would start if none were compressed.
    plain_offset: u64,
    /// A buffer of points for reuse.
    spare: Vec<Point>,
    /// Bounding box of the points of the last block of points.
    points_bounds: Option<Bounds>,
    /// Number of blocks read, and the byte at which the next one starts.
    block: u64,
    offset: u64,
    /// Number and first byte of the block of the last event.
    event_place: [u64; 2],
    last_tag: Option<Tag>,
    tally: Tally,
    cell_words: CellWords,
    ended: bool,
}

impl<R: Read> StreamReader<R> {
    /// Reads the header; messages call the input `name`.
    ///
    /// # Errors
    /// If the input is not a stream of this version, or its header is damaged or needs what this version does
    /// not know.
    pub fn new(mut input: R, name: impl Into<String>) -> Result<Self> {
        let name = name.into();
        let (header, offset) =
            read_header(&mut input).map_err(|e| e.at("header at byte 0").of_input(&name))?;
        let tally = Tally::new(&header);
        Ok(StreamReader {
            input,
            name,
            weights: header.weights(),
            header,
            payload: Vec::new(),
            rows: Vec::new(),
            compressed: Vec::new(),
            decompressor: Decompressor::default(),
            plain_offset: offset,
            spare: Vec::new(),
            points_bounds: None,
            block: 0,
            offset,
            event_place: [0; 2],
            last_tag: None,
            tally,
            cell_words: CellWords::default(),
            ended: false,
        })
    }

    /// The same reader of an input that `wrap` makes of this one, such as a boxed one.
    pub fn map_input<S: Read>(self, wrap: impl FnOnce(R) -> S) -> StreamReader<S> {
        StreamReader {
            input: wrap(self.input),
            name: self.name,
            header: self.header,
            weights: self.weights,
            payload: self.payload,
            rows: self.rows,
            compressed: self.compressed,
            decompressor: self.decompressor,
            plain_offset: self.plain_offset,
            spare: self.spare,
            points_bounds: self.points_bounds,
            block: self.block,
            offset: self.offset,
            event_place: self.event_place,
            last_tag: self.last_tag,
            tally: self.tally,
            cell_words: self.cell_words,
            ended: self.ended,
        }
    }

    /// The header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The name of the input in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Totals of the blocks read so far.
    pub fn totals(&self) -> Totals {
        *self.tally.totals()
    }

    /// Bytes read so far.
    pub fn bytes_read(&self) -> u64 {
        self.offset
    }

    /// Bytes that the stream so far would have if no block were compressed. Blocks that are skipped count as
    /// they are.
    pub fn plain_bytes_read(&self) -> u64 {
        self.plain_offset
    }

    /// Bounding box of the points of the last [`Event::Points`]; `None` if it held no points.
    pub fn points_bounds(&self) -> Option<Bounds> {
        self.points_bounds
    }

    /// Takes back the buffer of an [`Event::Points`] for reuse.
    pub fn give_back(&mut self, points: Vec<Point>) {
        self.spare = points;
    }

    /// Where the block of the last event is: its number and its first byte.
    pub fn place(&self) -> String {
        let [block, byte] = self.event_place;
        format!("block {block} at byte {byte}")
    }

    /// Adds input and position to an error about the last event. Errors about anything else,
    /// like a full disk on the output side, stay as they are.
    pub fn locate(&self, error: Error) -> Error {
        if !matches!(error.kind(), ErrorKind::Malformed | ErrorKind::Audit) {
            return error;
        }
        error.at(self.place()).of_input(&self.name)
    }

    /// The next block that this version knows; `None` after END. END is returned only if the input ends
    /// there.
    ///
    /// # Errors
    /// If the input ends before END, goes on after it, a block is damaged or breaks a rule, or this version
    /// does not know it and must not skip it.
    pub fn next_event(&mut self) -> Result<Option<Event>> {
        if self.ended {
            return Ok(None);
        }
        self.rows.clear();
        let mut tag = self.next_block(Wanted::Event)?;
        let mut more = Patch::default();
        while tag.is_of_patch() {
            self.decode_more(tag, &mut more).map_err(|error| self.locate(error))?;
            tag = self.next_block(Wanted::Patch)?;
        }
        let event = self.decode(tag, more).map_err(|error| self.locate(error))?;
        let rows = if self.header.attributes.is_empty() { 0 } else { rows_behind(&event) };
        if rows > 0 {
            let place = self.event_place;
            self.next_block(Wanted::Rows(rows))?;
            std::mem::swap(&mut self.rows, &mut self.payload);
            self.event_place = place;
        }
        Ok(Some(event))
    }

    /// The attributes of the points of the last event, row by row: of all points of [`Event::Points`], of the
    /// new vertices of [`Event::Patch`], and of all points of [`Event::ResidualPoints`]. Empty if the stream
    /// has no attributes.
    pub fn rows(&self) -> &[u8] {
        &self.rows
    }

    /// Reads the next block that this version knows, which must be a wanted one.
    fn next_block(&mut self, wanted: Wanted) -> Result<Tag> {
        loop {
            let (tag, is_compressed) = match self.read_block(wanted) {
                Ok(read) => read,
                Err(error) => {
                    let position = format!("block {} at byte {}", self.block, self.offset);
                    return Err(error.at(position).of_input(&self.name));
                }
            };
            self.event_place = [self.block, self.offset];
            self.block += 1;
            self.offset += (FRAME_LEN + self.payload.len()) as u64;
            self.plain_offset += (FRAME_LEN + self.payload.len()) as u64;
            let Some(tag) = tag else { continue };
            if is_compressed {
                self.decompress(tag).map_err(|error| self.locate(error))?;
            }
            if let Wanted::Rows(rows) = wanted {
                self.check_rows(rows).map_err(|error| self.locate(error))?;
            }
            return Ok(tag);
        }
    }

    /// Checks that the payload is as many rows, with weights as the header says.
    fn check_rows(&self, rows: usize) -> Result<()> {
        let (len, row_len) = (self.payload.len(), self.header.attributes.row_len());
        if len == rows * row_len {
            return self.weights.map_or(Ok(()), |weights| weights.check(&self.payload));
        }
        Err(Error::malformed(format!("{len} bytes of attributes, expected {rows} rows of {row_len} bytes")))
    }

    /// Checks that a block of this tag may stand here: rows where they are wanted, and nowhere else.
    fn check_order(&mut self, tag: Tag, wanted: Wanted) -> Result<()> {
        let name = tag.bytes();
        let name = name.escape_ascii();
        match (tag, wanted) {
            (Tag::Rows, Wanted::Rows(_)) => return Ok(()),
            (Tag::Rows, _) if self.header.attributes.is_empty() => {
                return Err(Error::malformed(format!("block \"{name}\" in a stream without attributes")));
            }
            (Tag::Rows, _) => {
                return Err(Error::malformed(format!(
                    "no block \"{name}\" may stand here: no points precede"
                )));
            }
            (_, Wanted::Rows(_)) => {
                return Err(Error::malformed(format!(
                    "block \"{name}\", expected the attributes of the points before it"
                )));
            }
            (Tag::Patch, Wanted::Patch) | (_, Wanted::Event) => {}
            (Tag::Kept, Wanted::Patch) if self.last_tag == Some(Tag::Origins) => {}
            (_, Wanted::Patch) => {
                let before = self.last_tag.map_or("sides", Tag::of_patch);
                return Err(Error::malformed(format!(
                    "block \"{name}\", expected the patch of the {before}"
                )));
            }
        }
        if !self.header.kind.allows(self.last_tag, tag) {
            return Err(Error::malformed(format!(
                "no block \"{name}\" may stand here in a stream of kind {}",
                self.header.kind.name()
            )));
        }
        if tag.is_of_constraints() && self.header.constrained.is_none() {
            return Err(Error::malformed(format!("block \"{name}\" in a stream that is not constrained")));
        }
        if tag.is_of_parts() && self.header.part.is_none() {
            return Err(Error::malformed(format!("block \"{name}\" in a stream that is no part of a mesh")));
        }
        self.last_tag = Some(tag);
        Ok(())
    }

    /// Reads frame and payload of a block, and verifies everything that does not depend on its content.
    /// Returns its tag, `None` for a block that this version skips, and whether it is compressed.
    fn read_block(&mut self, wanted: Wanted) -> Result<(Option<Tag>, bool)> {
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
        if frame.is_compressed && !self.header.compressed {
            return Err(Error::malformed(
                "a compressed block in a stream without feature bit 0: damaged, or not a spmesh stream",
            ));
        }
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
        let Some(tag) = Tag::from_bytes(frame.tag)? else { return Ok((None, frame.is_compressed)) };
        self.check_order(tag, wanted)?;
        Ok((Some(tag), frame.is_compressed))
    }

    /// Replaces the compressed payload of a block by the payload.
    fn decompress(&mut self, tag: Tag) -> Result<()> {
        if tag == Tag::End {
            return Err(Error::malformed("END is compressed: it must not be"));
        }
        std::mem::swap(&mut self.payload, &mut self.compressed);
        self.decompressor.decompress(&self.compressed, &mut self.payload)?;
        self.plain_offset = self.plain_offset - self.compressed.len() as u64 + self.payload.len() as u64;
        Ok(())
    }

    /// Decodes a block that says more about the patch behind it.
    fn decode_more(&self, tag: Tag, more: &mut Patch) -> Result<()> {
        match tag {
            Tag::Sides => more.sides = constraints::decode_sides(&self.payload)?,
            Tag::Origins => more.origins = part::decode_origins(&self.payload)?,
            _ => more.kept = part::decode_kept(&self.payload)?,
        }
        Ok(())
    }

    /// The event of the block that was read. A patch gets what the blocks before it say about it.
    fn decode(&mut self, tag: Tag, more: Patch) -> Result<Event> {
        let (header, payload, totals) = (&self.header, &self.payload[..], self.tally.totals());
        let event = match tag {
            Tag::Points => {
                let mut points = std::mem::take(&mut self.spare);
                self.points_bounds = payload::points(header, payload, &mut points)?;
                self.tally.count_points(points.len(), self.points_bounds)?;
                return Ok(Event::Points(points));
            }
            Tag::Cells => Event::Cells(payload::cells(header, payload)?),
            Tag::Region => Event::Region(PointRegion::decode(payload)?),
            Tag::Patch => {
                let Patch { sides, origins, kept, .. } = more;
                let patch = payload::patch(header, totals.vertices, payload)?;
                let patch = Patch { sides, origins, kept, ..patch };
                Event::Patch(patch)
            }
            Tag::Labels => Event::Labels(payload::labels(payload)?),
            Tag::ResidualPoints => {
                Event::ResidualPoints(payload::residual_points(header, totals.vertices, payload)?)
            }
            Tag::Walls => {
                let corners = header.kind.vertices_per_wall();
                Event::Walls(payload::walls(corners, totals.residual_points, payload)?)
            }
            Tag::Points4 => Event::Points4(Points4::decode(header, payload)?),
            Tag::Cells4 => Event::Cells4(self.cell_words.take(totals.vertices, payload)?),
            Tag::Simplices4 => Event::Simplices4(points4::simplices(payload)?),
            Tag::Configurations => Event::Configurations(ConfigurationBlock::decode(payload)?),
            Tag::Functions => Event::Functions(functions::decode(payload)?),
            Tag::Coefficients => Event::Coefficients(functions::decode_coefficients(payload)?),
            Tag::End => Event::End(payload::totals(payload)?),
            Tag::Segments => Event::Segments(constraints::decode_segments(header, payload)?),
            Tag::OpenSegments => Event::OpenSegments(constraints::decode_open_segments(payload)?),
            Tag::Rows | Tag::Sides | Tag::Origins | Tag::Kept => {
                unreachable!("read with their points, or with their patch")
            }
        };
        self.tally.count(&event)?;
        if let Event::End(stated) = &event {
            self.cell_words.check_end()?;
            self.tally.check_end(&self.header, stated)?;
            self.expect_end_of_input()?;
            self.ended = true;
        }
        Ok(event)
    }

    /// Checks that the input ends after END.
    fn expect_end_of_input(&mut self) -> Result<()> {
        match read_full(&mut self.input, &mut [0])? {
            0 => Ok(()),
            _ => Err(Error::malformed("the input goes on after END").at(format!("byte {}", self.offset))),
        }
    }
}

/// Number of rows that follow an event in a stream with attributes.
fn rows_behind(event: &Event) -> usize {
    match event {
        Event::Points(points) => points.len(),
        Event::Patch(patch) => patch.new.len(),
        Event::ResidualPoints(points) => points.len(),
        _ => 0,
    }
}
