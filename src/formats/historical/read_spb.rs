//! SPB: binary streaming points.

use std::io::{BufReader, Cursor, Read};

use crate::historical::sp::{SpDatatype, SpEvent, SpFinalization, SpHeader, SpPass, SpReader};
use crate::raw::byte_order::{ByteOrder, parse_in_either};
use crate::source::pass::{Content, Opening};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::HEADER_BODY_MAX;
use spmesh_stream::model::bounds::{Bounds, Point};

/// First byte of a file.
const VERSION: u8 = 7;

/// Number of elements in a full block, one per bit of its descriptor.
const BLOCK_ELEMENTS: usize = 32;

impl SpDatatype {
    /// Length of a coordinate in bytes.
    fn width(self) -> usize {
        match self {
            SpDatatype::Float | SpDatatype::Int => 4,
            SpDatatype::Double => 8,
        }
    }

    /// The coordinate at the start of `bytes`.
    fn coordinate(self, order: ByteOrder, bytes: &[u8]) -> f64 {
        match self {
            SpDatatype::Float => f64::from(f32::from_bits(order.u32(bytes))),
            SpDatatype::Int => f64::from(order.u32(bytes) as i32),
            SpDatatype::Double => order.f64(bytes),
        }
    }
}

/// Reads an SPB file of either byte order.
pub struct SpbReader<R> {
    input: std::io::Chain<Cursor<Vec<u8>>, R>,
    order: ByteOrder,
    header: SpHeader,
    block: Vec<u8>,
    descriptor: u32,
    /// Elements of the block already returned.
    used: usize,
    /// Offset of the next block in the file.
    offset: u64,
    points: u64,
    ended: bool,
}

impl<R: Read> SpbReader<R> {
    /// Reads the header. The byte order is decided by the plausibility of header and first block in each
    /// order, because the flag in the file is often wrong.
    ///
    /// # Errors
    /// If reading fails, or the header makes sense in neither byte order.
    pub fn new(mut input: R) -> Result<Self> {
        let mut head = Vec::new();
        let read = (&mut input).take(HEADER_BODY_MAX as u64).read_to_end(&mut head);
        read.map_err(|e| Error::io("reading", e))?;
        let parse = |order| parse_header(&head, order).map(|(header, len)| (order, header, len));
        let score = |(order, header, len): &(_, _, usize)| plausibility(*order, header, &head[*len..]);
        let found = parse_in_either(&head, parse, score);
        let (order, header, len) = found.map_err(|e| e.at("header at byte 0"))?;
        let mut rest = Cursor::new(head);
        rest.set_position(len as u64);
        Ok(SpbReader {
            input: rest.chain(input),
            order,
            header,
            block: Vec::new(),
            descriptor: 0,
            used: 0,
            offset: len as u64,
            points: 0,
            ended: false,
        })
    }

    /// Reads descriptor and elements of the next block. The last block may be short.
    fn read_block(&mut self) -> Result<()> {
        let mut descriptor = Vec::with_capacity(4);
        self.block.clear();
        self.used = 0;
        let width = self.header.datatype.width() * 3;
        let mut read = |len: usize, bytes: &mut Vec<u8>| {
            (&mut self.input).take(len as u64).read_to_end(bytes).map_err(|e| Error::io("reading", e))
        };
        read(4, &mut descriptor)?;
        if descriptor.len() == 4 {
            read(width * BLOCK_ELEMENTS, &mut self.block)?;
            self.descriptor = self.order.u32(&descriptor);
        }
        let is_whole = matches!(descriptor.len(), 0 | 4) && self.block.len().is_multiple_of(width);
        if !is_whole {
            return Err(Error::malformed("truncated: the file ends inside a block"));
        }
        self.ended = self.block.len() < width * BLOCK_ELEMENTS;
        Ok(())
    }
}

