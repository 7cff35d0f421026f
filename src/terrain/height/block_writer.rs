//! Divides the triangles of a mesh into blocks of neighbours.

use std::path::Path;

use super::blocks::{Block, Blocks, Corners};
use super::boxes::Box2;
use spmesh_base::error::Result;
use spmesh_base::parallel::OrderedPool;
use spmesh_base::temporary::TemporaryFile;
use spmesh_delaunay::order::{Curve, SpatialOrder};
use spmesh_delaunay::predicates::Extent;
use spmesh_stream::model::bounds::Point;

/// Most triangles of a block: few enough to stay in a core's cache.
const BLOCK_LEN: usize = 1 << 11;

/// Triangles that are divided into blocks together, and those of the patch that made them so many.
const PIECE_LEN: usize = 1 << 17;

/// Most pieces that the thread has at once.
const PIECES_MAX: u64 = 2;

/// Divides triangles into blocks on a thread of its own, and writes these.
///
/// A piece of a mesh in spatial order is small already, and is divided along a curve. Blocks of other meshes
/// are wider, which takes time but changes no height.
///
/// Memory: three pieces of 6 MB, and what the thread has encoded.
pub(super) struct BlockWriter {
    file: TemporaryFile,
    is_integer: bool,
    divider: OrderedPool<Piece, Divided>,
    waiting: Piece,
    blocks: Vec<Block>,
    /// Bytes in the file.
    len: u64,
}

/// Triangles that are divided together.
#[derive(Debug, Default)]
struct Piece {
    vertices: Vec<Point>,
    /// Corners of triangles, as places among the vertices.
    triangles: Vec<[u32; 3]>,
}

/// A piece in blocks.
struct Divided {
    bytes: Vec<u8>,
    /// Places in the file count from the first of these bytes.
    blocks: Vec<Block>,
    /// The empty piece.
    piece: Piece,
}

impl BlockWriter {
    /// No triangles. The file is in `folder`, or in the system's folder for temporary files. `is_integer`
    /// says whether coordinates are integers of 32 bits, which take half of the space.
    pub(super) fn new(is_integer: bool, folder: Option<&Path>) -> Result<BlockWriter> {
        let file = TemporaryFile::create(folder)?;
        let work = move |piece| divide(piece, is_integer);
        let divider = OrderedPool::start("divider", 1, PIECES_MAX, work)?;
        Ok(BlockWriter { file, is_integer, divider, waiting: Piece::default(), blocks: Vec::new(), len: 0 })
    }

    /// Adds triangles with corners among `vertices`.
    pub(super) fn add(
        &mut self,
        vertices: impl Iterator<Item = Point>,
        triangles: impl Iterator<Item = [u32; 3]>,
    ) -> Result<()> {
        let first = self.waiting.vertices.len() as u32;
        self.waiting.vertices.extend(vertices);
        self.waiting.triangles.extend(triangles.map(|corners| corners.map(|corner| first + corner)));
        if self.waiting.triangles.len() >= PIECE_LEN { self.give() } else { Ok(()) }
    }

    /// Ends the additions.
    pub(super) fn finish(mut self) -> Result<Blocks> {
        self.give()?;
        while let Some(divided) = self.divider.take() {
            self.write(divided)?;
        }
        Ok(Blocks::new(self.file, self.is_integer, self.blocks))
    }

    /// Gives the waiting triangles to the thread.
    fn give(&mut self) -> Result<()> {
        let divided = if self.divider.is_full() { self.divider.take() } else { None };
        let empty = divided.map(|divided| self.write(divided)).transpose()?.unwrap_or_default();
        self.divider.give(std::mem::replace(&mut self.waiting, empty), 1);
        Ok(())
    }

    /// Writes blocks, and returns the empty piece.
    fn write(&mut self, divided: Divided) -> Result<Piece> {
        self.file.write_at("writing triangles", &divided.bytes, self.len)?;
        self.blocks.extend(divided.blocks.iter().map(|block| Block { at: self.len + block.at, ..*block }));
        self.len += divided.bytes.len() as u64;
        Ok(divided.piece)
    }
}

/// Divides a piece into blocks along a Hilbert curve through the centroids of its triangles.
fn divide(mut piece: Piece, is_integer: bool) -> Divided {
    let Piece { vertices, triangles } = &mut piece;
    // Quarters do not overflow.
    let quarter = |&corner: &u32| [0, 1].map(|axis| 0.25 * vertices[corner as usize][axis]);
    let place = |corners: &[u32; 3]| {
        let [a, b, c] = corners.each_ref().map(quarter);
        [a[0] + b[0] + c[0], a[1] + b[1] + c[1]]
    };
    let places: Vec<[f64; 2]> = triangles.iter().map(place).collect();
    let mut order = SpatialOrder::default();
    let sorted: Vec<u32> = match places.is_empty() {
        true => Vec::new(),
        false => order.sort(&places, &Extent::of(&places), Curve::Hilbert).collect(),
    };
    let (mut bytes, mut blocks) = (Vec::new(), Vec::new());
    let mut encoder = Encoder::new(vertices, is_integer);
    for chosen in sorted.chunks(BLOCK_LEN) {
        let chosen = chosen.iter().map(|&at| triangles[at as usize]);
        blocks.push(encoder.append(chosen, &mut bytes));
    }
    vertices.clear();
    triangles.clear();
    Divided { bytes, blocks, piece }
}

/// Makes the bytes of blocks.
struct Encoder<'v> {
    vertices: &'v [Point],
    is_integer: bool,
    /// The vertices of the block, and for each vertex of the piece its place among them, if it is there.
    of_block: Vec<u32>,
    places: Vec<u16>,
    corners: Vec<Corners>,
}

impl<'v> Encoder<'v> {
    fn new(vertices: &'v [Point], is_integer: bool) -> Encoder<'v> {
        let places = vec![0; vertices.len()];
        Encoder { vertices, is_integer, of_block: Vec::new(), places, corners: Vec::new() }
    }

    /// Appends the block of some triangles, at most [`BLOCK_LEN`].
    fn append(&mut self, triangles: impl Iterator<Item = [u32; 3]>, bytes: &mut Vec<u8>) -> Block {
        self.of_block.clear();
        self.corners.clear();
        for triangle in triangles {
            let corners = triangle.map(|vertex| self.place(vertex));
            self.corners.push(corners);
        }
        let at = bytes.len() as u64;
        let vertices = self.of_block.iter().map(|&vertex| &self.vertices[vertex as usize]);
        let bounds = Box2::of(vertices.clone());
        for vertex in vertices {
            if self.is_integer {
                bytes.extend_from_slice(bytemuck::bytes_of(&vertex.map(|value| value as i32)));
            } else {
                bytes.extend_from_slice(bytemuck::bytes_of(vertex));
            }
        }
        bytes.extend_from_slice(bytemuck::cast_slice(&self.corners));
        Block { bounds, at, vertices: self.of_block.len() as u32, triangles: self.corners.len() as u32 }
    }

    /// The place of a vertex of the piece among those of the block, to which it is added if it is missing.
    fn place(&mut self, vertex: u32) -> u16 {
        let place = self.places[vertex as usize];
        if self.of_block.get(usize::from(place)) == Some(&vertex) {
            return place;
        }
        // Three corners for each of 2^11 triangles are fewer than 2^16.
        let place = self.of_block.len() as u16;
        self.of_block.push(vertex);
        self.places[vertex as usize] = place;
        place
    }
}
