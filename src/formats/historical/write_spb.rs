//! Writes SPB, Isenburg's streaming points in binary (`formats/historical.md`).

use std::io::Write;

use crate::historical::write_cells::HistoricalCells;
use crate::sink::elements::ElementBlocks;
use crate::sink::world::{world_bounds, world_of};
use crate::sink::{EventSink, expect_kind, lost_of_points, write_error};
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Event, Header, Kind};

const VERSION: u8 = 7;
const LITTLE_ENDIAN: u8 = 0;
/// 64-bit floating-point coordinates.
const SP_DOUBLE: u8 = 2;

/// Writes points and finalization tags as SPB, little-endian, with f64 coordinates. If there is a
/// finalization tree, the bounding box is the tree's, because its halves are the cells.
pub struct SpbSink<W> {
    blocks: ElementBlocks<W>,
    header: Header,
    cells: Option<HistoricalCells>,
}

impl<W: Write> SpbSink<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Usage, if SPB does not hold the kind of stream; or if writing fails.
    pub fn new(mut output: W, header: &Header) -> Result<Self> {
        expect_kind(header, "SPB", &[Kind::Points])?;
        let cells = HistoricalCells::of(header);
        let method = cells.as_ref().map_or(0, HistoricalCells::method_code);
        let mut bytes = vec![VERSION, LITTLE_ENDIAN, SP_DOUBLE | method << 2];
        let comments = 0i32;
        let points = header.points.and_then(|points| i32::try_from(points).ok()).unwrap_or(-1);
        bytes.extend(comments.to_le_bytes());
        bytes.extend(points.to_le_bytes());
        let of_points = header.bounds.as_ref().map(|bounds| world_bounds(header, bounds));
        let bounds = cells.as_ref().map(HistoricalCells::bounds).or(of_points);
        bytes.push(u8::from(bounds.is_some()));
        if let Some(bounds) = bounds {
            bytes.extend(encode_point(bounds.min));
            bytes.extend(encode_point(bounds.max));
        }
        output.write_all(&bytes).map_err(write_error)?;
        Ok(SpbSink { blocks: ElementBlocks::new(output), header: header.clone(), cells })
    }

    fn tag(&mut self, index: i32) -> Result<()> {
        let mut element = [0; 24];
        element[..4].copy_from_slice(&index.to_le_bytes());
        self.blocks.push(false, &element)
    }

    fn tags(&mut self, tags: &[CellCode]) -> Result<()> {
        for &cell in tags {
            if let Some(index) = self.cells.as_mut().and_then(|cells| cells.index(cell)) {
                self.tag(index)?;
            }
        }
        Ok(())
    }
}

impl<W: Write> EventSink for SpbSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::Points(points) => points
                .iter()
                .try_for_each(|&point| self.blocks.push(true, &encode_point(world_of(&self.header, point)))),
            Event::Cells(tags) => self.tags(tags),
            Event::End(_) => {
                if let Some(index) = self.cells.as_ref().and_then(HistoricalCells::last_index) {
                    self.tag(index)?;
                }
                self.blocks.end()
            }
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        lost_of_points(&self.header, "SPB", self.cells.as_ref())
    }
}

fn encode_point(world: Point) -> [u8; 24] {
    let mut bytes = [0; 24];
    for (bytes, x) in bytes.chunks_exact_mut(8).zip(world) {
        bytes.copy_from_slice(&x.to_le_bytes());
    }
    bytes
}
