//! The frame around every block: tag, sequence number, length and checksum.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::tag_rules::{TagBytes, check_tag, may_be_skipped, needs_newer};
use spmesh_base::error::{Error, Result};

/// Length of the frame before the payload, in bytes.
pub(super) const FRAME_LEN: usize = 16;

/// The bit of the length that marks a compressed payload.
const COMPRESSED: u32 = 1 << 31;

/// The types of blocks that this version knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tag {
    Points,
    Cells,
    Region,
    Patch,
    Labels,
    ResidualPoints,
    Walls,
    Points4,
    Cells4,
    Simplices4,
    Configurations,
    Functions,
    Coefficients,
    Rows,
    Segments,
    Sides,
    OpenSegments,
    Origins,
    Kept,
    End,
}

const NAMES: [(Tag, TagBytes); 20] = [
    (Tag::Points, *b"PNTS"),
    (Tag::Cells, *b"CELL"),
    (Tag::Region, *b"REGN"),
    (Tag::Patch, *b"PTCH"),
    (Tag::Labels, *b"LABL"),
    (Tag::ResidualPoints, *b"RPNT"),
    (Tag::Walls, *b"WALL"),
    (Tag::Points4, *b"PNT4"),
    (Tag::Cells4, *b"CEL4"),
    (Tag::Simplices4, *b"SIM4"),
    (Tag::Configurations, *b"CONF"),
    (Tag::Functions, *b"FUNC"),
    (Tag::Coefficients, *b"COEF"),
    (Tag::Rows, *b"attp"),
    (Tag::Segments, *b"segm"),
    (Tag::Sides, *b"side"),
    (Tag::OpenSegments, *b"open"),
    (Tag::Origins, *b"from"),
    (Tag::Kept, *b"kept"),
    (Tag::End, *b"END "),
];

impl Tag {
    /// Whether only a constrained mesh has such blocks.
    pub(super) fn is_of_constraints(self) -> bool {
        matches!(self, Tag::Segments | Tag::Sides | Tag::OpenSegments)
    }

    /// Whether only a part of a mesh has such blocks.
    pub(super) fn is_of_parts(self) -> bool {
        matches!(self, Tag::Origins | Tag::Kept)
    }

    /// What such a block says about the patch behind it, for messages.
    pub(super) fn of_patch(self) -> &'static str {
        match self {
            Tag::Origins | Tag::Kept => "vertices of other parts",
            _ => "sides",
        }
    }

    /// Whether such a block says more about the patch that it precedes.
    pub(super) fn is_of_patch(self) -> bool {
        matches!(self, Tag::Sides | Tag::Origins | Tag::Kept)
    }

    pub(super) fn bytes(self) -> TagBytes {
        NAMES.iter().find(|(tag, _)| *tag == self).expect("every tag has its name").1
    }

    /// The tag with this name; `None` if this version does not know it and may skip its block.
    pub(super) fn from_bytes(bytes: TagBytes) -> Result<Option<Tag>> {
        if let Some((tag, _)) = NAMES.iter().find(|(_, name)| *name == bytes) {
            return Ok(Some(*tag));
        }
        check_tag(bytes, "block")?;
        if may_be_skipped(bytes) {
            return Ok(None);
        }
        Err(needs_newer(format_args!("block tag \"{}\"", bytes.escape_ascii())))
    }
}

/// The frame of one block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) tag: TagBytes,
    pub(super) sequence: u32,
    /// Bytes of the payload in the stream.
    pub(super) len: u32,
    /// Whether they are compressed.
    pub(super) is_compressed: bool,
    checksum: u32,
    head: [u8; 12],
}

impl Frame {
    /// The frame of a block whose payload comes in two parts.
    pub(super) fn of(tag: Tag, sequence: u32, payload: [&[u8]; 2]) -> Frame {
        Frame::new(tag, sequence, payload, false)
    }

    /// The frame of a block with a compressed payload.
    pub(super) fn of_compressed(tag: Tag, sequence: u32, payload: &[u8]) -> Frame {
        Frame::new(tag, sequence, [payload, &[]], true)
    }

    fn new(tag: Tag, sequence: u32, payload: [&[u8]; 2], is_compressed: bool) -> Frame {
        let len = (payload[0].len() + payload[1].len()) as u32;
        let mut head = [0; 12];
        head[0..4].copy_from_slice(&tag.bytes());
        LE::write_u32(&mut head[4..], sequence);
        LE::write_u32(&mut head[8..], if is_compressed { len | COMPRESSED } else { len });
        let mut frame = Frame { tag: tag.bytes(), sequence, len, is_compressed, checksum: 0, head };
        frame.checksum = crc32c::crc32c_append(frame.checksum_with(payload[0]), payload[1]);
        frame
    }

    pub(super) fn decode(bytes: &[u8; FRAME_LEN]) -> Frame {
        let mut head = [0; 12];
        head.copy_from_slice(&bytes[..12]);
        let len = LE::read_u32(&bytes[8..]);
        Frame {
            tag: [bytes[0], bytes[1], bytes[2], bytes[3]],
            sequence: LE::read_u32(&bytes[4..]),
            len: len & !COMPRESSED,
            is_compressed: len & COMPRESSED != 0,
            checksum: LE::read_u32(&bytes[12..]),
            head,
        }
    }

    pub(super) fn encode(&self) -> [u8; FRAME_LEN] {
        let mut bytes = [0; FRAME_LEN];
        bytes[..12].copy_from_slice(&self.head);
        LE::write_u32(&mut bytes[12..], self.checksum);
        bytes
    }

    /// Whether the checksum matches frame and payload.
    pub(super) fn verifies(&self, payload: &[u8]) -> bool {
        self.checksum == self.checksum_with(payload)
    }

    fn checksum_with(&self, payload: &[u8]) -> u32 {
        crc32c::crc32c_append(crc32c::crc32c(&self.head), payload)
    }
}

/// The records of a payload, `len` bytes each. Refuses a payload that is not a whole number of records.
pub(super) fn whole_records(bytes: &[u8], len: usize) -> Result<std::slice::ChunksExact<'_, u8>> {
    if bytes.len().is_multiple_of(len) {
        Ok(bytes.chunks_exact(len))
    } else {
        Err(Error::malformed(format!("{} bytes are not a whole number of records of {len}", bytes.len())))
    }
}
