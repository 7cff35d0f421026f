//! Writes a stream block by block. Only [`StreamWriter::end`] completes it.

mod configurations;
mod constraints;
mod encode;
mod four;
mod functions;
mod parts;
mod regions;
mod residual;
mod rows;

use std::io::Write;

use super::block::{Frame, Tag};
use super::compression::Compressor;
use super::configuration_rules::ConfigurationRules;
use super::constraints::ConstraintRules;
use super::event::{Patch, Totals};
use super::functions::{FunctionRules, check_end};
use super::header::Header;
use super::kind::Kind;
use super::patch_blocks::PatchBlocks;
use super::regions::RegionRules;
use super::rules4::Rules4;
use crate::model::bounds::Point;
use crate::model::cells::CellCode;
use encode::encode_point;
pub use encode::encode_points;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

/// Payload at which a block of points is closed, in bytes: far below the maximum, so that a consumer can
/// start early, and large enough that the frame is negligible.
const POINTS_PAYLOAD: usize = 1 << 16;

/// Writes one stream.
///
/// Invariant: every reader rejects a stream without END as incomplete. `end` writes END and `Drop` never
/// does, so the output of a producer that fails half way cannot be mistaken for a short stream.
pub struct StreamWriter<W: Write> {
    output: W,
    header: Header,
    sequence: u32,
    last_tag: Option<Tag>,
    /// Encoded points, or other records, until their block is full; and the tag of that block.
    points: Vec<u8>,
    /// The rows of these points.
    rows: Vec<u8>,
    points_tag: Tag,
    payload: Vec<u8>,
    /// If the header says that blocks may be compressed.
    compressor: Option<Compressor>,
    totals: Totals,
    labels: u64,
    rules4: Rules4,
    configuration_rules: ConfigurationRules,
    function_rules: FunctionRules,
    constraint_rules: ConstraintRules,
    /// In a stream of regions.
    region_rules: Option<RegionRules>,
    waiting: Option<configurations::Waiting>,
}

