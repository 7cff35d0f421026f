//! Finishes what partial runs left: their residuals become one node.

use std::io::{Read, Write};

use super::duplicates::Duplicates;
use super::node::{Rules, Solver};
use super::partial::Part;
use super::plane::Plane;
use super::residual::{Residual, UNWRITTEN};
use super::schedule::Output;
use super::sequencer::Sequencer;
use super::stats::Stats;
use crate::bounds::{Bounds, Point, Region};
use crate::error::{Error, Result};
use crate::stream::{
    Event, Header, Kind, LiveVertices, Patch, PatchBlocks, StreamReader, StreamWriter, Totals,
};

/// Numbers of two nodes: all that the inputs have left, and what is made of it.
const LEFT: u64 = 0;
const MERGED: u64 = 1;

/// Merges the results of partial runs over regions that do not overlap; `progress` is told how many vertices
/// are read. Without `part`, the regions must cover all points, and the result is the whole mesh: the set of
/// triangles that one run over all points gives. With it, the result is partial again, for the region `part`,
/// which must contain the merged ones, and all points in it must lie in one of them.
///
/// Cost: final triangles are copied through; memory is the residuals.
///
/// # Errors
/// If the inputs do not go together (kind, coordinates, reference system, overlapping regions), or one is
/// malformed or ends too early, or writing fails. END is not written then.
pub fn merge<R: Read, W: Write>(
    mut readers: Vec<StreamReader<R>>,
    output: W,
    part: Option<Part>,
    mut progress: impl FnMut(u64),
) -> Result<(W, Stats)> {
    let header = merged_header(&readers, part)?;
    let region = header.region.unwrap_or(Region::PLANE);
    let rules = Rules::new(&header, Duplicates::Error, part.is_some());
    let mut sequencer = Sequencer::new(StreamWriter::new(output, header)?);
    let mut stats = Stats { inner_nodes: 1, ..Stats::default() };
    let mut residual = Residual::<2>::default();
    for reader in &mut readers {
        copy_through(reader, &mut sequencer, &mut residual, &mut stats, &mut progress)?;
    }
    let points = residual.len();
    stats.inner_node_max = points as u64;
    sequencer.leave(LEFT, residual.keys.clone(), 0);
    let mut solver = Solver::<Plane, 2>::new(rules);
    let mut solved = solver.solve(MERGED, &mut residual, &region, PatchBlocks::default(), &mut |_| Ok(()))?;
    residual = std::mem::take(&mut solved.residual);
    let active = residual.active;
    sequencer.write(Output { number: MERGED, points, children: vec![LEFT], active, solved })?;
    if part.is_some() {
        stats.residual = residual.len() as u64;
        sequencer.write_residual(&[MERGED], &residual)?;
    }
    sequencer.add_to(&mut stats);
    stats.predicates = *solver.counts();
    let output = sequencer.end(stats.points, stats.merged)?;
    Ok((output, stats))
}

/// Header of the result, after checking that the inputs go together.
fn merged_header<R: Read>(readers: &[StreamReader<R>], part: Option<Part>) -> Result<Header> {
    let Some(first) = readers.first() else {
        return Err(Error::usage("nothing to merge: give partial results"));
    };
    for (i, reader) in readers.iter().enumerate() {
        check_pair(first, reader)?;
        for other in &readers[..i] {
            check_regions(other, reader)?;
        }
    }
    let one = first.header();
    let kind = if part.is_some() { Kind::PartialTriangleMesh } else { Kind::TriangleMesh };
    let mut header = Header::new(kind, one.coordinates, one.dims, one.has_elevation);
    header.crs = one.crs.clone();
    header.region = part.map(|part| part.region(one)).transpose()?;
    let bounds: Option<Vec<Bounds>> = readers.iter().map(|reader| reader.header().bounds).collect();
    header.bounds = bounds.and_then(|all| all.into_iter().reduce(Bounds::union));
    if let Some(outer) = &header.region
        && let Some(reader) = readers.iter().find(|reader| !covers(outer, &region_of(reader)))
    {
        return Err(Error::usage(format!("the region of {} is not inside of the given one", reader.name())));
    }
    Ok(header)
}

