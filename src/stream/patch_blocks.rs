//! Patches that are encoded before their position in the stream is known.

use std::io::Write;

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::{FRAME_LEN, Frame, Tag};
use super::coordinates::Coordinates;
use super::header::Header;
use super::part::{GlobalId, Origin};
use super::payload::PATCH_FIXED_LEN;
use crate::model::bounds::Point;
use spmesh_base::error::{Error, Result};

/// How points and simplices are encoded: the part of a mesh header that [`PatchBlocks`] needs.
#[derive(Debug, Clone, Copy)]
pub struct PointCode {
    coordinates: Coordinates,
    per_point: usize,
    per_simplex: usize,
    row_len: usize,
}

impl PointCode {
    /// The encoding that a header states.
    pub fn of(header: &Header) -> Self {
        PointCode {
            coordinates: header.coordinates,
            per_point: header.coordinates_per_point(),
            per_simplex: header.kind.vertices_per_simplex(),
            row_len: header.attributes.row_len(),
        }
    }

    /// Bytes of the row of a point; 0 without attributes.
    pub fn row_len(&self) -> usize {
        self.row_len
    }
}

/// Encoded patches in order, with space for their frames. [`super::StreamWriter::patches`] fills in the parts
/// that depend on earlier blocks: frames, first ids, and ids of imported vertices. Until then, the caller's
/// own references take the place of these ids.
///
/// [`PatchBlocks::clear`] keeps the buffers, so that patches need no allocations.
#[derive(Debug, Default)]
pub struct PatchBlocks {
    /// Frame and payload of each patch, without its finalized vertices; the first `used` bytes count.
    bytes: Vec<u8>,
    used: usize,
    /// Finalized vertices of all patches, encoded.
    finalized: Vec<u8>,
    /// Attributes of the new vertices of all patches.
    rows: Vec<u8>,
    /// New vertices of all patches that are those of other parts, with their numbers among the new vertices of
    /// their node.
    origins: Vec<(Origin, u32)>,
    patches: Vec<Place>,
}

/// Where the parts of a patch are.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// First byte of its frame, and one past the last of its simplices.
    start: usize,
    end: usize,
    /// First byte of its imported vertices, and their number.
    imported: usize,
    imports: usize,
    /// One past the last byte of its finalized vertices, which start where those of the previous patch end.
    finalized_end: usize,
    /// One past the last byte of the rows of its new vertices.
    rows_end: usize,
    /// One past the last of its origins.
    origins_end: usize,
}

impl PatchBlocks {
    /// Forgets the patches.
    pub fn clear(&mut self) {
        self.used = 0;
        self.finalized.clear();
        self.rows.clear();
        self.origins.clear();
        self.patches.clear();
    }

    /// Capacity for patches in bytes, without their finalized vertices.
    pub fn capacity(&self) -> usize {
        self.bytes.capacity()
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.patches.len()
    }

    /// Bytes of all patches.
    pub fn byte_len(&self) -> usize {
        self.used + self.finalized.len() + self.rows.len()
    }

