//! Blocks of triangles of one mesh, with those of another mesh that they overlap.

use std::ops::{ControlFlow, Range};
use std::rc::Rc;

use super::grid::Grid;
use super::levels::{Table, raised};
use super::overlap::{Triangle, common};
use super::piece::Totals;
use super::regions::{Near, Regions};
use super::{Progress, Surface};
use crate::height::{Blocks, Box2, LoadedBlock};
use spmesh_base::error::Result;
use spmesh_base::parallel::for_each_result;
use spmesh_delaunay::cell_lists::CellLists;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Blocks of the first mesh that a thread takes at once.
const BLOCKS: usize = 16;

/// Blocks of the second mesh that each thread keeps.
const KEPT_MAX: usize = 24;

/// Bytes of a block in memory, with its cells.
const BLOCK_LEN: u64 = 400 << 10;

/// Bytes of a thread.
pub(super) const THREAD_LEN: u64 = (KEPT_MAX as u64 + 4) * BLOCK_LEN;

/// Cells along each side of the box of a block.
const CELLS: usize = 32;

/// Two meshes on a grid, the second one by its blocks.
pub(super) struct Join<'j> {
    pub(super) grid: &'j Grid,
    pub(super) surfaces: [&'j Surface; 2],
    pub(super) regions: &'j Regions,
    pub(super) threads: usize,
}

/// What a thread has found.
pub(super) struct Found<T> {
    pub(super) sums: Vec<T>,
    /// Number of pieces.
    pub(super) pieces: u64,
}

/// Triangles on the grid, with their boxes.
struct Loaded {
    triangles: Vec<Triangle>,
    boxes: Vec<[[i64; 2]; 2]>,
    cells: Option<Cells>,
}

/// Triangles by cells of the box around them.
struct Cells {
    min: [i64; 2],
    side: i64,
    lists: CellLists,
}

/// Runs work on all blocks of a mesh, some at a time on each thread; results come in any order.
pub(super) fn for_each_chunk<R: Send>(
    blocks: &Blocks,
    threads: usize,
    progress: &mut Progress<'_>,
    work: impl Fn(Range<usize>) -> Result<R> + Sync,
    mut finish: impl FnMut(R),
) -> Result<()> {
    let chunks: Vec<Range<usize>> =
        (0..blocks.len()).step_by(BLOCKS).map(|first| first..(first + BLOCKS).min(blocks.len())).collect();
    let mut done = 0;
    let work = |chunk: &Range<usize>| match work(chunk.clone()) {
        Ok(result) => ControlFlow::Continue(Ok(result)),
        Err(error) => ControlFlow::Break(Err(error)),
    };
    for_each_result(threads, &chunks, work, |chunk, result| {
        finish(result?);
        done += chunk.len() as u64;
        progress(done, blocks.len() as u64);
        Ok(())
    })
}

impl Join<'_> {
    /// The sums of all pieces, for each region, and the number of pieces.
    pub(super) fn run(&self, progress: &mut Progress<'_>) -> Result<Found<Totals>> {
        let none = || Found { sums: vec![Totals::default(); self.regions.count()], pieces: 0 };
        let mut all = none();
        let work = |chunk: Range<usize>| {
            let (mut found, mut kept) = (none(), Vec::new());
            for block in chunk {
                self.add_block(block, &mut kept, &mut found)?;
            }
            Ok(found)
        };
        for_each_chunk(self.surfaces[0].blocks(), self.threads, progress, work, |found| {
            all.sums.iter_mut().zip(&found.sums).for_each(|(own, other)| own.merge(other));
            all.pieces += found.pieces;
        })?;
        Ok(all)
    }

    fn add_block(
        &self,
        block: usize,
        kept: &mut Vec<(usize, Rc<Loaded>)>,
        found: &mut Found<Totals>,
    ) -> Result<()> {
        let [first, second] = self.surfaces.map(Surface::blocks);
        let own = Loaded::read(first, block, |stored| self.grid.vertex(0, stored))?;
        let [min, max] = own.bounds();
        let near = self.regions.near(&[min, max]);
        let meets = |bounds: &Box2| {
            let [low, high] = [bounds.min, bounds.max].map(|[x, y]| self.grid.vertex(1, [x, y, 0.0]));
            (0..2).all(|axis| low[axis] <= max[axis] && min[axis] <= high[axis])
        };
        let others: Vec<usize> = second.that(meets).collect();
        for other in others {
            let loaded = match kept.iter().position(|(number, _)| *number == other) {
                Some(at) => kept.remove(at).1,
                None => {
                    kept.drain(..(kept.len() + 1).saturating_sub(KEPT_MAX));
                    Rc::new(Loaded::read(second, other, |stored| self.grid.vertex(1, stored))?.in_cells())
                }
            };
            kept.push((other, Rc::clone(&loaded)));
            self.add_pairs(&own, &loaded, &near, found);
        }
        Ok(())
    }

    fn add_pairs(&self, own: &Loaded, other: &Loaded, near: &Near, found: &mut Found<Totals>) {
        for (triangle, bounds) in own.triangles.iter().zip(&own.boxes) {
            let close = (!near.is_plain()).then(|| near.within(bounds));
            let near = close.as_ref().unwrap_or(near);
            other.that_meet(bounds, |at, area| {
                found.add(triangle, &other.triangles[at], area, near);
            });
        }
    }
}

