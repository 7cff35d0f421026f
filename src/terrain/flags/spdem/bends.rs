//! `spdem --bends`: flags, and the counts of `--stats`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use crate::bends::{Stats, write_bends};
use spmesh_base::output::Output;
use spmesh_shell::progress::Progress;
use spmesh_shell::stats::Row;
use spmesh_shell::{Common, Mesh, Needs, Report, StatsFlag, peak_memory};
use spmesh_stream::Crs;

/// Memory for flat triangles by default. Units: bytes.
pub(super) const MEMORY: u64 = 1 << 30;

/// Flags about bends.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Bends of contour lines")]
pub(super) struct BendFlags {
    /// Write places with elevations instead of a raster, for --lines of spfinalize: in the middle of flat
    /// areas at bends of the contour lines that a mesh is made of, so that the next mesh is not flat there
    #[arg(long, conflicts_with_all = ["CellFlags", "SheetFlags", "OutlineFlags", "ContourFlags", "no_data", "cog", "temp_dir", "GeoTiffFlags", "kind", "method", "z_factor", "light", "multidirectional", "range", "fill", "below_water"])]
    pub(super) bends: bool,
}

/// A run that writes places.
pub(super) struct Job<'a> {
    pub(super) input: &'a PathBuf,
    pub(super) output: &'a Path,
    pub(super) crs: Option<Crs>,
    pub(super) memory: u64,
    pub(super) stats: StatsFlag,
    pub(super) common: &'a Common,
}

/// Writes places, and calls `notice` with what the user should know of them.
pub(super) fn run(job: &Job, started: Instant, notice: impl Fn(&str)) -> anyhow::Result<()> {
    let mut output = Output::create(job.output, false)?;
    let mut reader =
        Mesh::open(job.input)?.read(&Needs { window: None, beyond: Some("a flat area") })?.reader;
    let crs = job.crs.clone().unwrap_or_else(|| reader.header().crs.clone());
    let mut progress = Progress::new(job.common, "looking for bends", reader.header().points);
    let stats = write_bends(&mut reader, &mut output, &crs, job.memory, |done| progress.set(done))?;
    drop(progress);
    output.commit()?;
    notice(&format!(
        "{} of {} triangles are flat, {} of them in {} bends, which get {} places; {} other flat areas lead to no single \
         elevation",
        stats.flat, stats.triangles, stats.in_bends, stats.bends, stats.places, stats.left
    ));
    job.stats.print(|| Report::of(started.elapsed()).counts(counts(&stats)));
    Ok(())
}

fn counts(stats: &Stats) -> [Row<u64>; 7] {
    [
        ("triangles", "triangles", stats.triangles),
        ("flat triangles", "flat", stats.flat),
        ("flat triangles in bends", "in_bends", stats.in_bends),
        ("bends", "bends", stats.bends),
        ("other flat areas", "left", stats.left),
        ("places", "places", stats.places),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}
