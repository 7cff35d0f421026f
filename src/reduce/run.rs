//! From a stream of points to a mesh stream.

use std::io::{Read, Write};

use super::boxes::Boxes;
use super::crew;
use super::duplicates::Duplicates;
use super::intake::{Arrival, Ended, Intake};
use super::node::Rules;
use super::partial::Part;
use super::plan::Plan;
use super::residual::{Residual, union};
use super::schedule::Schedule;
use super::sequencer::Sequencer;
use super::stats::Stats;
use super::worker::Worker;
use crate::bounds::{Bounds, Region};
use crate::cells::CellCode;
use crate::error::{Error, ErrorKind, Result};
use crate::predicates::PredicateCounts;
use crate::stream::{Header, Kind, PatchBlocks, StreamReader, StreamWriter};

/// How a run triangulates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Options {
    /// Which elevation survives where points coincide.
    pub duplicates: Duplicates,
    /// Threads that triangulate. With one, everything happens on the calling thread; with more, reading and
    /// writing have threads of their own. What comes out does not depend on it.
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
/// With several threads, the input belongs to a thread that ends with it or with the next block after a failure:
/// a failure does not wait for an input that says nothing.
///
/// Cost: linear in the points; memory is the residuals of nodes whose parent is not complete, and the points
/// of cells that are not final.
///
/// # Errors
/// If the input is no stream of two-dimensional points, is malformed or ends too early, or writing fails. END
/// is not written then.
pub fn triangulate<R, W>(
    reader: StreamReader<R>,
    output: W,
    options: &Options,
    progress: impl FnMut(u64),
) -> Result<(W, Stats)>
where
    R: Read + Send + 'static,
    W: Write + Send,
{
    check_input(reader.header()).map_err(|e| e.of_input(reader.name()))?;
    let part = options.part.map(|part| part.region(reader.header())).transpose()?;
    let header = reader.header();
    let stream = StreamWriter::new(output, mesh_header(header, part))?;
    let rules = Rules::new(stream.header(), options.duplicates, part.is_some());
    let (tree, bounds, outer) = (header.tree, header.bounds, part.unwrap_or(Region::PLANE));
    let run = Run {
        name: reader.name().to_string(),
        level: tree.map_or(0, |tree| u64::from(tree.depth())),
        rules,
        schedule: Schedule::new(Plan::new(tree), Boxes::new(tree, bounds, outer)),
    };
    let (intake, sequencer) = (Intake::new(reader, outer), Sequencer::new(stream));
    if options.threads <= 1 {
        run.alone(intake, sequencer, progress)
    } else {
        crew::run(run, intake, sequencer, options.threads, progress)
    }
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

/// A run under way, but for its two ends.
pub(super) struct Run {
    /// What messages call the input.
    name: String,
    /// Levels of the input's tree.
    level: u64,
    pub(super) rules: Rules,
    pub(super) schedule: Schedule,
}

impl Run {
    /// Does everything on the calling thread.
    fn alone<R: Read, W: Write>(
        mut self,
        mut intake: Intake<R>,
        mut sequencer: Sequencer<W>,
        mut progress: impl FnMut(u64),
    ) -> Result<(W, Stats)> {
        let mut worker = Worker::new(self.rules);
        let (mut fresh, mut blocks) = (Residual::default(), PatchBlocks::default());
        let ended = loop {
            let arrival = intake.next(|| std::mem::take(&mut fresh))?;
            let ended = self.take(arrival, &mut progress);
            loop {
                while let Some(output) = self.schedule.next_output() {
                    blocks = sequencer.write(output)?;
                }
                let Some(job) = self.schedule.next_job() else { break };
                let (number, cell) = (job.number, job.cell);
                let solved = worker.solve(job, std::mem::take(&mut blocks), |points| fresh = points);
                self.schedule.solved(number, solved.map_err(|e| self.locate(e, cell))?);
            }
            if let Some(ended) = ended {
                break ended;
            }
        };
        self.finish(&ended, sequencer, worker.counts())
    }

    /// Takes what arrived; what was known at the end, if that is it.
    pub(super) fn take(&mut self, arrival: Arrival, mut progress: impl FnMut(u64)) -> Option<Box<Ended>> {
        match arrival {
            Arrival::Read(points) => progress(points),
            Arrival::Cell { cell, points, is_whole } => self.schedule.cell(cell, points, is_whole),
            Arrival::End(mut ended) => {
                self.schedule.rest(std::mem::take(&mut ended.rest));
                return Some(ended);
            }
        }
        None
    }

    /// Adds input and cell to an error about points. Others stay as they are.
    pub(super) fn locate(&self, error: Error, cell: CellCode) -> Error {
        if error.kind() == ErrorKind::Malformed {
            error.at(format!("cell {}", cell.0)).of_input(&self.name)
        } else {
            error
        }
    }

    /// Writes what is behind the patches, when all of them are written.
    pub(super) fn finish<W: Write>(
        self,
        ended: &Ended,
        mut sequencer: Sequencer<W>,
        counts: &PredicateCounts,
    ) -> Result<(W, Stats)> {
        let is_partial = self.rules.is_partial;
        let (numbers, residuals, mut stats) = self.schedule.into_residual();
        if is_partial {
            let residual = union(&residuals);
            stats.residual = residual.len() as u64;
            sequencer.write_residual(&numbers, &residual)?;
        }
        sequencer.add_to(&mut stats);
        stats.level = self.level;
        stats.points = ended.accepted;
        stats.outside = ended.outside;
        stats.held_max = ended.held_max as u64;
        stats.cells = ended.cells;
        stats.input_bytes = ended.input_bytes;
        stats.predicates = *counts;
        let output = sequencer.end(stats.points, stats.merged)?;
        Ok((output, stats))
    }
}
