//! Patches of triangles whose vertices have three i32 coordinates.
//!
//! Most triangles lie beside an edge of the triangle before, and their third vertex is new or at the other
//! end of an open edge. A new vertex is coded by its difference from another corner of its first triangle.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::bytes::Bytes;
use super::columns::{ColumnReader, ColumnWriter, unzigzag, zigzag};
use super::frames::{Packer, Unpacker};
use super::operations::Operation;
use super::patch_triangles::{self as coding, Triangle};
use super::{Fault, Method};
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

const VERTEX_LEN: usize = 12;
const TRIANGLE_LEN: usize = 12;
/// Columns with a parameter: distances, references, imports, x, y, z, low and high words of ids.
const COLUMNS: usize = 8;

/// The head of a patch.
#[derive(Clone, Copy)]
struct Head {
    first_id: u64,
    new: usize,
    imported: usize,
    triangles: usize,
    finalized: usize,
}

impl Head {
    const LEN: usize = 24;

    fn take(bytes: &mut Bytes) -> Result<Head, Fault> {
        Ok(Head {
            first_id: bytes.u64()?,
            new: bytes.count()?,
            imported: bytes.count()?,
            triangles: bytes.count()?,
            finalized: bytes.count()?,
        })
    }

    fn append_to(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.first_id.to_le_bytes());
        for count in [self.new, self.imported, self.triangles, self.finalized] {
            bytes.extend_from_slice(&(count as u32).to_le_bytes());
        }
    }

    /// Length of the payload in bytes.
    fn payload_len(&self) -> u64 {
        let [new, imported, triangles, finalized] =
            [self.new, self.imported, self.triangles, self.finalized].map(|count| count as u64);
        let records =
            new * VERTEX_LEN as u64 + imported * 8 + triangles * TRIANGLE_LEN as u64 + finalized * 4;
        Head::LEN as u64 + records
    }

    fn vertices(&self) -> usize {
        self.new + self.imported
    }

    /// Length of the bits of finalized vertices in bytes.
    fn marks_len(&self) -> usize {
        self.vertices().div_ceil(8)
    }

    /// Most tokens that columns of these counts can have.
    fn tokens_max(&self) -> usize {
        4 * self.triangles + 3 * self.new + 2 * self.imported + self.marks_len()
    }
}

/// Appends the compressed form of the patch; returns whether there is one.
pub(super) fn encode(payload: &[u8], packer: &mut Packer, compressed: &mut Vec<u8>) -> bool {
    let Ok(parts) = Parts::of(payload) else { return false };
    let Some(marks) = parts.marks() else { return false };
    let Head { new, .. } = parts.head;
    let (triangles, parents) = coding::encode(new, parts.head.vertices(), &parts.triangles);
    let mut writer = ColumnWriter::default();
    writer.bytes(&triangles.operations);
    let mut parameters = Vec::with_capacity(COLUMNS);
    for column in [&triangles.distances, &triangles.references, &triangles.imports] {
        parameters.push(writer.column(column));
    }
    for axis in 0..3 {
        parameters.push(writer.column(&vertex_residuals(parts.vertices, &parents, axis)));
    }
    let gaps = id_gaps(parts.ids);
    for shift in [0, 32] {
        let words: Vec<u32> = gaps.iter().map(|gap| (gap >> shift) as u32).collect();
        parameters.push(writer.column(&words));
    }
    writer.bytes(&marks);
    compressed.push(Method::Patch as u8);
    parts.head.append_to(compressed);
    compressed.extend_from_slice(&parameters);
    writer.finish(packer, compressed);
    true
}

/// The parts of a payload that is to be compressed.
struct Parts<'a> {
    head: Head,
    vertices: &'a [u8],
    ids: &'a [u8],
    triangles: Vec<Triangle>,
    finalized: &'a [u8],
}

