//! A whole run: count the points, plan the leaves, write points and tags.

use std::io::Write;
use std::time::{Duration, Instant};

use super::added::{AddedPoints, WithAdded};
use super::count_pass::PointCounts;
use super::options::{Options, Order};
use super::passes::{Observer, Pass, Passes};
use super::plan::Plan;
use super::thin::{Thin, Thinned};
use super::work::Work;
use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::Description;
use spmesh_stream::{Header, Kind, StreamWriter};

/// Figures of a run: the columns of table 5.1 of the thesis, and more.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stats {
    /// Points written.
    pub points: u64,
    /// Points dropped because a coordinate is not finite.
    pub invalid: u64,
    /// Points dropped because their cell keeps another.
    pub thinned: u64,
    /// Every pass over the input with its time, in order.
    pub passes: Vec<(&'static str, Duration)>,
    /// Level of the deepest leaf.
    pub level: u8,
    /// Leaves: occupied cells that are tagged.
    pub occupied_cells: u64,
    /// Maximal empty cells, tagged at the start.
    pub empty_cells: u64,
    /// Points in the fullest leaf.
    pub cell_points_max: u64,
    /// High-water mark of points that wait for their cell, in memory and on disk.
    pub buffered_points_max: u64,
    /// High-water mark of the memory of waiting points, in bytes.
    pub buffered_bytes_max: u64,
    /// Points that waited on disk.
    pub spilled_points: u64,
    /// Those of them that did although there was memory, because their cell had got no points for long.
    pub cold_points: u64,
    /// Bytes of the temporary file for waiting points.
    pub spilled_bytes: u64,
    /// Points kept for later passes.
    pub spooled_points: u64,
    /// Bytes of the temporary file for kept points.
    pub spooled_bytes: u64,
    /// Regions; 0 if points come in cells.
    pub regions: u64,
    /// Points of all regions, which have some of the points in common.
    pub region_points: u64,
    /// Points of the largest region.
    pub region_points_max: u64,
    /// Most regions that a point is in.
    pub regions_of_point_max: u64,
}

impl Stats {
    /// Average number of points in a leaf.
    pub fn cell_points_avg(&self) -> f64 {
        self.points as f64 / self.occupied_cells.max(1) as f64
    }
}

/// Reads `input` two or more times and writes its finalized point stream, END included, to `output`.
///
/// Without points, the stream has neither bounds nor tree. If no cube around the points is finite, it has no
/// tree and no tags, and keeps the input order.
///
/// Memory: the budget, on any input, and a few batches of the reader.
///
/// # Errors
/// Those of the input; [`spmesh_base::error::ErrorKind::Malformed`] if it changes between passes;
/// [`spmesh_base::error::ErrorKind::Memory`] if the budget is too small for the counters or leaves asked for;
/// I/O if output or temporary file cannot be written.
pub fn run(
    input: &dyn Passes,
    options: &Options,
    observer: &mut dyn Observer,
    mut output: impl Write,
) -> Result<Stats> {
    // Of one type, so that all of this is compiled once, in this crate.
    run_with(input, &AddedPoints::default(), options, observer, &mut output)
}

/// As [`run`], with points that are added to those of the input, and not thinned.
pub(super) fn run_with(
    input: &dyn Passes,
    added: &AddedPoints,
    options: &Options,
    observer: &mut dyn Observer,
    output: &mut dyn Write,
) -> Result<Stats> {
    options.check(input.description().dims)?;
    let budget = options.budget.beside_rows(input.description().attributes.row_len())?;
    let options = &Options { budget, ..options.clone() };
    let run = match &options.thin {
        None => write(input, added, options, observer, output),
        Some(thin) => write_thinned(input, added, thin, options, observer, output),
    };
    run.map_err(|error| match input.name() {
        // An error without a name concerns the input as a whole.
        Some(name) if error.kind() == ErrorKind::Malformed => error.of_input(name),
        _ => error,
    })
}

fn write(
    input: &dyn Passes,
    added: &AddedPoints,
    options: &Options,
    observer: &mut dyn Observer,
    output: &mut dyn Write,
) -> Result<Stats> {
    let with_added = WithAdded::new(input, added);
    let input = if added.is_empty() { input } else { &with_added };
    let mut work = Work::new(input, options, observer);
    work.write(options, output)?;
    Ok(work.stats)
}

const WINNERS: &str = "thinning: noting the kept points takes";

/// Finds the points that are kept, and writes them.
fn write_thinned(
    input: &dyn Passes,
    added: &AddedPoints,
    thin: &Thin,
    options: &Options,
    observer: &mut dyn Observer,
    output: &mut dyn Write,
) -> Result<Stats> {
    let start = Instant::now();
    observer.pass(Pass::Thin, input.description().stated_points);
    let winners = thin.winners(input, &options.budget, |points| observer.done(points))?;
    let (time, thinned) = (start.elapsed(), winners.dropped());
    let options = Options {
        budget: options.budget.beside(winners.bytes(), WINNERS, "give larger cells to --thin")?,
        ..options.clone()
    };
    let mut stats = write(&Thinned::new(input, winners), added, &options, observer, output)?;
    stats.thinned = thinned;
    stats.passes.insert(0, (Pass::Thin.name(), time));
    Ok(stats)
}

impl Work<'_> {
    /// Makes all passes.
    fn write<W: Write>(&mut self, options: &Options, output: W) -> Result<()> {
        let counts = self.count_points(options)?;
        let header = header_of(self.input.description(), &counts, options);
        let Some(cells) = counts.cells else {
            return self.write_untagged(StreamWriter::new(output, header)?);
        };
        let regions = self.regions(counts.points, options)?;
        let leaves = regions.as_ref().map_or(options.leaves, |_| options.leaves.of_regions());
        let plan = Plan::new(cells, leaves, &options.budget)?;
        self.note_plan(&plan);
        if let Some(regions) = regions {
            return self.write_in_regions(&regions, plan, header, options, output);
        }
        let writer = StreamWriter::new(output, Header { tree: Some(plan.tree()), ..header })?;
        match options.order {
            Order::Chunked => self.write_chunked(plan, options, writer),
            Order::Preserved => self.write_preserved(plan, writer),
        }
    }

    fn note_plan(&mut self, plan: &Plan) {
        self.stats.level = plan.tree().depth();
        self.stats.occupied_cells = plan.leaves() as u64;
        self.stats.empty_cells = plan.empty().len() as u64;
        self.stats.cell_points_max = plan.count_max();
    }
}

fn header_of(description: &Description, counts: &PointCounts, options: &Options) -> Header {
    let Description { coordinates, dims, has_elevation, ref crs, ref attributes, .. } = *description;
    Header {
        bounds: counts.bounds,
        points: Some(counts.points),
        chunked: counts.cells.is_some() && options.order == Order::Chunked,
        compressed: options.compress,
        crs: crs.clone(),
        attributes: attributes.clone(),
        weighted: options.weighted,
        ..Header::new(Kind::Points, coordinates, dims, has_elevation)
    }
}