    /// Adds a patch: new vertices, references to imported ones, simplices in local indices. Without attributes,
    /// `rows` is empty; otherwise it gives the row of each new vertex.
    ///
    /// # Errors
    /// If a coordinate does not fit the encoding.
    pub fn push<'r>(
        &mut self,
        code: PointCode,
        new: impl ExactSizeIterator<Item = Point>,
        imported: impl ExactSizeIterator<Item = u64>,
        simplices: impl ExactSizeIterator<Item = u32>,
        rows: impl Iterator<Item = &'r [u8]>,
    ) -> Result<()> {
        let (start, imports) = (self.used, imported.len());
        let counts = [new.len(), imports, simplices.len() / code.per_simplex];
        let points_len = new.len() * code.per_point * code.coordinates.width();
        let len = FRAME_LEN + PATCH_FIXED_LEN + points_len + 8 * imports + 4 * simplices.len();
        let bytes = self.room(len);
        let fixed = &mut bytes[FRAME_LEN..][..PATCH_FIXED_LEN];
        for (count, bytes) in counts.into_iter().zip(fixed[8..20].chunks_exact_mut(4)) {
            LE::write_u32(bytes, count as u32);
        }
        let (points, rest) = bytes[FRAME_LEN + PATCH_FIXED_LEN..].split_at_mut(points_len);
        match (code.coordinates, code.per_point) {
            (Coordinates::F64, 2) => encode::<8, 2>(points, new)?,
            (Coordinates::F64, _) => encode::<8, 3>(points, new)?,
            (Coordinates::I32 { .. }, 2) => encode::<4, 2>(points, new)?,
            (Coordinates::I32 { .. }, _) => encode::<4, 3>(points, new)?,
        }
        let (ids, locals) = rest.split_at_mut(8 * imports);
        ids.chunks_exact_mut(8).zip(imported).for_each(|(bytes, id)| LE::write_u64(bytes, id));
        locals.chunks_exact_mut(4).zip(simplices).for_each(|(bytes, local)| LE::write_u32(bytes, local));
        let imported = start + FRAME_LEN + PATCH_FIXED_LEN + points_len;
        if code.row_len > 0 {
            rows.for_each(|row| self.rows.extend_from_slice(row));
        }
        let rows_end = self.rows.len();
        self.patches.push(Place {
            start,
            end: start + len,
            imported,
            imports,
            finalized_end: 0,
            rows_end,
            origins_end: self.origins.len(),
        });
        Ok(())
    }

    /// Sets the local vertices that patch number `patch` finalizes, increasing. Call it for one patch after
    /// the other, after all patches are pushed.
    pub fn finalize(&mut self, patch: usize, locals: impl Iterator<Item = u32>) {
        let before = self.finalized.len();
        locals.for_each(|local| self.finalized.extend_from_slice(&local.to_le_bytes()));
        let place = &mut self.patches[patch];
        place.finalized_end = self.finalized.len();
        let count = &mut self.bytes[place.start + FRAME_LEN + 20..][..4];
        LE::write_u32(count, ((place.finalized_end - before) / 4) as u32);
    }

    /// Names the next new vertex of the patch that was pushed last that is a vertex of another part: its local
    /// index, its number among the new vertices of its node, and its id. Call it for increasing vertices.
    pub fn origin(&mut self, local: u32, own: u32, id: GlobalId) {
        self.origins.push((Origin { local, id }, own));
        if let Some(place) = self.patches.last_mut() {
            place.origins_end = self.origins.len();
        }
    }

    /// The new vertices of all patches that are those of other parts: number among the new vertices of the
    /// node, and id.
    pub fn shared(&self) -> impl Iterator<Item = (u32, GlobalId)> + '_ {
        self.origins.iter().map(|&(origin, own)| (own, origin.id))
    }

    /// The new vertices of patch number `patch` that are those of other parts.
    pub(super) fn origins(&self, patch: usize) -> impl Iterator<Item = Origin> + use<'_> {
        let start = patch.checked_sub(1).map_or(0, |before| self.patches[before].origins_end);
        self.origins[start..self.patches[patch].origins_end].iter().map(|&(origin, _)| origin)
    }

    /// Completes the payload of patch number `patch`; `id_of` maps references to ids.
    pub(super) fn complete(
        &mut self,
        patch: usize,
        first_id: u64,
        id_of: impl Fn(u64) -> u64,
    ) -> EncodedPatch<'_> {
        let before = patch.checked_sub(1).map(|before| self.patches[before]);
        let (finalized_start, rows_start) = before.map_or((0, 0), |it| (it.finalized_end, it.rows_end));
        let Place { start, end, imported, imports, finalized_end, rows_end, .. } = self.patches[patch];
        for bytes in self.bytes[imported..imported + 8 * imports].chunks_exact_mut(8) {
            LE::write_u64(bytes, id_of(LE::read_u64(bytes)));
        }
        let (frame, payload) = self.bytes[start..end].split_at_mut(FRAME_LEN);
        LE::write_u64(payload, first_id);
        let finalized = &self.finalized[finalized_start..finalized_end];
        let rows = &self.rows[rows_start..rows_end];
        EncodedPatch { frame, payload: [payload, finalized], rows }
    }

    /// Reserves `len` more bytes with unspecified contents.
    fn room(&mut self, len: usize) -> &mut [u8] {
        let start = self.used;
        self.used += len;
        if self.bytes.len() < self.used {
            // Grow by an eighth only: each node under way may leave the rest of its memory idle.
            self.bytes.reserve_exact((self.used - self.bytes.len()).max(self.used / 8));
            self.bytes.resize(self.used, 0);
        }
        &mut self.bytes[start..self.used]
    }
}

