//! Triangles in blocks of neighbours, in a temporary file.

use std::path::Path;

use spmesh_core::error::Result;
use spmesh_core::parallel::OrderedPool;
use spmesh_core::temporary::TemporaryFile;
use spmesh_model::bounds::Point;
use spmesh_model::points::Point2;

/// Most triangles of a block: few enough to stay in a core's cache.
const BLOCK_LEN: usize = 1 << 11;

/// Triangles that are divided into blocks together: 9 MB.
const BUFFER_LEN: usize = 1 << 17;

/// Most buffers that the thread has at once.
const BUFFERS_MAX: u64 = 2;

/// Blocks whose bounds are looked at together.
const GROUP_LEN: usize = 64;

/// A triangle with corners in stored coordinates.
pub(super) type Triangle = [Point; 3];

/// A closed box in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Box2 {
    pub(super) min: Point2,
    pub(super) max: Point2,
}

impl Box2 {
    const NONE: Box2 = Box2 { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };

    /// The box of some points.
    pub(super) fn of<'p>(points: impl IntoIterator<Item = &'p Point>) -> Box2 {
        points.into_iter().fold(Box2::NONE, |all, &[x, y, _]| all.with(&Box2 { min: [x, y], max: [x, y] }))
    }

    /// The least box around both.
    fn with(&self, other: &Box2) -> Box2 {
        Box2 {
            min: [0, 1].map(|axis| self.min[axis].min(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Whether they have a point in common.
    pub(super) fn meets(&self, other: &Box2) -> bool {
        (0..2).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }

    /// The squared distance of a point from the box.
    pub(super) fn distance2(&self, at: &Point) -> f64 {
        let [x, y] = [0, 1].map(|axis| (self.min[axis] - at[axis]).max(at[axis] - self.max[axis]).max(0.0));
        x * x + y * y
    }
}

/// A block in the file.
#[derive(Debug, Clone, Copy)]
struct Block {
    bounds: Box2,
    /// First triangle and number of triangles, counted over the whole file.
    first: u64,
    count: u32,
}

/// Divides triangles into blocks and writes these, on a thread of its own.
///
/// Memory: three buffers of 9 MB, and what the thread has encoded.
pub(super) struct BlockWriter {
    file: TemporaryFile,
    is_integer: bool,
    divider: OrderedPool<Vec<Triangle>, Divided>,
    waiting: Vec<Triangle>,
    blocks: Vec<Block>,
    /// Triangles in the file.
    count: u64,
}

/// A buffer of triangles in blocks.
struct Divided {
    bytes: Vec<u8>,
    /// The box and the number of triangles of each block.
    blocks: Vec<(Box2, u32)>,
    /// The empty buffer.
    triangles: Vec<Triangle>,
}

impl BlockWriter {
    /// No triangles. The file is in `folder`, or in the system's folder for temporary files. `is_integer`
    /// says whether coordinates are integers of 32 bits, which take half of the space.
    ///
    /// # Errors
    /// If the file cannot be created, or the system refuses a thread.
    pub(super) fn new(is_integer: bool, folder: Option<&Path>) -> Result<BlockWriter> {
        let file = TemporaryFile::create(folder)?;
        let work = move |triangles| Divided::of(triangles, is_integer);
        let divider = OrderedPool::start("divider", 1, BUFFERS_MAX, work)?;
        Ok(BlockWriter { file, is_integer, divider, waiting: Vec::new(), blocks: Vec::new(), count: 0 })
    }

    /// Adds a triangle.
    ///
    /// # Errors
    /// If the file cannot be written.
    #[inline]
    pub(super) fn push(&mut self, triangle: Triangle) -> Result<()> {
        self.waiting.push(triangle);
        if self.waiting.len() == BUFFER_LEN { self.divide() } else { Ok(()) }
    }

    /// Ends the additions.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn finish(mut self) -> Result<Blocks> {
        self.divide()?;
        while let Some(divided) = self.divider.take() {
            self.write(divided)?;
        }
        let bounds = |group: &[Block]| group.iter().fold(Box2::NONE, |all, block| all.with(&block.bounds));
        let groups = self.blocks.chunks(GROUP_LEN).map(bounds).collect();
        let BlockWriter { file, is_integer, blocks, count, .. } = self;
        Ok(Blocks { file, is_integer, blocks, groups, count })
    }

    /// Gives the waiting triangles to the thread.
    fn divide(&mut self) -> Result<()> {
        let divided = if self.divider.is_full() { self.divider.take() } else { None };
        let empty = divided.map(|divided| self.write(divided)).transpose()?.unwrap_or_default();
        self.divider.give(std::mem::replace(&mut self.waiting, empty), 1);
        Ok(())
    }

    /// Writes blocks, and returns the empty buffer.
    fn write(&mut self, divided: Divided) -> Result<Vec<Triangle>> {
        let at = self.count * triangle_len(self.is_integer) as u64;
        self.file.write_at("writing triangles", &divided.bytes, at)?;
        for (bounds, count) in divided.blocks {
            self.blocks.push(Block { bounds, first: self.count, count });
            self.count += u64::from(count);
        }
        Ok(divided.triangles)
    }
}

impl Divided {
    fn of(mut triangles: Vec<Triangle>, is_integer: bool) -> Divided {
        let mut bytes = Vec::with_capacity(triangles.len() * triangle_len(is_integer));
        let mut blocks = Vec::new();
        divide(&mut triangles, &mut |block| {
            for triangle in block {
                if is_integer {
                    bytes.extend_from_slice(bytemuck::bytes_of(
                        &triangle.map(|corner| corner.map(|v| v as i32)),
                    ));
                } else {
                    bytes.extend_from_slice(bytemuck::bytes_of(triangle));
                }
            }
            blocks.push((Box2::of(block.iter().flatten()), block.len() as u32));
        });
        triangles.clear();
        Divided { bytes, blocks, triangles }
    }
}

/// Bytes of a triangle in the file.
fn triangle_len(is_integer: bool) -> usize {
    if is_integer { size_of::<[[i32; 3]; 3]>() } else { size_of::<Triangle>() }
}

/// All triangles of a mesh, in blocks.
///
/// Memory: 48 bytes for each block of about a thousand triangles.
#[derive(Debug)]
pub(super) struct Blocks {
    file: TemporaryFile,
    /// Whether coordinates are integers of 32 bits.
    is_integer: bool,
    blocks: Vec<Block>,
    /// The boxes of groups of blocks.
    groups: Vec<Box2>,
    count: u64,
}

impl Blocks {
    /// Number of triangles.
    pub(super) fn triangles(&self) -> u64 {
        self.count
    }

    /// The box of a block.
    pub(super) fn bounds(&self, block: usize) -> &Box2 {
        &self.blocks[block].bounds
    }

    /// The blocks whose boxes satisfy a condition, which must hold for a box if it holds for a part of it.
    pub(super) fn that(&self, condition: impl Fn(&Box2) -> bool + Copy) -> impl Iterator<Item = usize> {
        let groups = (0..self.groups.len()).filter(move |&group| condition(&self.groups[group]));
        groups.flat_map(|group| self.group(group)).filter(move |&block| condition(self.bounds(block)))
    }

    /// The first of the blocks whose boxes are nearest to a point; `None` if there is no block.
    pub(super) fn closest(&self, point: &Point) -> Option<usize> {
        let (mut closest, mut least) = (None, f64::INFINITY);
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

    /// Replaces `triangles` with those of a block, and uses `bytes` as a buffer.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn read(
        &self,
        block: usize,
        bytes: &mut Vec<u8>,
        triangles: &mut Vec<Triangle>,
    ) -> Result<()> {
        let Block { first, count, .. } = self.blocks[block];
        let triangle_len = triangle_len(self.is_integer);
        bytes.resize(count as usize * triangle_len, 0);
        self.file.read_at("reading triangles", bytes, first * triangle_len as u64)?;
        triangles.clear();
        if self.is_integer {
            let stored = bytes.chunks_exact(triangle_len).map(bytemuck::pod_read_unaligned);
            triangles
                .extend(stored.map(|corners: [[i32; 3]; 3]| corners.map(|corner| corner.map(f64::from))));
        } else {
            let stored = bytes.chunks_exact(triangle_len).map(bytemuck::pod_read_unaligned);
            triangles.extend(stored.map(|corners: Triangle| corners));
        }
        Ok(())
    }
}

/// Divides triangles at the median of the longer side of their box until they are few enough for a block.
fn divide(triangles: &mut [Triangle], block: &mut impl FnMut(&[Triangle])) {
    if triangles.is_empty() {
        return;
    }
    if triangles.len() <= BLOCK_LEN {
        block(triangles);
        return;
    }
    let bounds = Box2::of(triangles.iter().flatten());
    let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
    let axis = usize::from(height > width);
    let middle = triangles.len() / 2;
    // Halves do not overflow.
    let place = |[a, b, c]: &Triangle| 0.25 * a[axis] + 0.25 * b[axis] + 0.25 * c[axis];
    triangles.select_nth_unstable_by(middle, |p, q| place(p).total_cmp(&place(q)));
    let (low, high) = triangles.split_at_mut(middle);
    divide(low, block);
    divide(high, block);
}