impl<'a> Parts<'a> {
    fn of(payload: &'a [u8]) -> Result<Parts<'a>, Fault> {
        let mut bytes = Bytes(payload);
        let head = Head::take(&mut bytes)?;
        if head.payload_len() != payload.len() as u64 {
            return Err("counts");
        }
        let vertices = bytes.take(VERTEX_LEN * head.new)?;
        let ids = bytes.take(8 * head.imported)?;
        let corners = |record: &[u8]| [0, 4, 8].map(|at| LE::read_u32(&record[at..]));
        let records = bytes.take(TRIANGLE_LEN * head.triangles)?.chunks_exact(TRIANGLE_LEN);
        let triangles: Vec<Triangle> = records.map(corners).collect();
        let count = head.vertices() as u32;
        let is_triangle =
            |&[a, b, c]: &Triangle| a < count && b < count && c < count && a != b && b != c && c != a;
        if !triangles.iter().all(is_triangle) {
            return Err("triangles");
        }
        Ok(Parts { head, vertices, ids, triangles, finalized: bytes.0 })
    }

    /// A bit for each vertex, set for those that are finalized; `None` if these are no increasing indices.
    fn marks(&self) -> Option<Vec<u8>> {
        let mut marks = vec![0; self.head.marks_len()];
        let mut lowest = 0;
        for local in self.finalized.chunks_exact(4).map(LE::read_u32) {
            if local < lowest || local as usize >= self.head.vertices() {
                return None;
            }
            lowest = local + 1;
            marks[local as usize / 8] |= 1 << (local % 8);
        }
        Some(marks)
    }
}

/// What coordinates of new vertices differ from those of their parents; the first one from 0.
fn vertex_residuals(vertices: &[u8], parents: &[u32], axis: usize) -> Vec<u32> {
    let at = |vertex: usize| LE::read_i32(&vertices[VERTEX_LEN * vertex + 4 * axis..]);
    let residual = |(vertex, &parent): (usize, &u32)| {
        let prediction = if vertex == 0 { 0 } else { at(parent as usize) };
        zigzag(at(vertex).wrapping_sub(prediction))
    };
    parents.iter().enumerate().map(residual).collect()
}

/// What each id is greater than the one before, the first one than 0.
fn id_gaps(ids: &[u8]) -> Vec<u64> {
    let mut before = 0;
    let gap = |id: u64| id.wrapping_sub(std::mem::replace(&mut before, id));
    ids.chunks_exact(8).map(LE::read_u64).map(gap).collect()
}

/// Appends the patch of a compressed payload, which is given without its method.
pub(super) fn decode(body: &[u8], unpacker: &mut Unpacker, payload: &mut Vec<u8>) -> Result<(), Fault> {
    let mut bytes = Bytes(body);
    let head = Head::take(&mut bytes)?;
    if head.payload_len() > BLOCK_PAYLOAD_MAX as u64 {
        return Err("counts of more than fits a block");
    }
    let parameters = bytes.take(COLUMNS)?;
    let frame_len = bytes.count()?;
    let tokens = unpacker.unpack(bytes.take(frame_len)?, head.tokens_max())?;
    let mut columns = ColumnReader::new(tokens, bytes.0);
    let operations = columns.bytes(head.triangles)?;
    let takes = takes(operations)?;
    let distances = columns.column(takes[0], parameters[0])?;
    let references = columns.column(takes[1], parameters[1])?;
    let imports = columns.column(takes[2], parameters[2])?;
    let numbers = [&distances[..], &references, &imports];
    let (triangles, parents) = coding::decode(head.new, head.vertices(), operations, numbers)?;
    head.append_to(payload);
    let axes = [3, 4, 5].map(|column| columns.column(head.new, parameters[column]));
    let [x, y, z] = axes;
    append_vertices([&x?, &y?, &z?], &parents, payload);
    let low = columns.column(head.imported, parameters[6])?;
    let high = columns.column(head.imported, parameters[7])?;
    append_ids(&low, &high, payload);
    append_words(triangles.as_flattened(), payload);
    append_finalized(columns.bytes(head.marks_len())?, &head, payload)?;
    columns.check_end()
}

/// How many numbers all operations take of each column.
fn takes(operations: &[u8]) -> Result<[usize; 3], Fault> {
    let mut counts = [0; 256];
    operations.iter().for_each(|&code| counts[usize::from(code)] += 1);
    let mut takes = [0; 3];
    for (code, &count) in (0..=u8::MAX).zip(&counts).filter(|(_, count)| **count > 0) {
        let each = Operation::of_code(code)?.takes();
        takes.iter_mut().zip(each).for_each(|(takes, each)| *takes += count * each);
    }
    Ok(takes)
}

fn append_vertices(residuals: [&[u32]; 3], parents: &[u32], payload: &mut Vec<u8>) {
    let mut vertices: Vec<[i32; 3]> = Vec::with_capacity(parents.len());
    for (vertex, &parent) in parents.iter().enumerate() {
        // The first vertex is its own parent, and is not there yet.
        let prediction = vertices.get(parent as usize).copied().unwrap_or_default();
        let residuals = residuals.map(|axis| unzigzag(axis[vertex]));
        let at: [i32; 3] = std::array::from_fn(|axis| prediction[axis].wrapping_add(residuals[axis]));
        vertices.push(at);
    }
    payload.extend(vertices.iter().flatten().flat_map(|coordinate| coordinate.to_le_bytes()));
}

fn append_ids(low: &[u32], high: &[u32], payload: &mut Vec<u8>) {
    let mut id = 0u64;
    for (&low, &high) in low.iter().zip(high) {
        id = id.wrapping_add(u64::from(low) | u64::from(high) << 32);
        payload.extend_from_slice(&id.to_le_bytes());
    }
}

fn append_words(words: &[u32], payload: &mut Vec<u8>) {
    payload.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

/// Appends the finalized vertices of the marks.
fn append_finalized(marks: &[u8], head: &Head, payload: &mut Vec<u8>) -> Result<(), Fault> {
    let count: u32 = marks.iter().map(|byte| byte.count_ones()).sum();
    if count as usize != head.finalized {
        return Err("another number of finalized vertices than the count");
    }
    for (first, &byte) in (0..).step_by(8).zip(marks) {
        let mut left = byte;
        while left != 0 {
            let local: u32 = first + left.trailing_zeros();
            if local as usize >= head.vertices() {
                return Err("a finalized vertex that does not exist");
            }
            payload.extend_from_slice(&local.to_le_bytes());
            left &= left - 1;
        }
    }
    Ok(())
}
