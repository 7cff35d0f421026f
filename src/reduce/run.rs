//! From a stream of points to a mesh stream.

use std::io::{Read, Write};

use super::arrivals::Arrivals;
use super::duplicates::Duplicates;
use super::node::{Rules, Solved};
use super::partial::Part;
use super::patches::PatchWriter;
use super::pool::Pool;
use super::residual::{Residual, UNWRITTEN};
use super::stats::Stats;
use super::tree::{Boxes, Pending};
use crate::bounds::{Bounds, Point, Region};
use crate::cells::CellCode;
use crate::error::{Error, Result};
use crate::stream::{Event, Header, Kind, StreamReader, StreamWriter};

/// Residual points and their walls are written in blocks of about this many.
const RESIDUAL_CHUNK: usize = 1 << 14;

/// How a run triangulates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Options {
    /// Which elevation survives where points coincide.
    pub duplicates: Duplicates,
    /// Threads, the calling one included; at least 1. What comes out does not depend on it.
    pub threads: usize,
    /// For a partial run, the part of the plane to triangulate.
    pub part: Option<Part>,
}

/// Triangulates a stream of two-dimensional points and writes the mesh to `output`; `progress` is told how
/// many points are read.
///
/// The result is the canonical Delaunay triangulation, whatever the order of the points, the cells and the
/// number of threads. A partial run writes the triangles that are final in its region, and the residual.
///
/// Cost: linear in the points; memory is the residuals of nodes whose parent is not complete, and the points
/// of cells that are not final.
///
/// # Errors
/// If the input is no stream of two-dimensional points, is malformed or ends too early, or writing fails. END
/// is not written then.
pub fn triangulate<R: Read, W: Write>(
    mut reader: StreamReader<R>,
    output: W,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<(W, Stats)> {
    check_input(reader.header()).map_err(|e| e.of_input(reader.name()))?;
    let part = options.part.map(|part| part.region(reader.header())).transpose()?;
    let stream = StreamWriter::new(output, mesh_header(reader.header(), part))?;
    let rules = Rules {
        coordinates: reader.header().coordinates,
        duplicates: options.duplicates,
        is_partial: part.is_some(),
    };
    std::thread::scope(|scope| {
        let pool = Pool::start(scope, options.threads.max(1), rules);
        let mut run = Run::new(reader.header(), part, pool, stream);
        while let Some(event) = reader.next_event()? {
            run.take(event).map_err(|e| reader.locate(e))?;
            progress(reader.totals().points);
        }
        run.stats.input_bytes = reader.bytes_read();
        run.finish()
    })
}

fn check_input(header: &Header) -> Result<()> {
    match (header.kind, header.dims) {
        (Kind::Points, 2) => Ok(()),
        (Kind::Points, dims) => Err(Error::usage(format!(
            "the points have {dims} dimensions: finalize them in 2 (spfinalize without --octree)"
        ))),
        (Kind::PartialTriangleMesh, _) => {
            Err(Error::usage("this is a partial triangle mesh: use --merge to finish it"))
        }
        (kind, _) => Err(Error::usage(format!("this is a stream of kind {}, expected points", kind.name()))),
    }
}

fn mesh_header(points: &Header, part: Option<Region>) -> Header {
    let kind = if part.is_some() { Kind::PartialTriangleMesh } else { Kind::TriangleMesh };
    let mut header = Header::new(kind, points.coordinates, points.dims, points.has_elevation);
    let inside =
        |bounds: &Bounds, region: &Region| region.contains(bounds.min) && region.contains(bounds.max);
    header.bounds = points.bounds.filter(|bounds| part.as_ref().is_none_or(|region| inside(bounds, region)));
    header.region = part;
    header.crs = points.crs.clone();
    header
}

/// A run under way.
struct Run<'scope, W: Write> {
    arrivals: Arrivals,
    boxes: Boxes,
    pending: Pending,
    pool: Pool<'scope>,
    patches: PatchWriter<W>,
    is_partial: bool,
    stats: Stats,
}

impl<'scope, W: Write> Run<'scope, W> {
    fn new(header: &Header, part: Option<Region>, pool: Pool<'scope>, stream: StreamWriter<W>) -> Self {
        let outer = part.unwrap_or(Region::PLANE);
        Run {
            arrivals: Arrivals::new(header.tree, outer),
            boxes: Boxes::new(header.tree, header.bounds, outer),
            pending: Pending::new(header.tree),
            pool,
            patches: PatchWriter::new(stream),
            is_partial: part.is_some(),
            stats: Stats { level: header.tree.map_or(0, |tree| u64::from(tree.depth())), ..Stats::default() },
        }
    }

