//! The encoder's choice of the records that a payload is taken for.

use super::frames::Packer;
use super::records::{self, Shape, Words};
use crate::block::Tag;
use crate::constraints::{SIDE_LEN, segment_len};
use crate::coordinates::Coordinates;
use crate::header::Header;

/// Blocks of a tag for which a choice holds.
const CHOICE_BLOCKS: u32 = 16;

/// The shapes that suited the last blocks of each tag.
#[derive(Default)]
pub(super) struct Shapes {
    choices: Vec<(Tag, Choice)>,
    trial: Vec<u8>,
}

#[derive(Clone, Copy)]
struct Choice {
    shape: Shape,
    /// Blocks for which it still holds.
    blocks: u32,
}

impl Shapes {
    /// Appends the compressed form of a payload, in the shape that suits.
    pub(super) fn encode(
        &mut self,
        header: &Header,
        tag: Tag,
        payload: &[u8],
        packer: &mut Packer,
        compressed: &mut Vec<u8>,
    ) {
        let known = self.choices.iter_mut().find(|(of, choice)| *of == tag && choice.blocks > 0);
        if let Some((_, choice)) = known {
            choice.blocks -= 1;
            return records::encode(payload, choice.shape, packer, compressed);
        }
        let [first, others @ ..] = shape_of(header, tag).candidates();
        let mut best = first;
        let start = compressed.len();
        records::encode(payload, first, packer, compressed);
        for shape in others {
            self.trial.clear();
            records::encode(payload, shape, packer, &mut self.trial);
            if self.trial.len() < compressed.len() - start {
                compressed.truncate(start);
                compressed.extend_from_slice(&self.trial);
                best = shape;
            }
        }
        self.choices.retain(|(of, _)| *of != tag);
        self.choices.push((tag, Choice { shape: best, blocks: CHOICE_BLOCKS }));
    }
}

/// The records of a block, or those that most of its payload consists of.
fn shape_of(header: &Header, tag: Tag) -> Shape {
    let point_len = header.point_len();
    let of_points = match header.coordinates {
        Coordinates::F64 => Words::U64,
        Coordinates::I32 { .. } => Words::U32,
    };
    let (record_len, words) = match tag {
        Tag::Points | Tag::Points4 => (point_len, of_points),
        Tag::ResidualPoints => (8 + point_len, of_points),
        Tag::Cells | Tag::Labels | Tag::Coefficients | Tag::Region | Tag::End => (8, Words::U64),
        Tag::Patch => (4 * header.kind.vertices_per_simplex(), Words::U32),
        Tag::Walls => (4 * header.kind.vertices_per_wall(), Words::U32),
        Tag::Simplices4 => (20, Words::U32),
        Tag::Rows => (header.attributes.row_len(), Words::Kept),
        Tag::Segments => (segment_len(header), Words::Kept),
        Tag::Sides | Tag::Origins => (SIDE_LEN, Words::U32),
        Tag::Kept | Tag::Cells4 | Tag::OpenSegments | Tag::Configurations | Tag::Functions => (4, Words::U32),
    };
    Shape { record_len: record_len as u16, words }
}
