//! An inner node of a mesh in parts: the residuals of its children become one node, whose final simplices are
//! a part of their own.
//!
//! Other than [`super::merge`], it reads and writes no simplex that a child has written.

use std::io::{Read, Write};

use super::bulk::Bulk;
use super::duplicates::Duplicates;
use super::merge::{Input, Sink, boxed, check_together, region_of};
use super::node::Solver;
use super::origins::Origins;
use super::plane::Plane;
use super::residual::{Residual, UNWRITTEN, foreign_key};
use super::rules::Rules;
use super::run::{Options, begin};
use super::schedule::Output;
use super::sequencer::Outputs;
use super::space::Space;
use super::stats::Stats;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::{Event, GlobalId, Header, PatchBlocks, StreamReader};

/// Number of the only node.
const NODE: u64 = 0;

/// Triangulates the residuals of the children of a node of a mesh in parts, and writes the triangles that
/// become final in `options.part`, the box of the node, and what is left. Without an output for the residual,
/// the node is the root, where all is final. `options.name` is the name of the part, which counts all parts
/// below.
///
/// Cost and memory: those of one triangulation of the residuals.
///
/// # Errors
/// Usage, if the inputs are no residuals of the same mesh, or do not fit together; malformed, if one of them
/// is damaged; I/O, if reading or writing fails.
pub fn join_triangles<R: Read, W: Write + Send>(
    readers: Vec<StreamReader<R>>,
    mut outputs: Outputs<W>,
    options: &Options,
) -> Result<(Outputs<W>, Stats)> {
    let stats = join_plane(boxed(readers), outputs.borrowed(), options)?;
    Ok((outputs, stats))
}

/// Joins residuals in space, as [`join_triangles`] does in the plane.
///
/// # Errors
/// As [`join_triangles`].
pub fn join_tetrahedra<R: Read, W: Write + Send>(
    readers: Vec<StreamReader<R>>,
    mut outputs: Outputs<W>,
    options: &Options<3>,
) -> Result<(Outputs<W>, Stats)> {
    let stats = join_space(boxed(readers), outputs.borrowed(), options)?;
    Ok((outputs, stats))
}

// In this crate alone, as merging is.
fn join_plane(readers: Vec<StreamReader<Input>>, outputs: Outputs<Sink>, options: &Options) -> Result<Stats> {
    join::<Plane, Input, Sink, 2>(readers, outputs, options)
}

fn join_space(
    readers: Vec<StreamReader<Input>>,
    outputs: Outputs<Sink>,
    options: &Options<3>,
) -> Result<Stats> {
    join::<Space, Input, Sink, 3>(readers, outputs, options)
}

fn join<B: Bulk<D>, R: Read, W: Write, const D: usize>(
    mut readers: Vec<StreamReader<R>>,
    outputs: Outputs<W>,
    options: &Options<D>,
) -> Result<Stats> {
    let header = header_of::<B, R, D>(&readers, options)?;
    let part = options.part.map(|part| part.region(&header)).transpose()?;
    let region = part.unwrap_or(Region::EVERYTHING);
    check_boxes(&readers, &region)?;
    let rules = Rules::<D>::new(&header, Duplicates::Error, outputs.residual.is_some());
    let mut stats = Stats { inner_nodes: 1, ..Stats::default() };
    let (mut residual, mut origins) = (Residual::<D>::default(), Origins::default());
    let mut before = 0;
    for reader in &mut readers {
        origins.begin(reader.name());
        let left = read_residual(reader, before, &mut origins, &mut stats)?;
        residual.unite(vec![left]);
        before += parts_of(reader);
    }
    // Nothing is created before all inputs are known to be whole.
    let mut sequencer = begin::<B, W, D>(outputs, header, region)?;
    let points = residual.len();
    stats.inner_node_max = points as u64;
    sequencer.open(&[]);
    let mut solver = Solver::<B, D>::new(rules);
    let flush = &mut |blocks: &mut PatchBlocks| sequencer.patches(blocks);
    let solved = solver.solve(NODE, &mut residual, &region, PatchBlocks::default(), Some(flush));
    let mut solved = solved.map_err(|error| origins.locate(error, solver.misfit()))?;
    residual = std::mem::take(&mut solved.residual);
    let active = residual.active;
    sequencer.close(Output { number: NODE, points, children: Vec::new(), active, solved })?;
    stats.residual = residual.len() as u64;
    sequencer.write_residual(&[NODE], &residual)?;
    let merged = stats.merged;
    sequencer.add_to(&mut stats);
    stats.predicates = solver.counts();
    sequencer.end(stats.points, merged, 0)?;
    Ok(stats)
}

