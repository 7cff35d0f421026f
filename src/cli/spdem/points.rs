//! `spdem --points`: a raster of points.

use std::path::Path;
use std::time::Instant;

use crate::cells::{self, CellFlags};
use crate::progress::Progress;
use crate::reduction::open_stream;
use crate::rows::{self, Row};
use crate::{Common, StatsFormat, notice, peak_memory};
use spmesh_core::error::Result;
use spmesh_terrain::points::{self, Options, Stats};

/// The message when memory runs out.
pub(super) const OUT_OF_MEMORY: &str = "spdem: not enough memory: give less --memory\n";

/// A run.
pub(super) struct Job<'f> {
    pub(super) input: &'f Path,
    pub(super) output: &'f Path,
    pub(super) cells: &'f CellFlags,
    pub(super) stats: Option<StatsFormat>,
    pub(super) common: &'f Common,
}

/// Writes the raster.
///
/// # Errors
/// As [`points::rasterize`], and if the input or the output cannot be opened.
pub(super) fn run(job: &Job, options: &Options, started: Instant) -> Result<()> {
    let mut output = cells::create(job.output, options.raster.format)?;
    let mut reader = open_stream(job.input)?;
    points::check(reader.header(), options).map_err(|e| e.of_input(reader.name()))?;
    let window = || points::window(reader.header()).map_err(|e| e.of_input(reader.name()));
    let grid = job.cells.grid(window)?;
    let mut progress = Progress::new(job.common, "counting", reader.header().points);
    let stats = points::rasterize(&mut reader, &mut output, &grid, options, |points| progress.set(points))?;
    drop(progress);
    let output_bytes = output.bytes_written();
    output.commit()?;
    let say = |message: &str| notice(super::TOOL, job.common, message);
    stats.notices.iter().for_each(|message| say(message));
    say(&cells::summary(&grid, stats.cells - stats.known));
    if let Some(format) = job.stats {
        rows::print(format, started.elapsed(), counts(&stats, output_bytes));
    }
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
