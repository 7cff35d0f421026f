//! Reads SMB, Isenburg's streaming mesh in binary (`formats/historical_meshes.md`).

use std::io::{BufReader, Chain, Cursor, Read};

use crate::drivers::{AnyInput, Events};
use crate::historical::read_sma::check_count;
use crate::historical::smb_header::{ELEMENT_LEN, ELEMENTS_PER_BLOCK, SmbHeader, point, read_header};
use crate::raw::byte_order::ByteOrder;
use crate::source::mesh_events::{Element, Elements, MeshEvents, resolve};
use crate::source::patches::Order;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::HEADER_BODY_MAX;

/// Opens an SMB mesh, pre-order or post-order, and reads its header. The byte order is decided by the
/// plausibility of header and first block in each order, because the flag in the file is often wrong.
/// Messages call the input `name`.
///
/// Verifies the counts that the header states. Without them, a mesh that declares some vertices final is
/// truncated if it leaves others open.
///
/// # Errors
/// If the header makes sense in neither byte order. This and every later error is
/// [`spmesh_base::error::ErrorKind::Malformed`] (or I/O) and names input and byte.
pub fn open_smb(input: AnyInput, name: &str) -> Result<Events> {
    let mut input = BufReader::new(input);
    let mut head = Vec::new();
    let read = (&mut input).take(HEADER_BODY_MAX as u64).read_to_end(&mut head);
    read.map_err(|e| Error::io("reading", e).of_input(name))?;
    let header = read_header(&head).map_err(|e| e.at("header at byte 0").of_input(name))?;
    let mut rest = Cursor::new(head);
    rest.set_position(header.len as u64);
    let mut elements = SmbElements {
        input: rest.chain(input),
        name: name.to_string(),
        offset: header.len as u64,
        header,
        order: Order::Stated,
        descriptor: 0,
        block: Vec::new(),
        used: 0,
        ended: false,
    };
    elements.read_block().map_err(|e| elements.locate(e))?;
    if !elements.block.is_empty() && elements.descriptor & 1 == 0 {
        elements.order = Order::OnArrival;
    }
    Ok(Box::new(MeshEvents::new(elements)))
}

struct SmbElements {
    input: Chain<Cursor<Vec<u8>>, BufReader<AnyInput>>,
    name: String,
    header: SmbHeader,
    order: Order,
    descriptor: u32,
    block: Vec<u8>,
    /// Offset of the block in the file.
    offset: u64,
    /// Elements of the block already returned.
    used: usize,
    /// The block is the last one.
    ended: bool,
}

impl SmbElements {
    fn read_block(&mut self) -> Result<()> {
        let mut descriptor = Vec::with_capacity(4);
        self.read(4, &mut descriptor)?;
        if descriptor.is_empty() && self.header.vertices.is_none() {
            // Every mesh ends with a block of fewer than 32 elements, possibly none.
            return Err(Error::malformed("truncated: the last block is missing"));
        }
        let mut block = std::mem::take(&mut self.block);
        block.clear();
        self.read(ELEMENT_LEN * ELEMENTS_PER_BLOCK, &mut block)?;
        self.block = block;
        self.used = 0;
        self.ended = self.block.len() < ELEMENT_LEN * ELEMENTS_PER_BLOCK;
        if !matches!(descriptor.len(), 0 | 4) || !self.block.len().is_multiple_of(ELEMENT_LEN) {
            return Err(Error::malformed("truncated: the file ends inside of an element"));
        }
        self.descriptor = if descriptor.is_empty() { 0 } else { self.header.order.u32(&descriptor) };
        Ok(())
    }

    fn read(&mut self, len: usize, bytes: &mut Vec<u8>) -> Result<()> {
        let read = (&mut self.input).take(len as u64).read_to_end(bytes);
        read.map(drop).map_err(|e| Error::io("reading", e))
    }
}

impl Elements for SmbElements {
    fn order(&self) -> Order {
        self.order
    }

    fn next_element(&mut self, vertices: u64) -> Result<Option<Element>> {
        if self.used * ELEMENT_LEN == self.block.len() {
            if self.ended {
                return Ok(None);
            }
            self.offset += 4 + self.block.len() as u64;
            self.read_block()?;
            if self.block.is_empty() {
                return Ok(None);
            }
        }
        let bytes = &self.block[self.used * ELEMENT_LEN..][..ELEMENT_LEN];
        let is_vertex = self.descriptor >> self.used & 1 == 1;
        self.used += 1;
        let order = self.header.order;
        if is_vertex { vertex(order, bytes) } else { triangle(order, bytes, vertices) }.map(Some)
    }

    fn check_counts(&self, vertices: u64, triangles: u64) -> Result<bool> {
        check_count("vertices", self.header.vertices, vertices)?;
        check_count("triangles", self.header.triangles, triangles)?;
        Ok(self.header.vertices.is_some() && self.header.triangles.is_some())
    }

    fn locate(&self, error: Error) -> Error {
        let element = self.used.saturating_sub(1);
        error.at(format!("element {element} of the block at byte {}", self.offset)).of_input(&self.name)
    }
}

fn vertex(order: ByteOrder, bytes: &[u8]) -> Result<Element> {
    let point = point(order, bytes);
    match point.iter().find(|x| !x.is_finite()) {
        Some(x) => Err(Error::malformed(format!("coordinate {x}"))),
        None => Ok(Element::Vertex(point)),
    }
}

fn triangle(order: ByteOrder, bytes: &[u8], vertices: u64) -> Result<Element> {
    let (mut ids, mut finals) = ([0; 3], [false; 3]);
    for (corner, bytes) in bytes.chunks_exact(4).enumerate() {
        let number = i64::from(order.u32(bytes) as i32);
        (ids[corner], finals[corner]) = (resolve(number, vertices)?, number < 0);
    }
    Ok(Element::Triangle(ids, finals))
}
