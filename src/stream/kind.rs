//! The table of stream kinds: what each is called and which blocks it may hold.

use super::block::Tag;

/// What a stream holds. A new kind is one row in [`Kind::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Points, with the tags of cells that no later point lies in.
    Points,
    /// A triangle mesh in patches, vertices finalized after their last triangle.
    TriangleMesh,
    /// The final triangles of a region and its residual, to be merged with those of other regions.
    PartialTriangleMesh,
}

struct Row {
    kind: Kind,
    code: u16,
    name: &'static str,
    vertices_per_simplex: usize,
    blocks: &'static [Tag],
}

const ROWS: [Row; 3] = [
    Row {
        kind: Kind::Points,
        code: 1,
        name: "points",
        vertices_per_simplex: 0,
        blocks: &[Tag::Points, Tag::Cells],
    },
    Row {
        kind: Kind::TriangleMesh,
        code: 2,
        name: "triangle mesh",
        vertices_per_simplex: 3,
        blocks: &[Tag::Patch],
    },
    Row {
        kind: Kind::PartialTriangleMesh,
        code: 3,
        name: "partial triangle mesh",
        vertices_per_simplex: 3,
        blocks: &[Tag::Patch, Tag::ResidualPoints, Tag::Walls],
    },
];

impl Kind {
    fn row(self) -> &'static Row {
        ROWS.iter().find(|row| row.kind == self).expect("every kind has its row")
    }

    /// The kind with this code in the header, if there is one.
    #[must_use]
    pub fn from_code(code: u16) -> Option<Self> {
        ROWS.iter().find(|row| row.code == code).map(|row| row.kind)
    }

    /// Code in the header.
    #[must_use]
    pub fn code(self) -> u16 {
        self.row().code
    }

    /// Name for people and for JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Vertices of a simplex; 0 where the kind holds no simplices.
    #[must_use]
    pub fn vertices_per_simplex(self) -> usize {
        self.row().vertices_per_simplex
    }

    /// Whether a stream of this kind may hold blocks of this tag.
    pub(super) fn allows(self, tag: Tag) -> bool {
        tag == Tag::End || self.row().blocks.contains(&tag)
    }
}
