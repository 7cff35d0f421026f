//! From a stream of points to a mesh stream.

use std::io::{Read, Write};
use std::num::NonZeroUsize;

use super::boxes::Boxes;
use super::budget::Budget;
use super::bulk::Bulk;
use super::coordinator;
use super::duplicates::Duplicates;
use super::merging::Merging;
use super::partial::Part;
use super::plan::Plan;
use super::plane::Plane;
use super::reader::CellReader;
use super::regions;
use super::residual::Residual;
use super::rules::Rules;
use super::run_state::Run;
use super::schedule::Schedule;
use super::sequencer::{Outputs, Sequencer};
use super::sides::Sides;
use super::space::Space;
use super::stats::Stats;
use super::worker::Worker;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::{Coordinates, Header, Kind, PartName, PatchBlocks, StreamReader, StreamWriter};

/// How a run triangulates. Fields will be added: end the expression with `..Options::default()`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Options<const D: usize = 2> {
    /// Which elevation survives where points coincide.
    pub duplicates: Duplicates,
    /// Threads that triangulate. With one, everything happens on the calling thread; with more, reading and
    /// writing have threads of their own. The output does not depend on it.
    pub threads: usize,
    /// For a partial run, the part of the plane or of space to triangulate.
    pub part: Option<Part<D>>,
    /// For a part of a mesh in parts, its name.
    pub name: Option<PartName>,
    /// Whether every node is triangulated, including those in space that would leave most of their points to
    /// the node above. The set of simplices does not depend on it.
    pub every_node: bool,
    /// Limit of the process's memory, in bytes: the run fails rather than exceed it.
    pub memory: Option<u64>,
    /// Whether the blocks of the mesh are compressed.
    pub compress: bool,
    /// Whether points are weighted by their attribute `weight`: the mesh is then the regular
    /// tetrahedralization.
    pub weighted: bool,
}

/// Triangulates a stream of two-dimensional points and writes the mesh to `output`. `progress` is called with
/// the number of points read so far.
///
/// The result is the canonical Delaunay triangulation, whatever the order of the points, the cells and the
/// number of threads. A partial run writes the triangles that are final in its region, and the residual.
///
/// With several threads, a thread owns the input. It ends with the input, or with the next block after a
/// failure: a failure does not wait for an input that stays silent.
///
/// Cost: linear in the points.
///
/// Memory: the residuals of nodes whose parent is not complete, and the points of cells that are not final.
///
/// # Errors
/// If the input is not a stream of two-dimensional points, is malformed or truncated, or writing fails;
/// [`spmesh_base::error::ErrorKind::Memory`] if more memory is needed than `options.memory`. END is not
/// written then.
pub fn triangulate<R, W>(
    reader: StreamReader<R>,
    output: W,
    options: &Options,
    progress: impl FnMut(u64) + Send,
) -> Result<(W, Stats)>
where
    R: Read + Send + 'static,
    W: Write + Send,
{
    let outputs = Outputs { mesh: output, residual: None };
    let (outputs, stats) = triangulate_part(reader, outputs, options, progress)?;
    Ok((outputs.mesh, stats))
}

/// Tetrahedralizes a stream of three-dimensional points and writes the mesh to `output`, as [`triangulate`]
/// does in the plane. Coinciding points are one vertex, or an error if `options.duplicates` is
/// [`Duplicates::Error`]: there are no elevations to choose from.
///
/// # Errors
/// As [`triangulate`].
///
/// Source: thesis 5.4.
pub fn tetrahedralize<R, W>(
    reader: StreamReader<R>,
    output: W,
    options: &Options<3>,
    progress: impl FnMut(u64) + Send,
) -> Result<(W, Stats)>
where
    R: Read + Send + 'static,
    W: Write + Send,
{
    let outputs = Outputs { mesh: output, residual: None };
    let (outputs, stats) = tetrahedralize_part(reader, outputs, options, progress)?;
    Ok((outputs.mesh, stats))
}

/// Triangulates a part of a mesh in parts: the points of `options.part`. Writes the triangles that are final
/// there, and the residual, which [`super::join_triangles`] triangulates with those of other parts.
/// `options.name` is the name of the part. Without an output for the residual, the part is the whole mesh.
///
/// # Errors
/// As [`triangulate`].
pub fn triangulate_part<R, W>(
    reader: StreamReader<R>,
    mut outputs: Outputs<W>,
    options: &Options,
    mut progress: impl FnMut(u64) + Send,
) -> Result<(Outputs<W>, Stats)>
where
    R: Read + Send + 'static,
    W: Write + Send,
{
    let stats = reduce_plane(boxed(reader), outputs.borrowed(), options, &mut progress)?;
    Ok((outputs, stats))
}

