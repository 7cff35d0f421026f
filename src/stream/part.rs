//! Parts of a mesh that several machines make: which part a stream is, and the vertices that it shares with
//! other parts.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::whole_records;
use super::event::Patch;
use super::header::Header;
use super::kind::Kind;
use spmesh_base::error::{Error, Result};

/// Bits of a [`GlobalId`] for the number of the vertex.
const NUMBER_BITS: u32 = 40;

/// Bits of a [`GlobalId`] for the part.
const PART_BITS: u32 = 22;

/// Bytes of an origin in a stream.
const ORIGIN_LEN: usize = 12;

/// Which part of a mesh a stream is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartName {
    /// The name of the node that makes it: a hash of all that it depends on.
    pub node: u64,
    /// How many parts it joins, directly or not. These have the numbers 0, 1, ... in its ids of vertices, in
    /// the order in which they are joined, and the part itself has the number `below`.
    pub below: u32,
}

impl PartName {
    /// Most parts of a mesh.
    pub const PARTS_MAX: u32 = 1 << PART_BITS;

    /// The name of a node, written as 16 lower-case hexadecimal digits; `None` for any other text.
    pub fn parse_node(text: &str) -> Option<u64> {
        let is_digit = |byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
        let is_name = text.len() == 16 && text.bytes().all(is_digit);
        is_name.then(|| u64::from_str_radix(text, 16).ok()).flatten()
    }

    pub(super) fn encode(header: &Header) -> Option<Vec<u8>> {
        let PartName { node, below } = header.part?;
        Some([&node.to_le_bytes()[..], &below.to_le_bytes()].concat())
    }

    pub(super) fn decode(header: &mut Header, payload: &[u8]) -> std::result::Result<(), String> {
        if payload.len() != 12 {
            return Err(format!("{} bytes, expected 12", payload.len()));
        }
        header.part = Some(PartName { node: LE::read_u64(payload), below: LE::read_u32(&payload[8..]) });
        Ok(())
    }

    /// Checks that the stream with this header is the part, and not its residual.
    ///
    /// # Errors
    /// Malformed, if it is not.
    pub fn expect(self, header: &Header) -> Result<()> {
        match header.part {
            Some(name) if name == self && !header.kind.is_residual() => Ok(()),
            _ => {
                let message = "this is another part than the manifest names";
                Err(Error::malformed(message).at("header at byte 0"))
            }
        }
    }

    /// Checks that a stream with this header can be such a part.
    pub(super) fn check(self, header: &Header) -> std::result::Result<(), String> {
        let is_mesh = matches!(header.kind, Kind::TriangleMesh | Kind::TetrahedralMesh);
        if !(is_mesh || header.kind.is_residual()) {
            return Err(format!("a stream of kind {} is no part of a mesh", header.kind.name()));
        }
        if header.constrained.is_some() || header.weighted.is_some() {
            return Err("a part of a mesh is neither constrained nor weighted".into());
        }
        if self.below >= Self::PARTS_MAX {
            return Err(format!("{} parts below, expected less than {}", self.below, Self::PARTS_MAX));
        }
        Ok(())
    }
}

/// A vertex as a part, and those that join it, name it: the number of the part that has it as a vertex of its
/// own, among the parts below the one that speaks of it, and its number among the vertices of that part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GlobalId(pub u64);

impl GlobalId {
    /// Most vertices of its own that a part may have.
    pub const NUMBERS_MAX: u64 = 1 << NUMBER_BITS;

    /// Vertex `number` of part `part`.
    ///
    /// # Errors
    /// Usage, if the part has too many vertices.
    pub fn new(part: u32, number: u64) -> Result<GlobalId> {
        if number >= Self::NUMBERS_MAX {
            let message = format!("a part of more than {} vertices: divide the plan more", Self::NUMBERS_MAX);
            return Err(Error::usage(message));
        }
        Ok(GlobalId(u64::from(part) << NUMBER_BITS | number))
    }

    /// The name of the vertex in a part that joins this one behind `before` other parts.
    ///
    /// # Errors
    /// Malformed, if there cannot be so many parts.
    pub fn moved(self, before: u32) -> Result<GlobalId> {
        let part = self.part().checked_add(before).filter(|&part| part < PartName::PARTS_MAX);
        let part = part.ok_or_else(|| Error::malformed("a vertex of more parts than there can be"))?;
        GlobalId::new(part, self.number())
    }

    /// The part that has the vertex as one of its own. It fits 32 bits if [`GlobalId::is_valid`].
    pub fn part(self) -> u32 {
        (self.0 >> NUMBER_BITS) as u32
    }

    /// The number of the vertex among those of its part.
    pub fn number(self) -> u64 {
        self.0 & (Self::NUMBERS_MAX - 1)
    }

    /// Whether such a vertex can exist.
    pub fn is_valid(self) -> bool {
        self.0 >> (NUMBER_BITS + PART_BITS) == 0
    }
}

/// A new vertex of a patch that is a vertex of another part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Its local index in the patch.
    pub local: u32,
    /// Its name in all parts.
    pub id: GlobalId,
}

/// Checks the id of a residual point: that of a vertex among the `vertices` before it, or, in a residual of
/// its own, one of this part or a part before it.
///
/// # Errors
/// Malformed, if there can be no such vertex.
pub fn check_residual_id(header: &Header, vertices: u64, id: u64) -> Result<()> {
    let is_known = match header.part {
        Some(part) => GlobalId(id).is_valid() && GlobalId(id).part() <= part.below,
        None => id < vertices,
    };
    if is_known {
        Ok(())
    } else {
        Err(Error::malformed(format!("residual point has the id {id} of no vertex")))
    }
}

/// Checks what a patch of a part says about vertices of other parts.
pub(super) fn check_shared(part: Option<PartName>, patch: &Patch) -> Result<()> {
    let Some(part) = part else { return Ok(()) };
    let is_increasing = patch.origins.windows(2).all(|pair| pair[0].local < pair[1].local);
    if !is_increasing || patch.origins.last().is_some_and(|it| it.local as usize >= patch.new.len()) {
        return Err(Error::malformed("vertices of other parts are not increasing numbers of new vertices"));
    }
    let is_earlier = |origin: &Origin| origin.id.is_valid() && origin.id.part() < part.below;
    if let Some(origin) = patch.origins.iter().find(|origin| !is_earlier(origin)) {
        let (other, below) = (origin.id.0 >> NUMBER_BITS, part.below);
        return Err(Error::malformed(format!("a vertex of part {other}, expected one before part {below}")));
    }
    let mut finalized = patch.finalized.iter();
    match patch.kept.iter().find(|&local| !finalized.any(|other| other == local)) {
        None => Ok(()),
        Some(local) => Err(Error::malformed(format!(
            "vertex {local} of the patch is kept for other parts, but not finalized here, or not in order"
        ))),
    }
}

pub(super) fn encode_origins(origins: impl Iterator<Item = Origin>, bytes: &mut Vec<u8>) {
    for Origin { local, id } in origins {
        bytes.extend_from_slice(&local.to_le_bytes());
        bytes.extend_from_slice(&id.0.to_le_bytes());
    }
}

pub(super) fn decode_origins(bytes: &[u8]) -> Result<Vec<Origin>> {
    let decode =
        |record: &[u8]| Origin { local: LE::read_u32(record), id: GlobalId(LE::read_u64(&record[4..])) };
    Ok(whole_records(bytes, ORIGIN_LEN)?.map(decode).collect())
}

pub(super) fn decode_kept(bytes: &[u8]) -> Result<Vec<u32>> {
    Ok(whole_records(bytes, 4)?.map(LE::read_u32).collect())
}