impl Found<Totals> {
    /// Adds what two triangles have in common. The one that comes first in the order of coordinates is the
    /// first one of the computation, which is so the same for both orders of the meshes.
    #[inline]
    fn add(&mut self, a: &Triangle, b: &Triangle, area: [[i64; 2]; 2], near: &Near) {
        let is_turned = b < a;
        let (first, second) = if is_turned { (b, a) } else { (a, b) };
        let Some(piece) = common(first, second, &first[0]) else { return };
        self.pieces += 1;
        let sums = &mut self.sums;
        let add = |number: usize, figures: &_, is_added| {
            let figures: &super::piece::Figures<_> = figures;
            match is_turned {
                true => sums[number].add(&figures.swapped(), is_added),
                false => sums[number].add(figures, is_added),
            }
        };
        if near.is_plain() {
            near.divide(&piece, &first[0], add);
        } else {
            near.within(&area).divide(&piece, &first[0], add);
        }
    }
}

impl Loaded {
    /// The triangles of a block with an area on the grid.
    fn read(
        blocks: &Blocks,
        block: usize,
        vertex: impl Fn(Point) -> super::overlap::Vertex,
    ) -> Result<Loaded> {
        let mut loaded = LoadedBlock::default();
        blocks.read(block, &mut loaded)?;
        let vertices: Vec<_> = loaded.vertices().iter().map(|&stored| vertex(stored)).collect();
        let corners = loaded.corners().iter().map(|corners| corners.map(|at| vertices[usize::from(at)]));
        let triangles: Vec<Triangle> = corners.filter_map(counterclockwise).collect();
        let boxes = triangles.iter().map(bounds_of).collect();
        Ok(Loaded { triangles, boxes, cells: None })
    }

    fn bounds(&self) -> [[i64; 2]; 2] {
        let none = [[i64::MAX; 2], [i64::MIN; 2]];
        self.boxes.iter().fold(none, |[min, max], [low, high]| {
            [[0, 1].map(|axis| min[axis].min(low[axis])), [0, 1].map(|axis| max[axis].max(high[axis]))]
        })
    }

    /// Puts the triangles into cells.
    fn in_cells(mut self) -> Loaded {
        if self.boxes.is_empty() {
            return self;
        }
        let [min, max] = self.bounds();
        let side = (max[0] - min[0]).max(max[1] - min[1]) / CELLS as i64 + 1;
        let place = |at: i64, axis: usize| ((at - min[axis]) / side) as usize;
        let lists = CellLists::of(CELLS * CELLS, self.boxes.len() as u32, usize::MAX, |number, visit| {
            let [low, high] = self.boxes[number as usize];
            for row in place(low[1], 1)..=place(high[1], 1) {
                (place(low[0], 0)..=place(high[0], 0)).for_each(|column| visit(row * CELLS + column));
            }
        });
        let lists = lists.expect("fewer than 2^32 entries");
        self.cells = Some(Cells { min, side, lists });
        self
    }