/// Tetrahedralizes a part of a mesh in parts, as [`triangulate_part`] does in the plane.
///
/// # Errors
/// As [`triangulate`].
pub fn tetrahedralize_part<R, W>(
    reader: StreamReader<R>,
    mut outputs: Outputs<W>,
    options: &Options<3>,
    mut progress: impl FnMut(u64) + Send,
) -> Result<(Outputs<W>, Stats)>
where
    R: Read + Send + 'static,
    W: Write + Send,
{
    let stats = reduce_space(boxed(reader), outputs.borrowed(), options, &mut progress)?;
    Ok((outputs, stats))
}

/// The input of a run, and what it writes to: of one type each, so that all of the code below is compiled
/// once, in this crate, and not in each crate that calls it.
pub(super) type Input = Box<dyn Read + Send>;
type Sink<'a> = &'a mut (dyn Write + Send + 'a);

fn boxed<R: Read + Send + 'static>(reader: StreamReader<R>) -> StreamReader<Input> {
    reader.map_input(|input| Box::new(input) as Input)
}

/// Reduces points of the plane to a mesh.
fn reduce_plane(
    reader: StreamReader<Input>,
    outputs: Outputs<Sink>,
    options: &Options,
    progress: &mut (dyn FnMut(u64) + Send),
) -> Result<Stats> {
    Ok(reduce::<Plane, Input, Sink, 2>(reader, outputs, options, progress)?.1)
}

/// Reduces points of space to a mesh.
fn reduce_space(
    reader: StreamReader<Input>,
    outputs: Outputs<Sink>,
    options: &Options<3>,
    progress: &mut (dyn FnMut(u64) + Send),
) -> Result<Stats> {
    if reader.header().kind == Kind::RegionPoints {
        return regions::reduce(reader, outputs, options, progress);
    }
    Ok(reduce::<Space, Input, Sink, 3>(reader, outputs, options, progress)?.1)
}

/// Reduces points to a mesh.
fn reduce<B, R, W, const D: usize>(
    reader: StreamReader<R>,
    outputs: Outputs<W>,
    options: &Options<D>,
    progress: impl FnMut(u64) + Send,
) -> Result<(Outputs<W>, Stats)>
where
    B: Bulk<D>,
    R: Read + Send + 'static,
    W: Write + Send,
{
    let header = reader.header();
    check_input::<B, D>(header).map_err(|e| e.of_input(reader.name()))?;
    check_weights(header, options)?;
    let part = options.part.map(|part| part.region(header)).transpose()?;
    let outer = part.unwrap_or(Region::EVERYTHING);
    let mesh = Header {
        compressed: options.compress,
        weighted: header.weighted.filter(|_| options.weighted),
        ..mesh_header::<B, D>(header, part, options.name)
    };
    let leaves = options.part.is_some() && (options.name.is_none() || outputs.residual.is_some());
    let sequencer = begin::<B, W, D>(outputs, mesh, outer)?;
    let mut rules = Rules::new(sequencer.header(), options.duplicates, leaves);
    rules.every_node = options.every_node;
    // The parts of other runs may reach beyond the box of this input.
    if let (Some(bounds), None) = (header.bounds, part) {
        rules.sides = Sides::of(bounds);
    }
    let budget = Budget::new::<B, D>(options.memory, options.threads, header.attributes.row_len());
    // Neither with weights nor in a partial run has the root more than one thread.
    rules.holds_surfaces = !leaves && rules.weights.is_none() && budget.holds(header.points);
    rules.points = header.points;
    let (tree, bounds) = (header.tree, header.bounds);
    let run = Run {
        name: reader.name().to_string(),
        level: tree.map_or(0, |tree| u64::from(tree.depth())),
        rules,
        schedule: Schedule::new(Plan::new(tree), Boxes::new(tree, bounds, outer)),
        budget,
        threads: NonZeroUsize::new(options.threads).unwrap_or(NonZeroUsize::MIN),
    };
    let merging = Merging::new(options.duplicates, header.coordinates, rules.weights);
    let cells = CellReader::new(reader, outer, merging);
    if options.threads <= 1 {
        alone::<B, R, W, D>(run, cells, sequencer, progress)
    } else {
        coordinator::run::<B, R, W, D>(run, cells, sequencer, options.threads, progress)
    }
}

