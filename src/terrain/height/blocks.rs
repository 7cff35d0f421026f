//! Triangles in blocks of neighbours, in a temporary file.

use super::boxes::Box2;
use spmesh_base::error::Result;
use spmesh_base::temporary::TemporaryFile;
use spmesh_stream::model::bounds::Point;

/// Blocks whose bounds are looked at together.
const GROUP_LEN: usize = 64;

/// A triangle with corners in stored coordinates.
pub type Triangle = [Point; 3];

/// The corners of a triangle, as places among the vertices of its block.
pub(crate) type Corners = [u16; 3];

/// A block in the file: its vertices, then the corners of its triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) bounds: Box2,
    /// First byte in the file.
    pub(super) at: u64,
    pub(super) vertices: u32,
    pub(super) triangles: u32,
}

/// All triangles of a mesh, in blocks.
///
/// Memory: 48 bytes for each block of about two thousand triangles.
#[derive(Debug)]
pub(crate) struct Blocks {
    file: TemporaryFile,
    /// Whether coordinates are stored as integers of 32 bits.
    is_integer: bool,
    blocks: Vec<Block>,
    /// The boxes of groups of blocks.
    groups: Vec<Box2>,
    triangles: u64,
}

impl Blocks {
    /// The blocks of a file.
    pub(super) fn new(file: TemporaryFile, is_integer: bool, blocks: Vec<Block>) -> Blocks {
        let bounds = |group: &[Block]| group.iter().fold(Box2::NONE, |all, block| all.with(&block.bounds));
        let groups = blocks.chunks(GROUP_LEN).map(bounds).collect();
        let triangles = blocks.iter().map(|block| u64::from(block.triangles)).sum();
        Blocks { file, is_integer, blocks, groups, triangles }
    }

    /// Number of triangles.
    pub(super) fn triangles(&self) -> u64 {
        self.triangles
    }

    /// Number of blocks.
    pub(crate) fn len(&self) -> usize {
        self.blocks.len()
    }

    /// The box of a block.
    pub(super) fn bounds(&self, block: usize) -> &Box2 {
        &self.blocks[block].bounds
    }

    /// The blocks whose boxes satisfy a condition, which must hold for a box if it holds for a part of it.
    pub(crate) fn that(&self, condition: impl Fn(&Box2) -> bool + Copy) -> impl Iterator<Item = usize> {
        let groups = (0..self.groups.len()).filter(move |&group| condition(&self.groups[group]));
        groups.flat_map(|group| self.group(group)).filter(move |&block| condition(self.bounds(block)))
    }

    /// The first of the blocks whose boxes are nearest to a point; `None` if the squared distance of all is
    /// greater than `within2`.
    pub(super) fn closest(&self, point: &Point, within2: f64) -> Option<usize> {
        let (mut closest, mut least) = (None, within2.next_up());
        for (group, bounds) in self.groups.iter().enumerate() {
            if bounds.distance2(point) >= least {
                continue;
            }
            for block in self.group(group) {
                let distance2 = self.bounds(block).distance2(point);
                if distance2 < least {
                    (closest, least) = (Some(block), distance2);
                }
            }
        }
        closest
    }

    /// The blocks of a group.
    fn group(&self, group: usize) -> std::ops::Range<usize> {
        let first = group * GROUP_LEN;
        first..(first + GROUP_LEN).min(self.blocks.len())
    }

    /// Replaces `loaded` with a block.
    pub(crate) fn read(&self, block: usize, loaded: &mut LoadedBlock) -> Result<()> {
        let Block { at, vertices, triangles, .. } = self.blocks[block];
        let vertex_len = if self.is_integer { size_of::<[i32; 3]>() } else { size_of::<Point>() };
        let vertices_len = vertices as usize * vertex_len;
        let LoadedBlock { bytes, vertices, corners } = loaded;
        bytes.resize(vertices_len + triangles as usize * size_of::<Corners>(), 0);
        self.file.read_at("reading triangles", bytes, at)?;
        let (of_vertices, of_triangles) = bytes.split_at(vertices_len);
        vertices.clear();
        if self.is_integer {
            let stored = of_vertices.chunks_exact(vertex_len).map(bytemuck::pod_read_unaligned);
            vertices.extend(stored.map(|vertex: [i32; 3]| vertex.map(f64::from)));
        } else {
            vertices.extend(of_vertices.chunks_exact(vertex_len).map(bytemuck::pod_read_unaligned::<Point>));
        }
        corners.clear();
        let stored = of_triangles.chunks_exact(size_of::<Corners>());
        corners.extend(stored.map(bytemuck::pod_read_unaligned::<Corners>));
        Ok(())
    }
}

/// A block in memory; reusable.
#[derive(Debug, Default)]
pub(crate) struct LoadedBlock {
    bytes: Vec<u8>,
    vertices: Vec<Point>,
    corners: Vec<Corners>,
}

impl LoadedBlock {
    /// The vertices.
    #[inline]
    pub(crate) fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// The corners of each triangle.
    #[inline]
    pub(crate) fn corners(&self) -> &[Corners] {
        &self.corners
    }

    /// The triangle with these corners.
    #[inline]
    pub(super) fn triangle(&self, corners: Corners) -> Triangle {
        corners.map(|corner| self.vertices[usize::from(corner)])
    }

    /// The triangles.
    pub(super) fn triangles(&self) -> impl Iterator<Item = Triangle> + '_ {
        self.corners.iter().map(|&corners| self.triangle(corners))
    }
}