impl<R: Read> SpReader for SpbReader<R> {
    fn header(&self) -> &SpHeader {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<SpEvent>> {
        let width = self.header.datatype.width();
        if self.used * width * 3 == self.block.len() {
            if !self.ended {
                self.offset += if self.block.is_empty() { 0 } else { 4 + self.block.len() as u64 };
                self.read_block().map_err(|e| e.at(format!("block at byte {}", self.offset)))?;
            }
            if self.used * width * 3 == self.block.len() {
                return self.header.check_count(self.points).map(|()| None);
            }
        }
        let element = &self.block[self.used * width * 3..][..width * 3];
        let is_point = self.descriptor >> self.used & 1 == 1;
        self.used += 1;
        if !is_point {
            return Ok(Some(SpEvent::FinalizedCell(self.order.u32(element) as i32)));
        }
        self.points += 1;
        Ok(Some(SpEvent::Point(point(self.order, self.header.datatype, element))))
    }

    fn position(&self) -> String {
        format!("point {} in the block at byte {}", self.points.saturating_sub(1), self.offset)
    }
}

fn point(order: ByteOrder, datatype: SpDatatype, bytes: &[u8]) -> Point {
    let width = datatype.width();
    std::array::from_fn(|axis| datatype.coordinate(order, &bytes[axis * width..]))
}

/// Parses the header in the first bytes of a file; also returns its length.
fn parse_header(head: &[u8], order: ByteOrder) -> Result<(SpHeader, usize)> {
    let mut rest = head;
    let mut take = |len: usize| -> Result<&[u8]> {
        let (bytes, after) = rest
            .split_at_checked(len)
            .ok_or_else(|| Error::malformed(format!("found {} bytes, expected {len} more", rest.len())))?;
        rest = after;
        Ok(bytes)
    };
    let start = take(3)?;
    let (datatype, finalization) = match (start[0], start[2] & 3, start[2] >> 2) {
        (VERSION, datatype @ 0..=2, method @ 0..=4) => (
            [SpDatatype::Float, SpDatatype::Int, SpDatatype::Double][usize::from(datatype)],
            [
                SpFinalization::None,
                SpFinalization::QuadTree,
                SpFinalization::OctTree,
                SpFinalization::Clarkson2d,
                SpFinalization::Clarkson3d,
            ][usize::from(method)],
        ),
        _ => return Err(Error::malformed(format!("first bytes {start:?} are not those of SPB version 7"))),
    };
    let mut comments = Vec::new();
    for _ in 0..order.u32(take(4)?) {
        let len = order.u32(take(4)?) as usize;
        comments.push(String::from_utf8_lossy(take(len)?).into_owned());
    }
    let points = match order.u32(take(4)?) as i32 {
        -1 => None,
        count => {
            Some(u64::try_from(count).map_err(|_| Error::malformed(format!("number of points is {count}")))?)
        }
    };
    let bounds = match take(1)?[0] {
        0 => None,
        _ => {
            let width = datatype.width() * 3;
            let corners = take(2 * width)?;
            let bounds = Bounds {
                min: point(order, datatype, corners),
                max: point(order, datatype, &corners[width..]),
            };
            let Bounds { min, max } = bounds;
            if !(0..3).all(|axis| min[axis] <= max[axis]) {
                return Err(Error::malformed(format!("bounding box from {min:?} to {max:?}")));
            }
            Some(bounds)
        }
    };
    let len = head.len() - rest.len();
    Ok((SpHeader { comments, datatype, finalization, points, bounds }, len))
}

/// How plausible header and first block are in this byte order. The score counts coordinates of ordinary
/// magnitude, points within the bounding box, and a descriptor without bits beyond its elements.
fn plausibility(order: ByteOrder, header: &SpHeader, body: &[u8]) -> u32 {
    let largest = if header.datatype == SpDatatype::Int { 2f64.powi(24) } else { 1e9 };
    let is_ordinary = |value: f64| value == 0.0 || (1e-9..largest).contains(&value.abs());
    let ordinary = |point: Point| point.iter().filter(|&&value| is_ordinary(value)).count() as u32;
    let mut score = header.bounds.map_or(0, |bounds| ordinary(bounds.min) + ordinary(bounds.max));
    score += 2 * u32::from(header.points.is_none_or(|points| points < 1 << 24));
    let Some((descriptor, elements)) = body.split_at_checked(4) else { return score };
    let descriptor = order.u32(descriptor);
    let elements = elements.chunks_exact(header.datatype.width() * 3).take(BLOCK_ELEMENTS);
    let unused = 32 - elements.len() as u32;
    if unused <= descriptor.leading_zeros() {
        score += 1;
    }
    for (index, element) in elements.enumerate() {
        if descriptor >> index & 1 == 1 {
            let point = point(order, header.datatype, element);
            score +=
                ordinary(point) + header.bounds.map_or(0, |bounds| 3 * u32::from(bounds.contains(point)));
        } else {
            let index = order.u32(element) as i32;
            score += 3 * u32::from((0..1 << 24).contains(&index));
        }
    }
    score
}

/// Opens a file of points.
pub(crate) fn open(file: &Opening) -> Result<Content> {
    let header = SpbReader::new(file.origin.plain()?)?.header;
    Ok(Content::new(header.state(header.bounds), |file, _| {
        let input = BufReader::with_capacity(1 << 18, file.origin.plain()?);
        Ok(Box::new(SpPass::new(SpbReader::new(input)?)))
    }))
}