/// A patch ready to be written.
pub(super) struct EncodedPatch<'a> {
    /// Space for its frame, before the first part of the payload.
    frame: &'a mut [u8],
    /// The payload up to the simplices, and the finalized vertices.
    pub(super) payload: [&'a [u8]; 2],
    /// The attributes of the new vertices.
    pub(super) rows: &'a [u8],
}

impl EncodedPatch<'_> {
    /// Length of the payload in bytes.
    pub(super) fn payload_len(&self) -> usize {
        self.payload[0].len() + self.payload[1].len()
    }

    /// Numbers of new vertices, simplices and finalized vertices.
    pub(super) fn counts(&self) -> [u64; 3] {
        [8, 16, 20].map(|at| u64::from(LE::read_u32(&self.payload[0][at..])))
    }

    /// Writes the patch as block `sequence`.
    pub(super) fn write(self, sequence: u32, output: &mut impl Write) -> std::io::Result<()> {
        self.frame.copy_from_slice(&Frame::of(Tag::Patch, sequence, self.payload).encode());
        output.write_all(self.frame)?;
        self.payload.iter().try_for_each(|part| output.write_all(part))
    }
}

/// Writes points of `N` coordinates of `WIDTH` bytes each.
fn encode<const WIDTH: usize, const N: usize>(
    bytes: &mut [u8],
    points: impl Iterator<Item = Point>,
) -> Result<()> {
    for (record, point) in bytes.chunks_exact_mut(WIDTH * N).zip(points) {
        let mut fits = true;
        for (bytes, value) in record.chunks_exact_mut(WIDTH).zip(point) {
            if WIDTH == 8 {
                fits &= value.is_finite();
                LE::write_f64(bytes, value);
            } else {
                fits &= f64::from(value as i32) == value;
                LE::write_i32(bytes, value as i32);
            }
        }
        if !fits {
            return Err(Error::malformed(format!("point {point:?} does not fit the stream's encoding")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::iter;

    use super::*;
    use crate::{Event, Kind, Patch, StreamReader, StreamWriter};

    #[test]
    fn tetrahedra_that_are_encoded_ahead_are_those_that_are_read() {
        let grid = Coordinates::I32 { scale: [0.001; 3], offset: [0.0; 3] };
        let header = Header::new(Kind::TetrahedralMesh, grid, 3, false);
        let point = |i: u32| [f64::from(i), f64::from(i * i), -5.0];
        let first = Patch { new: (0..5).map(point).collect(), ..Patch::default() };
        let second = Patch {
            first_id: 5,
            new: vec![point(9)],
            imported: vec![0, 1, 2, 3, 4],
            simplices: vec![0, 1, 2, 3, 4, 5, 0, 1],
            finalized: vec![0, 1, 2, 3, 4, 5],
            ..Patch::default()
        };
        let (code, mut blocks) = (PointCode::of(&header), PatchBlocks::default());
        for patch in [&first, &second] {
            let references = patch.imported.iter().map(|&id| 100 - id).collect::<Vec<_>>();
            let (new, simplices) = (patch.new.iter().copied(), patch.simplices.iter().copied());
            blocks.push(code, new, references.into_iter(), simplices, iter::empty()).unwrap();
        }
        for (number, patch) in [&first, &second].into_iter().enumerate() {
            blocks.finalize(number, patch.finalized.iter().copied());
        }
        let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
        writer.patches(&mut blocks, |reference| 100 - reference, |_, _| ()).unwrap();
        writer.labels(&[3, 3, 2, 1, 0, 9]).unwrap();
        let bytes = writer.end(6, 0).unwrap();
        let mut reader = StreamReader::new(&bytes[..], "test").unwrap();
        for patch in [first, second] {
            assert_eq!(reader.next_event().unwrap(), Some(Event::Patch(patch)));
        }
        assert_eq!(reader.next_event().unwrap(), Some(Event::Labels(vec![3, 3, 2, 1, 0, 9])));
        assert_eq!(
            reader.next_event().unwrap().map(|end| matches!(end, Event::End(t) if t.simplices == 2)),
            Some(true)
        );
    }
}
