//! `spdem --points`: a raster of points.

use std::path::Path;
use std::time::Instant;

use crate::flags::sheets::SheetFlags;
use crate::points::{self, Options, Stats};
use spmesh_base::error::Result;
use spmesh_shell::cells::{self, CellFlags, RasterFlags};
use spmesh_shell::open_stream;
use spmesh_shell::progress::Progress;
use spmesh_shell::stats::Row;
use spmesh_shell::{Common, Report, StatsFlag, notice, peak_memory};

/// A run.
pub(super) struct Job<'f> {
    pub(super) input: &'f Path,
    pub(super) output: &'f Path,
    pub(super) cells: &'f CellFlags,
    pub(super) sheets: &'f SheetFlags,
    pub(super) raster: &'f RasterFlags,
    pub(super) stats: StatsFlag,
    pub(super) common: &'f Common,
}

/// Writes the raster.
pub(super) fn run(job: &Job, options: &Options, started: Instant) -> Result<()> {
    let mut output = job.sheets.create(job.output, options.raster.format, job.cells, job.raster)?;
    let mut reader = open_stream(job.input)?;
    points::check(reader.header(), options).map_err(|e| e.of_input(reader.name()))?;
    let window = || points::window(reader.header()).map_err(|e| e.of_input(reader.name()));
    let grid = job.cells.grid(options.crs.as_ref().unwrap_or(&reader.header().crs), window)?;
    let mut progress = Progress::new(job.common, "counting", reader.header().points);
    let done = |points| progress.set(points);
    let stats = points::rasterize(&mut reader, output.destination(), &grid, options, done)?;
    drop(progress);
    let committed = output.commit(options.crs.as_ref().unwrap_or(&reader.header().crs))?;
    let say = |message: &str| notice(super::TOOL, job.common, message);
    stats.notices.iter().for_each(|message| say(message));
    say(&cells::summary(&grid, stats.cells - stats.known));
    committed.notice().iter().for_each(|message| say(message));
    job.stats.print(|| Report::of(started.elapsed()).counts(counts(&stats, committed.bytes)));
    Ok(())
}

fn counts(stats: &Stats, output_bytes: u64) -> [Row<u64>; 9] {
    [
        ("input (bytes)", "input_bytes", stats.input_bytes),
        ("points", "points", stats.points),
        ("points outside of the raster", "outside", stats.outside),
        ("points with an unknown value", "unknown", stats.unknown),
        ("cells", "cells", stats.cells),
        ("cells with data", "known", stats.known),
        ("tiles sent to the disk", "spilled", stats.spilled),
        ("output (bytes)", "output_bytes", output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}