fn check_pair<R: Read>(first: &StreamReader<R>, reader: &StreamReader<R>) -> Result<()> {
    let (a, b) = (first.header(), reader.header());
    if b.kind != Kind::PartialTriangleMesh {
        return Err(Error::usage(format!(
            "this is a stream of kind {}, --merge takes results of --partial",
            b.kind.name()
        ))
        .of_input(reader.name()));
    }
    let differs = |what: &str, remedy: &str| {
        Err(Error::usage(format!("{} and {} differ in {what}{remedy}", first.name(), reader.name())))
    };
    if a.coordinates != b.coordinates || a.has_elevation != b.has_elevation {
        return differs("their coordinate grid", ": finalize both with the same --scale and --offset");
    }
    if a.crs != b.crs {
        return differs("their coordinate reference system", "");
    }
    Ok(())
}

fn check_regions<R: Read>(a: &StreamReader<R>, b: &StreamReader<R>) -> Result<()> {
    if region_of(a).overlaps(&region_of(b)) {
        return Err(Error::usage(format!("the regions of {} and {} overlap", a.name(), b.name())));
    }
    Ok(())
}

fn region_of<R: Read>(reader: &StreamReader<R>) -> Region {
    reader.header().region.unwrap_or(Region::PLANE)
}

fn covers(outer: &Region, inner: &Region) -> bool {
    (0..2).all(|axis| outer.min[axis] <= inner.min[axis] && inner.max[axis] <= outer.max[axis])
}

/// Copies the final triangles of one input and adds its residual to that of all.
fn copy_through<R: Read, W: Write>(
    reader: &mut StreamReader<R>,
    sequencer: &mut Sequencer<W>,
    residual: &mut Residual<2>,
    stats: &mut Stats,
    progress: &mut impl FnMut(u64),
) -> Result<()> {
    let region = region_of(reader);
    let id_offset = sequencer.vertices();
    let mut part = Residual::default();
    let mut live = LiveVertices::<Point>::new();
    while let Some(event) = reader.next_event()? {
        let taken = match event {
            Event::Patch(patch) => live
                .enter(&patch, |_, point| point)
                .map(drop)
                .and_then(|()| sequencer.forward(&renumbered(patch, id_offset))),
            Event::ResidualPoints(points) => points
                .iter()
                .try_for_each(|&(id, point)| take_point(&mut part, id, point, &mut live, &region, id_offset)),
            Event::Walls(walls) => {
                part.walls.extend(walls);
                Ok(())
            }
            Event::End(totals) => add_totals(stats, &totals).and_then(|()| all_retired(&live)),
            _ => {
                unreachable!("the reader refuses these blocks in a partial mesh")
            }
        };
        taken.map_err(|e| reader.locate(e))?;
        progress(sequencer.vertices());
    }
    stats.input_bytes += reader.bytes_read();
    residual.unite(vec![part]);
    Ok(())
}

fn add_totals(stats: &mut Stats, totals: &Totals) -> Result<()> {
    let sum = |a: u64, b: u64| a.checked_add(b).ok_or_else(|| Error::malformed("END: totals beyond 64 bits"));
    stats.points = sum(stats.points, totals.points)?;
    stats.merged = sum(stats.merged, totals.merged)?;
    Ok(())
}

fn renumbered(mut patch: Patch, id_offset: u64) -> Patch {
    patch.first_id += id_offset;
    patch.imported.iter_mut().for_each(|id| *id += id_offset);
    patch
}

fn take_point(
    part: &mut Residual<2>,
    id: Option<u64>,
    point: Point,
    live: &mut LiveVertices<Point>,
    region: &Region,
    id_offset: u64,
) -> Result<()> {
    if !region.contains(point) {
        return Err(Error::malformed(format!(
            "residual point {point:?} lies outside of the stream's region"
        )));
    }
    if let Some(id) = id
        && live.retire(id)? != point
    {
        return Err(Error::malformed(format!("residual point {point:?} is not where vertex {id} is")));
    }
    part.push(point, id.map_or(UNWRITTEN, |id| id + id_offset));
    Ok(())
}

/// Every vertex that is not finalized must be in the residual, or it would be lost.
fn all_retired(live: &LiveVertices<Point>) -> Result<()> {
    if live.is_empty() {
        return Ok(());
    }
    Err(Error::malformed(format!("{} vertices are neither finalized nor in the residual", live.len())))
}
