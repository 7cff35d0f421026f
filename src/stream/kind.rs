//! The table of stream kinds: what each is called and which blocks it may hold.

use super::block::Tag;

/// What a stream holds. A new kind is one row in the table of this file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Points, with the tags of cells that no later point lies in.
    Points,
    /// A triangle mesh in patches, vertices finalized after their last triangle.
    TriangleMesh,
    /// The final triangles of a region and its residual, to be merged with those of other regions.
    PartialTriangleMesh,
    /// A tetrahedral mesh in patches, vertices finalized after their last tetrahedron; a label for each vertex, or
    /// for none.
    TetrahedralMesh,
}

struct Row {
    kind: Kind,
    code: u16,
    name: &'static str,
    vertices_per_simplex: usize,
    blocks: &'static [Tag],
    /// Whether all blocks of a tag come before those of the next one in `blocks`.
    is_ordered: bool,
}

const ROWS: [Row; 4] = [
    Row {
        kind: Kind::Points,
        code: 1,
        name: "points",
        vertices_per_simplex: 0,
        blocks: &[Tag::Points, Tag::Cells],
        is_ordered: false,
    },
    Row {
        kind: Kind::TriangleMesh,
        code: 2,
        name: "triangle mesh",
        vertices_per_simplex: 3,
        blocks: &[Tag::Patch],
        is_ordered: true,
    },
    Row {
        kind: Kind::PartialTriangleMesh,
        code: 3,
        name: "partial triangle mesh",
        vertices_per_simplex: 3,
        blocks: &[Tag::Patch, Tag::ResidualPoints, Tag::Walls],
        is_ordered: true,
    },
    Row {
        kind: Kind::TetrahedralMesh,
        code: 4,
        name: "tetrahedral mesh",
        vertices_per_simplex: 4,
        blocks: &[Tag::Patch, Tag::Labels],
        is_ordered: false,
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

    /// The kind with this name, if there is one.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.name == name).map(|row| row.kind)
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

    /// Whether a block of tag `tag` may follow one of tag `last` (`None` at the start) in such a stream.
    pub(super) fn allows(self, last: Option<Tag>, tag: Tag) -> bool {
        let Row { blocks, is_ordered, .. } = self.row();
        let rank = |tag: Tag| blocks.iter().position(|&block| block == tag);
        match (rank(tag), last.and_then(rank)) {
            (Some(rank), Some(last)) => !is_ordered || last <= rank,
            (Some(_), None) => true,
            (None, _) => tag == Tag::End,
        }
    }
}