    /// Calls `found` with the triangles whose boxes meet a box, and what these have in common.
    #[inline]
    fn that_meet(&self, bounds: &[[i64; 2]; 2], mut found: impl FnMut(usize, [[i64; 2]; 2])) {
        let Some(Cells { min, side, lists }) = &self.cells else { return };
        let place = |at: i64, axis: usize| (at - min[axis]).div_euclid(*side);
        let last = CELLS as i64 - 1;
        let [low, high] = bounds;
        let range = |axis: usize| place(low[axis], axis).max(0)..=place(high[axis], axis).min(last);
        for row in range(1) {
            for column in range(0) {
                for &number in lists.get(row as usize * CELLS + column as usize) {
                    let other = &self.boxes[number as usize];
                    let least = [0, 1].map(|axis| low[axis].max(other[0][axis]));
                    let most = [0, 1].map(|axis| high[axis].min(other[1][axis]));
                    // Boxes that meet in several cells are taken in the first one.
                    let is_met = least[0] < most[0] && least[1] < most[1];
                    if is_met && place(least[0], 0) == column && place(least[1], 1) == row {
                        found(number as usize, [least, most]);
                    }
                }
            }
        }
    }
}

/// A mesh and horizontal levels above a plane, which is zero unless `plane` has its elevations.
pub(super) struct Cut<'c> {
    pub(super) grid: &'c Grid,
    pub(super) surface: &'c Surface,
    pub(super) regions: &'c Regions,
    pub(super) levels: &'c [i64],
    pub(super) plane: Option<[f64; 3]>,
    pub(super) threads: usize,
}

impl Cut<'_> {
    /// What triangles add to the levels, for each region, and their number.
    pub(super) fn run(&self, progress: &mut Progress<'_>) -> Result<Found<Table>> {
        let none = || Found { sums: vec![Table::new(self.levels.len()); self.regions.count()], pieces: 0 };
        let mut all = none();
        let work = |chunk: Range<usize>| {
            let mut found = none();
            for block in chunk {
                self.add_block(block, &mut found)?;
            }
            Ok(found)
        };
        for_each_chunk(self.surface.blocks(), self.threads, progress, work, |found| {
            all.sums.iter_mut().zip(&found.sums).for_each(|(own, other)| own.merge(other));
            all.pieces += found.pieces;
        })?;
        Ok(all)
    }

    fn add_block(&self, block: usize, found: &mut Found<Table>) -> Result<()> {
        let coordinates = *self.surface.ground.coordinates();
        let vertex = |stored| raised(self.grid.vertex(0, stored), self.elevation(&coordinates, stored));
        let own = Loaded::read(self.surface.blocks(), block, vertex)?;
        let near = self.regions.near(&own.bounds());
        for (triangle, bounds) in own.triangles.iter().zip(&own.boxes) {
            found.pieces += 1;
            let near = near.within(bounds);
            if near.is_plain() {
                near.around.iter().for_each(|&number| found.sums[number].add(triangle, self.levels));
            } else {
                Table::add_near(&mut found.sums, triangle, self.levels, &near);
            }
        }
        Ok(())
    }

    /// The elevation of the plane at a vertex, in units of levels above those of the grid.
    fn elevation(&self, coordinates: &Coordinates, stored: Point) -> i64 {
        let Some([z, dx, dy]) = self.plane else { return 0 };
        let [x, y, _] = coordinates.to_world(stored);
        // The range was checked at the corners of the mesh.
        self.grid.level(z + dx * x + dy * y).unwrap_or(0)
    }
}

/// A triangle from its least corner on, which makes it the same for all orders of corners; `None` if it has
/// no area. Rounding may have turned it around.
fn counterclockwise(triangle: Triangle) -> Option<Triangle> {
    let [a, b, c] = triangle;
    let [u, v] = [b, c].map(|corner| [0, 1].map(|axis| i128::from(corner[axis] - a[axis])));
    let twice = u[0] * v[1] - u[1] * v[0];
    let [a, b, c] = if twice < 0 { [a, c, b] } else { [a, b, c] };
    let turned = if a <= b && a <= c {
        [a, b, c]
    } else if b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    };
    (twice != 0).then_some(turned)
}

fn bounds_of(triangle: &Triangle) -> [[i64; 2]; 2] {
    let [a, b, c] = triangle;
    [
        [0, 1].map(|axis| a[axis].min(b[axis]).min(c[axis])),
        [0, 1].map(|axis| a[axis].max(b[axis]).max(c[axis])),
    ]
}