/// The header of the part, after a check that the inputs fit together.
fn header_of<B: Bulk<D>, R: Read, const D: usize>(
    readers: &[StreamReader<R>],
    options: &Options<D>,
) -> Result<Header> {
    let (Some(first), Some(name)) = (readers.first(), options.name) else {
        return Err(Error::usage("nothing to join: give the residuals of a node, and its name"));
    };
    if let Some(reader) = readers.iter().find(|reader| reader.header().kind != B::RESIDUAL) {
        return Err(Error::usage("this is no residual of a part of a mesh").of_input(reader.name()));
    }
    let below: u64 = readers.iter().map(|reader| u64::from(parts_of(reader))).sum();
    if below != u64::from(name.below) {
        let message = format!("residuals of {below} parts, expected {}", name.below);
        return Err(Error::usage(message).of_input(first.name()));
    }
    check_together::<R, D>(readers)?;
    let one = first.header();
    let mut header = Header::new(B::MESH, one.coordinates, one.dims, one.has_elevation);
    header.crs = one.crs.clone();
    header.attributes = one.attributes.clone();
    header.compressed = options.compress;
    header.part = Some(name);
    let bounds = readers.iter().filter_map(|reader| reader.header().bounds);
    header.bounds = bounds.reduce(Bounds::union);
    Ok(header)
}

/// The number of parts that a residual is of: its own, and all below.
fn parts_of<R: Read>(reader: &StreamReader<R>) -> u32 {
    reader.header().part.map_or(0, |part| part.below + 1)
}

/// Checks that the boxes of the residuals lie in that of the node. They need not fill it: the plan leaves out
/// boxes without points.
fn check_boxes<R: Read, const D: usize>(readers: &[StreamReader<R>], region: &Region<D>) -> Result<()> {
    match readers.iter().find(|reader| !region.covers(&region_of(reader.header()))) {
        None => Ok(()),
        Some(reader) => {
            Err(Error::usage("its box is not inside of that of the node").of_input(reader.name()))
        }
    }
}

/// Reads a whole residual. Its vertices are those of other streams; `before` parts are joined before those
/// that it is of.
fn read_residual<R: Read, const D: usize>(
    reader: &mut StreamReader<R>,
    before: u32,
    origins: &mut Origins,
    stats: &mut Stats,
) -> Result<Residual<D>> {
    let mut residual = Residual::<D>::default();
    while let Some(event) = reader.next_event()? {
        origins.note(&event, D, reader);
        match event {
            Event::ResidualPoints(points) => {
                let pushed = push_points(&mut residual, before, &points, reader.rows());
                pushed.map_err(|e| reader.locate(e))?;
            }
            Event::Walls(walls) => residual.walls.extend_from_slice(walls.as_chunks().0),
            Event::End(totals) => {
                stats.points += totals.points;
                stats.merged += totals.merged;
            }
            _ => unreachable!("the reader refuses these blocks in a residual"),
        }
    }
    stats.input_bytes += reader.bytes_read();
    Ok(residual)
}

fn push_points<const D: usize>(
    residual: &mut Residual<D>,
    before: u32,
    points: &[(Option<u64>, Point)],
    rows: &[u8],
) -> Result<()> {
    let row_len = rows.len().checked_div(points.len()).unwrap_or(0);
    for (i, &(id, point)) in points.iter().enumerate() {
        let key = match id {
            Some(id) => foreign_key(GlobalId(id).moved(before)?),
            None => UNWRITTEN,
        };
        residual.push(point, &rows[i * row_len..][..row_len], key);
    }
    Ok(())
}