impl<W: Write> StreamWriter<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// If the header breaks a rule of the format, or writing fails.
    pub fn new(mut output: W, header: Header) -> Result<Self> {
        output.write_all(&header.encode()?).map_err(write_error)?;
        let rules4 = Rules4::new(header.kind);
        let configuration_rules = ConfigurationRules::new(header.kind);
        let region_rules = RegionRules::of(&header);
        Ok(StreamWriter {
            output,
            compressor: header.compressed.then(Compressor::default),
            header,
            sequence: 0,
            last_tag: None,
            points: Vec::with_capacity(POINTS_PAYLOAD),
            rows: Vec::new(),
            points_tag: Tag::Points,
            payload: Vec::new(),
            totals: Totals::default(),
            labels: 0,
            rules4,
            configuration_rules,
            function_rules: FunctionRules::default(),
            constraint_rules: ConstraintRules::default(),
            region_rules,
            waiting: None,
        })
    }

    /// The output, from which bytes may be taken.
    pub(super) fn output_mut(&mut self) -> &mut W {
        &mut self.output
    }

    /// The header that was written.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Points, cells, vertices, simplices, residual points and walls written so far.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// Appends points to a points stream without attributes.
    ///
    /// # Errors
    /// If a coordinate does not fit the encoding of the header, a region gets more points than it states, or
    /// writing fails.
    pub fn points(&mut self, points: &[Point]) -> Result<()> {
        self.expect_no_attributes();
        self.count_points(points.len())?;
        let point_len = self.header.point_len();
        let mut rest = points;
        while !rest.is_empty() {
            let capacity = (POINTS_PAYLOAD - self.points.len()) / point_len;
            let (now, later) = rest.split_at(capacity.min(rest.len()));
            encode_points(&self.header, now, &mut self.points)?;
            rest = later;
            if self.points.len() + point_len > POINTS_PAYLOAD {
                self.flush_points()?;
            }
        }
        Ok(())
    }

    /// Appends points that [`encode_points`] has encoded to a stream without attributes.
    ///
    /// # Errors
    /// If a region gets more points than it states, or writing fails.
    pub fn encoded_points(&mut self, bytes: &[u8]) -> Result<()> {
        self.expect_no_attributes();
        let point_len = self.header.point_len();
        debug_assert!(bytes.len().is_multiple_of(point_len));
        self.count_points(bytes.len() / point_len)?;
        let mut rest = bytes;
        while !rest.is_empty() {
            let capacity = (POINTS_PAYLOAD - self.points.len()) / point_len * point_len;
            let (now, later) = rest.split_at(capacity.min(rest.len()));
            self.points.extend_from_slice(now);
            rest = later;
            if self.points.len() + point_len > POINTS_PAYLOAD {
                self.flush_points()?;
            }
        }
        Ok(())
    }

    /// Tags cells as final: no later point lies in them. Flushes buffered points first.
    ///
    /// # Errors
    /// If writing fails.
    pub fn cells(&mut self, cells: &[CellCode]) -> Result<()> {
        self.flush_points()?;
        for cells in cells.chunks(BLOCK_PAYLOAD_MAX / 8) {
            let payload = &mut self.payload;
            payload.clear();
            cells.iter().for_each(|cell| payload.extend_from_slice(&cell.0.to_le_bytes()));
            self.flush_block(Tag::Cells)?;
            self.totals.cells += cells.len() as u64;
        }
        Ok(())
    }

    /// Appends a patch to a mesh stream without attributes, as [`StreamWriter::patch_with_rows`].
    ///
    /// # Errors
    /// As there.
    pub fn patch(&mut self, patch: &Patch) -> Result<()> {
        self.patch_with_rows(patch, &[])
    }

    /// Appends a patch to a mesh stream; `first_id` must be the number of vertices written before. `rows` are
    /// the attributes of its new vertices; empty if the stream has none.
    ///
    /// # Errors
    /// If a coordinate does not fit the encoding, the patch, its sides or its rows are longer than a block, a
    /// side breaks a rule, or writing fails.
    pub fn patch_with_rows(&mut self, patch: &Patch, rows: &[u8]) -> Result<()> {
        assert_eq!(patch.first_id, self.totals.vertices, "vertex ids count up in stream order");
        let per_simplex = self.header.kind.vertices_per_simplex();
        debug_assert!(
            patch.check(self.totals.vertices, per_simplex).is_ok(),
            "a patch that no reader accepts"
        );
        self.write_sides(patch)?;
        self.write_shared(patch)?;
        let payload = &mut self.payload;
        payload.clear();
        payload.extend_from_slice(&patch.first_id.to_le_bytes());
        let simplices = patch.simplices.len() / per_simplex;
        for count in [patch.new.len(), patch.imported.len(), simplices, patch.finalized.len()] {
            payload.extend_from_slice(&(count as u32).to_le_bytes());
        }
        for &point in &patch.new {
            encode_point(&self.header, point, payload)?;
        }
        patch.imported.iter().for_each(|id| payload.extend_from_slice(&id.to_le_bytes()));
        for local in patch.simplices.iter().chain(&patch.finalized) {
            payload.extend_from_slice(&local.to_le_bytes());
        }
        self.flush_block(Tag::Patch)?;
        self.write_rows(patch.new.len(), rows)?;
        self.totals.vertices += patch.new.len() as u64;
        self.totals.simplices += simplices as u64;
        Ok(())
    }

    /// Appends patches that were encoded ahead. `id_of` maps the references of imported vertices to ids;
    /// `count` gets the numbers of new and of finalized vertices of each patch.
    ///
    /// # Errors
    /// If a patch is longer than a block, or writing fails.
    pub fn patches(
        &mut self,
        blocks: &mut PatchBlocks,
        id_of: impl Fn(u64) -> u64,
        mut count: impl FnMut(u64, u64),
    ) -> Result<()> {
        for number in 0..blocks.count() {
            self.write_origins(blocks.origins(number))?;
            self.start_block(Tag::Patch);
            let patch = blocks.complete(number, self.totals.vertices, &id_of);
            check_len(patch.payload_len())?;
            debug_assert!(
                super::payload::patch(&self.header, self.totals.vertices, &patch.payload.concat()).is_ok(),
                "a patch that no reader accepts"
            );
            let [new, simplices, finalized] = patch.counts();
            let rows = patch.rows;
            if self.compressor.is_some() {
                self.payload.clear();
                patch.payload.iter().for_each(|part| self.payload.extend_from_slice(part));
                self.write_block(Tag::Patch)?;
            } else {
                patch.write(self.sequence, &mut self.output).map_err(write_error)?;
                self.sequence = self.sequence.wrapping_add(1);
            }
            self.write_rows(new as usize, rows)?;
            self.totals.vertices += new;
            self.totals.simplices += simplices;
            count(new, finalized);
        }
        Ok(())
    }

    /// Appends the labels of the next vertices without a label. Earlier patches must have these vertices. At
    /// the end either all vertices have labels, or none has.
    ///
    /// # Errors
    /// If writing fails.
    pub fn labels(&mut self, labels: &[u64]) -> Result<()> {
        self.labels += labels.len() as u64;
        assert!(self.labels <= self.totals.vertices, "a label follows its vertex");
        for labels in labels.chunks(BLOCK_PAYLOAD_MAX / 8) {
            let payload = &mut self.payload;
            payload.clear();
            labels.iter().for_each(|label| payload.extend_from_slice(&label.to_le_bytes()));
            self.flush_block(Tag::Labels)?;
        }
        Ok(())
    }

    /// Writes END and flushes. For streams with vertices, END states that `input_points` points were
    /// triangulated, and that `merged` of them coincide with another one. A points stream counts its own
    /// points and ignores both.
    ///
    /// # Errors
    /// Malformed, if a 4D cell names a neighbour that does not exist, a spline lacks coefficients or
    /// configurations, regions lack points, or a total is beyond counting; I/O, if writing or flushing fails.
    pub fn end(mut self, input_points: u64, merged: u64) -> Result<W> {
        assert!(self.labels == 0 || self.labels == self.totals.vertices, "all vertices have labels, or none");
        self.flush_points()?;
        self.flush_configurations()?;
        self.rules4.check_end(&self.totals)?;
        if self.header.kind == Kind::Splines {
            check_end(&self.totals)?;
        }
        self.configuration_rules.check_end()?;
        if let Some(rules) = &self.region_rules {
            rules.check_end(self.header.points, &self.totals)?;
        }
        if self.header.kind.has_vertices() {
            self.totals.points = input_points;
            self.totals.merged = merged;
        }
        let totals = self.totals;
        totals.check_range()?;
        self.payload.clear();
        for total in totals.fields() {
            self.payload.extend_from_slice(&total.to_le_bytes());
        }
        self.flush_block(Tag::End)?;
        self.output.flush().map_err(write_error)?;
        Ok(self.output)
    }

    fn flush_points(&mut self) -> Result<()> {
        if self.points.is_empty() {
            return Ok(());
        }
        std::mem::swap(&mut self.points, &mut self.payload);
        self.flush_block(self.points_tag)?;
        self.points.clear();
        self.flush_rows()
    }

    fn flush_block(&mut self, tag: Tag) -> Result<()> {
        self.start_block(tag);
        check_len(self.payload.len())?;
        self.write_block(tag)
    }

    /// Writes the payload as a block, compressed if the stream may be and that makes it smaller.
    fn write_block(&mut self, tag: Tag) -> Result<()> {
        let compressor = self.compressor.as_mut();
        let compressed = compressor.and_then(|to| to.compress(&self.header, tag, &self.payload));
        let frame = match compressed {
            Some(compressed) => Frame::of_compressed(tag, self.sequence, compressed),
            None => Frame::of(tag, self.sequence, [&self.payload, &[]]),
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.output.write_all(&frame.encode()).map_err(write_error)?;
        self.output.write_all(compressed.unwrap_or(&self.payload)).map_err(write_error)
    }

    fn start_block(&mut self, tag: Tag) {
        assert!(
            self.header.kind.allows(self.last_tag, tag),
            "{tag:?} after {:?} in a stream of kind {}",
            self.last_tag,
            self.header.kind.name()
        );
        self.last_tag = Some(tag);
    }
}

fn check_len(payload_len: usize) -> Result<()> {
    if payload_len > BLOCK_PAYLOAD_MAX {
        return Err(Error::usage(format!(
            "cannot write a block of {payload_len} bytes, the maximum is {BLOCK_PAYLOAD_MAX}"
        )));
    }
    Ok(())
}

fn write_error(cause: std::io::Error) -> Error {
    Error::io("writing the stream", cause)
}
