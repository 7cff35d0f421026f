//! Notices and statistics of a run.

use std::time::Duration;

use crate::configgen::{self, DegreeCounts, Flips, FunctionCounts, Made, Options, RuleName};
use spmesh_base::error::Result;
use spmesh_shell::stats::Row;
use spmesh_shell::{Report, StatsFlag, peak_memory};

/// Times of the parts of a run that are not in its report.
pub(super) struct Times {
    pub(super) read: Duration,
    pub(super) write: Duration,
    pub(super) total: Duration,
}

/// Notices about knots and flips.
pub(super) fn notices(report: &configgen::Report, options: &Options) -> Vec<String> {
    let mut notices = Vec::new();
    let configgen::Report { points, repeated, flips, .. } = report;
    if *repeated > 0 {
        let verb = if *repeated == 1 { "is a repeated knot" } else { "are repeated knots" };
        notices.push(format!("{repeated} of {points} points {verb}, at the place of an earlier one"));
    }
    if let Some(Flips::Random(wanted, _)) = options.flips
        && *flips < u64::from(wanted)
    {
        notices.push(format!("{flips} flips instead of {wanted}: found no other edge that can be flipped"));
    }
    notices
}

/// Prints what `--stats` asks for.
pub(super) fn print(
    stats: StatsFlag,
    made: &Made,
    options: &Options,
    times: &Times,
    output_bytes: u64,
) -> Result<()> {
    if !stats.is_given() {
        return Ok(());
    }
    // Measured before counting, which needs memory itself.
    let peak = peak_memory();
    let count = |configurations| DegreeCounts::of(&made.knots, configurations);
    let degrees = made.degrees.iter().map(count).collect::<Result<Vec<_>>>()?;
    let functions = (!made.functions.is_empty()).then(|| FunctionCounts::of(&made.functions));
    let seed = uses_seed(options).then_some(("seed", "seed", options.seed));
    stats.print(|| {
        let report = Report::of(times.total).times(time_rows(&made.report, times));
        let report = report.counts(whole_rows(&made.report, output_bytes, peak)).counts(seed);
        let report = report.counts(functions.iter().flat_map(function_rows));
        let of_degree = degrees.iter().map(|counts| Report::default().counts(degree_rows(counts)));
        report.parts("degrees", of_degree)
    });
    Ok(())
}

fn uses_seed(options: &Options) -> bool {
    options.rule == RuleName::Random || matches!(options.flips, Some(Flips::Random(_, None)))
}

fn time_rows(report: &configgen::Report, times: &Times) -> [Row<Duration>; 4] {
    [
        ("reading (s)", "seconds_read", times.read),
        ("start triangulation (s)", "seconds_start", report.start_time),
        ("higher degrees (s)", "seconds_degrees", report.degrees_time),
        ("writing (s)", "seconds_write", times.write),
    ]
}

fn whole_rows(report: &configgen::Report, output_bytes: u64, peak: u64) -> [Row<u64>; 7] {
    [
        ("points", "points", report.points),
        ("repeated points", "repeated", report.repeated),
        ("knots with copies", "knots", report.knots),
        ("start from a mesh", "own_start", report.own_start.into()),
        ("flips", "flips", report.flips),
        ("output (bytes)", "output_bytes", output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak),
    ]
}

fn degree_rows(counts: &DegreeCounts) -> [Row<u64>; 9] {
    [
        ("degree", "degree", counts.degree),
        ("  configurations", "configurations", counts.configurations),
        ("    without area", "flat", counts.flat),
        ("  infinite", "infinite", counts.infinite),
        ("  interior sets", "interior_sets", counts.interiors),
        ("  links, bounded", "links", counts.links),
        ("  links, null", "null_links", counts.null_links),
        ("  links, infinite", "infinite_links", counts.infinite_links),
        ("  most vertices of a link", "link_vertices_max", counts.link_vertices_max),
    ]
}

fn function_rows(counts: &FunctionCounts) -> [Row<u64>; 5] {
    [
        ("functions of edges", "functions_edges", counts.edges),
        ("  tents of knots", "functions_vertices", counts.vertices),
        ("  tents of edges", "functions_tents", counts.tents),
        ("  of smooth creases", "functions_creases", counts.creases),
        ("  box splines", "functions_faces", counts.faces),
    ]
}
