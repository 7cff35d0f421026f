//! Merging partial runs: their residuals become one node.

use std::io::{Read, Write};

use super::bulk::Bulk;
use super::duplicates::Duplicates;
use super::node::Solver;
use super::origins::Origins;
use super::partial::Part;
use super::plane::Plane;
use super::residual::Residual;
use super::rules::Rules;
use super::run::Options;
use super::schedule::Output;
use super::sequencer::Sequencer;
use super::space::Space;
use super::stats::Stats;
use super::tile::Tile;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Region};
use spmesh_stream::{Crs, Event, Header, Kind, PatchBlocks, StreamReader, StreamWriter, Totals};

/// Numbers of two nodes: the residuals of all inputs, and the node that triangulates them.
const LEFT: u64 = 0;
const MERGED: u64 = 1;

/// Merges the results of partial runs over regions that do not overlap. `progress` is called with the number
/// of vertices read so far.
///
/// Of the options, `part` and `compress` count. Without a part, the regions must cover all points
/// ([`super::missing_region`] finds gaps), and the result is the whole mesh: the same set of triangles as one
/// run over all points. With a part, the result is partial again, for that region. That region must contain
/// the merged ones, and every point in it must lie in one of them.
///
/// Cost: linear in the final triangles, which are copied, and one triangulation of the residuals.
///
/// Memory: the residuals.
///
/// # Errors
/// If the inputs do not fit together (kind, coordinates, reference system, overlapping regions), or one is
/// malformed or truncated, or writing fails. END is not written then.
pub fn merge_triangles<R: Read, W: Write + Send>(
    readers: Vec<StreamReader<R>>,
    mut output: W,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<(W, Stats)> {
    let stats = merge_plane(boxed(readers), &mut output, options, &mut progress)?;
    Ok((output, stats))
}

/// Merges the results of partial runs in space, as [`merge_triangles`] does in the plane.
///
/// # Errors
/// As [`merge_triangles`].
pub fn merge_tetrahedra<R: Read, W: Write + Send>(
    readers: Vec<StreamReader<R>>,
    mut output: W,
    options: &Options<3>,
    mut progress: impl FnMut(u64),
) -> Result<(W, Stats)> {
    let stats = merge_space(boxed(readers), &mut output, options, &mut progress)?;
    Ok((output, stats))
}

/// An input of merging, and what it writes to: of one type each, so that the code is compiled in this crate
/// alone.
pub(super) type Input<'a> = Box<dyn Read + 'a>;
pub(super) type Sink<'a> = &'a mut (dyn Write + Send + 'a);

pub(super) fn boxed<'a, R: Read + 'a>(readers: Vec<StreamReader<R>>) -> Vec<StreamReader<Input<'a>>> {
    readers.into_iter().map(|reader| reader.map_input(|input| Box::new(input) as Input)).collect()
}

fn merge_plane(
    readers: Vec<StreamReader<Input>>,
    output: Sink,
    options: &Options,
    progress: &mut dyn FnMut(u64),
) -> Result<Stats> {
    merge::<Plane, Input, Sink, 2>(readers, output, options, progress)
}

fn merge_space(
    readers: Vec<StreamReader<Input>>,
    output: Sink,
    options: &Options<3>,
    progress: &mut dyn FnMut(u64),
) -> Result<Stats> {
    merge::<Space, Input, Sink, 3>(readers, output, options, progress)
}

fn merge<B: Bulk<D>, R: Read, W: Write, const D: usize>(
    mut readers: Vec<StreamReader<R>>,
    output: W,
    options: &Options<D>,
    mut progress: impl FnMut(u64),
) -> Result<Stats> {
    let (part, compressed) = (options.part, options.compress);
    let header = Header { compressed, ..merged_header::<B, R, D>(&readers, part)? };
    let region = region_of(&header);
    let rules = Rules::<D>::new(&header, Duplicates::Error, part.is_some());
    let mut sequencer = Sequencer::new(StreamWriter::new(output, header)?, None);
    let mut stats = Stats { inner_nodes: 1, ..Stats::default() };
    let mut residual = Residual::<D>::default();
    let mut origins = Origins::default();
    for reader in &mut readers {
        origins.begin(reader.name());
        let note = &mut |event: &Event, reader: &StreamReader<R>| origins.note(event, D, reader);
        copy_through(reader, &mut sequencer, &mut residual, &mut stats, note, &mut progress)?;
    }
    let points = residual.len();
    stats.inner_node_max = points as u64;
    sequencer.leave(LEFT, residual.keys.clone(), 0);
    sequencer.open(&[LEFT]);
    let mut solver = Solver::<B, D>::new(rules);
    let flush = &mut |blocks: &mut PatchBlocks| sequencer.patches(blocks);
    let solved = solver.solve(MERGED, &mut residual, &region, PatchBlocks::default(), Some(flush));
    let mut solved = solved.map_err(|error| origins.locate(error, solver.misfit()))?;
    residual = std::mem::take(&mut solved.residual);
    let active = residual.active;
    sequencer.close(Output { number: MERGED, points, children: Vec::new(), active, solved })?;
    if part.is_some() {
        stats.residual = residual.len() as u64;
        sequencer.write_residual(&[MERGED], &residual)?;
    }
    sequencer.add_to(&mut stats);
    stats.predicates = solver.counts();
    sequencer.end(stats.points, stats.merged, stats.merged)?;
    Ok(stats)
}

/// Header of the result, after a check that the inputs fit together.
fn merged_header<B: Bulk<D>, R: Read, const D: usize>(
    readers: &[StreamReader<R>],
    part: Option<Part<D>>,
) -> Result<Header> {
    let Some(first) = readers.first() else {
        return Err(Error::usage("nothing to merge: give partial results"));
    };
    readers.iter().try_for_each(|reader| check_kind::<B, R, D>(reader))?;
    check_together::<R, D>(readers)?;
    let one = first.header();
    let kind = if part.is_some() { B::PARTIAL_MESH } else { B::MESH };
    let mut header = Header::new(kind, one.coordinates, one.dims, one.has_elevation);
    header.crs = one.crs.clone();
    header.attributes = one.attributes.clone();
    let outer = part.map(|part| part.region(one)).transpose()?;
    header.region = outer.map(|outer| outer.in_space());
    let bounds: Option<Vec<Bounds>> = readers.iter().map(|reader| reader.header().bounds).collect();
    header.bounds = bounds.and_then(|all| all.into_iter().reduce(Bounds::union));
    if let Some(outer) = outer
        && let Some(reader) = readers.iter().find(|reader| !outer.covers(&region_of(reader.header())))
    {
        return Err(Error::usage(format!("the region of {} is not inside of the given one", reader.name())));
    }
    Ok(header)
}

fn check_kind<B: Bulk<D>, R: Read, const D: usize>(reader: &StreamReader<R>) -> Result<()> {
    let kind = reader.header().kind;
    let remedy = match kind {
        kind if kind == B::PARTIAL_MESH => return Ok(()),
        Kind::PartialTriangleMesh => "merge it with spdelaunay2d",
        Kind::PartialTetrahedralMesh => "merge it with spdelaunay3d",
        _ => "--merge takes results of --partial",
    };
    let message = format!("this is a stream of kind {}: {remedy}", kind.name());
    Err(Error::usage(message).of_input(reader.name()))
}

/// Checks that parts have one grid and one reference system, and that their regions do not overlap.
pub(super) fn check_together<R: Read, const D: usize>(readers: &[StreamReader<R>]) -> Result<()> {
    for (i, reader) in readers.iter().enumerate() {
        check_pair(&readers[0], reader)?;
        for other in &readers[..i] {
            check_regions::<R, D>(other, reader)?;
        }
    }
    Ok(())
}

fn check_pair<R: Read>(first: &StreamReader<R>, reader: &StreamReader<R>) -> Result<()> {
    let (a, b) = (first.header(), reader.header());
    let differs = |what: &str, remedy: &str| {
        Err(Error::usage(format!("{} and {} differ in {what}{remedy}", first.name(), reader.name())))
    };
    if a.coordinates != b.coordinates || a.has_elevation != b.has_elevation {
        return differs("their coordinate grid", ": finalize both with the same --scale and --offset");
    }
    if a.attributes != b.attributes {
        return differs("their attributes", ": finalize both with the same --attributes");
    }
    let found = if a.crs == b.crs { Vec::new() } else { differences(&a.crs, &b.crs) };
    if !found.is_empty() {
        let what = format!("their coordinate reference system ({})", found.join("; "));
        return differs(&what, ": finalize both with --crs");
    }
    Ok(())
}

/// In what two reference systems differ that are not stated in the same words.
#[cfg(feature = "files")]
fn differences(a: &Crs, b: &Crs) -> Vec<String> {
    use spmesh_formats::crs::{System, differences};
    differences(&System::of(a), &System::of(b))
}

/// Without a reader of systems, only the same words mean the same.
#[cfg(not(feature = "files"))]
fn differences(_: &Crs, _: &Crs) -> Vec<String> {
    vec!["their definitions".to_string()]
}

fn check_regions<R: Read, const D: usize>(a: &StreamReader<R>, b: &StreamReader<R>) -> Result<()> {
    if region_of::<D>(a.header()).overlaps(&region_of(b.header())) {
        return Err(Error::usage(format!("the regions of {} and {} overlap", a.name(), b.name())));
    }
    Ok(())
}

/// The region of a partial mesh; everything for a whole mesh.
pub(super) fn region_of<const D: usize>(header: &Header) -> Region<D> {
    header.region.map_or(Region::EVERYTHING, |region| Region::between(region.min, region.max))
}

/// Copies the final simplices of one input, and adds its residual to `residual`. Calls `note` with each
/// event.
fn copy_through<R: Read, W: Write, const D: usize>(
    reader: &mut StreamReader<R>,
    sequencer: &mut Sequencer<W>,
    residual: &mut Residual<D>,
    stats: &mut Stats,
    note: &mut impl FnMut(&Event, &StreamReader<R>),
    progress: &mut impl FnMut(u64),
) -> Result<()> {
    let mut tile = Tile::<D>::new(region_of(reader.header()), sequencer.vertices());
    while let Some(event) = reader.next_event()? {
        note(&event, reader);
        let taken = match event {
            Event::Patch(patch) => {
                tile.patch(patch).and_then(|patch| sequencer.forward(&patch, reader.rows()))
            }
            Event::ResidualPoints(points) => tile.residual_points(&points, reader.rows()),
            Event::Walls(walls) => {
                tile.walls(&walls);
                Ok(())
            }
            Event::End(totals) => tile.check_end().and_then(|()| add_totals(stats, &totals)),
            _ => unreachable!("the reader refuses these blocks in a partial mesh"),
        };
        taken.map_err(|e| reader.locate(e))?;
        progress(sequencer.vertices());
    }
    stats.input_bytes += reader.bytes_read();
    residual.unite(vec![tile.into_residual()]);
    Ok(())
}

fn add_totals(stats: &mut Stats, totals: &Totals) -> Result<()> {
    let sum = |a: u64, b: u64| a.checked_add(b).ok_or_else(|| Error::malformed("END: totals beyond 64 bits"));
    stats.points = sum(stats.points, totals.points)?;
    stats.merged = sum(stats.merged, totals.merged)?;
    Ok(())
}