/// Checks that the input is points of D dimensions.
fn check_input<B: Bulk<D>, const D: usize>(header: &Header) -> Result<()> {
    let remedy = if D == 2 { "without --octree" } else { "with --octree" };
    match (header.kind, header.dims) {
        (Kind::Points, dims) if usize::from(dims) == D => Ok(()),
        (Kind::Points, dims) => Err(Error::usage(format!(
            "the points have {dims} dimensions: finalize them in {D} (spfinalize {remedy})"
        ))),
        (kind, _) if kind == B::PARTIAL_MESH => {
            Err(Error::usage(format!("this is a {}: use --merge to finish it", kind.name())))
        }
        (kind, _) => Err(Error::usage(format!("this is a stream of kind {}, expected points", kind.name()))),
    }
}

/// Checks that there are weights, if they are wanted.
pub(super) fn check_weights<const D: usize>(header: &Header, options: &Options<D>) -> Result<()> {
    if !options.weighted {
        return Ok(());
    }
    if options.part.is_some() {
        return Err(Error::usage("--weights does not go with --partial: a part has no weights"));
    }
    match header.weighted {
        Some(_) => Ok(()),
        None => Err(Error::usage(
            "the points have no weights: finalize them with spfinalize --octree --radii or --weights",
        )),
    }
}

/// Writes the headers of the mesh, and of the residual of `region` if it has an output of its own.
pub(super) fn begin<B: Bulk<D>, W: Write, const D: usize>(
    outputs: Outputs<W>,
    mesh: Header,
    region: Region<D>,
) -> Result<Sequencer<W>> {
    // Residuals cross the network, and are small beside what is triangulated meanwhile.
    let left =
        Header { kind: B::RESIDUAL, region: Some(region.in_space()), compressed: true, ..mesh.clone() };
    let residual = outputs.residual.map(|output| StreamWriter::new(output, left)).transpose()?;
    Ok(Sequencer::new(StreamWriter::new(outputs.mesh, mesh)?, residual))
}

pub(super) fn mesh_header<B: Bulk<D>, const D: usize>(
    points: &Header,
    part: Option<Region<D>>,
    name: Option<PartName>,
) -> Header {
    let is_partial = part.is_some() && name.is_none();
    let kind = if is_partial { B::PARTIAL_MESH } else { B::MESH };
    let mut header = Header::new(kind, points.coordinates, points.dims, points.has_elevation);
    let are_whole = matches!(points.coordinates, Coordinates::I32 { .. });
    let outer = part.unwrap_or(Region::EVERYTHING);
    header.bounds = points.bounds.and_then(|bounds| bounds.within(&outer, are_whole));
    // Readers of an empty mesh need not ask for what its points would have.
    header.points = points.points.filter(|&count| count == 0 && part.is_none());
    header.region = part.filter(|_| is_partial).map(|region| region.in_space());
    header.part = name;
    header.crs = points.crs.clone();
    header.attributes = points.attributes.clone();
    header
}

/// Does everything on the calling thread.
fn alone<B: Bulk<D>, R: Read, W: Write + Send, const D: usize>(
    mut run: Run<D>,
    mut cells: CellReader<R, D>,
    mut sequencer: Sequencer<W>,
    mut progress: impl FnMut(u64) + Send,
) -> Result<(Outputs<W>, Stats)> {
    let mut worker = Worker::<B, D>::new(run.rules);
    let (mut fresh, mut blocks) = (Residual::default(), PatchBlocks::default());
    let ended = loop {
        let piece = cells.next(|| std::mem::take(&mut fresh))?;
        let ended = run.take(piece, &mut progress)?;
        loop {
            while let Some(output) = run.schedule.next_output() {
                blocks = sequencer.write(output)?;
            }
            let Some(job) = run.next_job()? else { break };
            let (number, cell) = (job.number, job.cell);
            let solved = worker.solve(job, std::mem::take(&mut blocks), |points| fresh = points, None);
            run.schedule.solved(number, solved.map_err(|e| run.locate(e, cell))?);
        }
        if let Some(ended) = ended {
            break ended;
        }
    };
    run.finish(&ended, sequencer, worker, &PredicateCounts::default())
}