    fn take(&mut self, event: Event) -> Result<()> {
        match event {
            Event::Points(points) => self.arrivals.points(&points),
            Event::Cells(cells) => cells.into_iter().try_for_each(|cell| self.take_tag(cell)),
            Event::End(_) => self.take_end(),
            Event::Patch(_) | Event::ResidualPoints(_) | Event::Walls(_) => {
                unreachable!("the reader refuses these blocks in a stream of points")
            }
        }
    }

    /// A cell is final: its points are a leaf, unless nodes inside it were finished before it.
    fn take_tag(&mut self, cell: CellCode) -> Result<()> {
        self.stats.cells += 1;
        let (mut points, is_whole) = self.arrivals.tag(cell)?;
        if !is_whole {
            self.finish_leaves(true)?;
            points.append(&self.pending.take_below(cell));
            return self.finish_inner(cell, points);
        }
        self.stats.leaves += u64::from(!points.is_empty());
        self.stats.leaf_max = self.stats.leaf_max.max(points.len() as u64);
        self.pool.submit(cell, points, self.boxes.region(cell))?;
        self.finish_leaves(false)
    }

    /// The end: everything that is left is final.
    fn take_end(&mut self) -> Result<()> {
        self.finish_leaves(true)?;
        let mut points = self.arrivals.rest();
        self.stats.untagged = points.len() as u64;
        if points.is_empty() && self.pending.is_complete() {
            return Ok(());
        }
        points.append(&self.pending.take_below(CellCode::ROOT));
        self.finish_inner(CellCode::ROOT, points)
    }

    /// Writes the leaves that are done, in their order, and the nodes that they complete.
    fn finish_leaves(&mut self, all: bool) -> Result<()> {
        while let Some((cell, solved)) = self.pool.next(all)? {
            self.finish_node(cell, solved.map_err(|e| e.at(format!("cell {}", cell.0)))?)?;
            self.climb(cell)?;
        }
        Ok(())
    }

    /// Triangulates the parents that are complete now, upwards from `cell`.
    fn climb(&mut self, mut cell: CellCode) -> Result<()> {
        while let Some(parent) = self.pending.complete_parent(cell) {
            let points = self.pending.take_below(parent);
            self.finish_node_of(parent, points)?;
            cell = parent;
        }
        Ok(())
    }

    fn finish_inner(&mut self, cell: CellCode, points: Residual) -> Result<()> {
        self.finish_node_of(cell, points)?;
        self.climb(cell)
    }

    fn finish_node_of(&mut self, cell: CellCode, points: Residual) -> Result<()> {
        self.stats.inner_nodes += u64::from(!points.is_empty());
        self.stats.inner_node_max = self.stats.inner_node_max.max(points.len() as u64);
        let solved = self.pool.solve(points, &self.boxes.region(cell));
        let solved = solved.map_err(|e| e.at(format!("cell {}", cell.0)))?;
        self.finish_node(cell, solved)
    }

    fn finish_node(&mut self, cell: CellCode, mut solved: Solved) -> Result<()> {
        self.stats.merged += solved.merged;
        self.patches.write(&mut solved)?;
        self.pending.insert(cell, solved.residual());
        Ok(())
    }

    fn finish(mut self) -> Result<(W, Stats)> {
        if self.is_partial {
            let residual = self.pending.take_below(CellCode::ROOT);
            self.stats.residual = residual.len() as u64;
            write_residual(self.patches.stream(), &residual)?;
        }
        self.stats.points = self.arrivals.accepted();
        self.stats.outside = self.arrivals.outside();
        self.stats.held_max = self.arrivals.held_max() as u64;
        self.stats.residual_max = self.pending.points_max() as u64;
        self.stats.active_max = self.pending.active_max() as u64;
        self.stats.width = self.patches.live_max();
        let stream = self.patches.into_stream();
        self.stats.vertices = stream.totals().vertices;
        self.stats.triangles = stream.totals().simplices;
        self.stats.predicates = self.pool.finish()?;
        let output = stream.end(self.stats.points, self.stats.merged)?;
        Ok((output, self.stats))
    }
}

/// Writes the residual of a partial run.
pub(super) fn write_residual<W: Write>(stream: &mut StreamWriter<W>, residual: &Residual) -> Result<()> {
    let mut chunk: Vec<(Option<u64>, Point)> = Vec::with_capacity(RESIDUAL_CHUNK);
    for first in (0..residual.len()).step_by(RESIDUAL_CHUNK) {
        let last = residual.len().min(first + RESIDUAL_CHUNK);
        let id = |i: usize| (residual.ids[i] != UNWRITTEN).then_some(residual.ids[i]);
        chunk.clear();
        chunk.extend((first..last).map(|i| (id(i), residual.point(i))));
        stream.residual_points(&chunk)?;
    }
    stream.walls(&residual.walls)
}
