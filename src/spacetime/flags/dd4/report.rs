//! Notices and statistics of a run.

use std::time::Duration;

use crate::dd4::Report;
use spmesh_shell::rows::{Row, entries, lines, seconds};
use spmesh_shell::{StatsFormat, peak_memory, say};

/// The notice about points that coincide.
pub(super) fn merged(report: &Report) -> Option<String> {
    let Report { points, merged, .. } = report;
    let verb = if *merged == 1 { "coincides" } else { "coincide" };
    (*merged > 0).then(|| format!("{merged} of {points} points {verb} with an earlier one"))
}

/// Prints what `--stats` asks for; reading took `read`, everything `elapsed`.
pub(super) fn print(format: Option<StatsFormat>, report: &Report, read: Duration, elapsed: Duration) {
    match format {
        Some(StatsFormat::Text) => say(&text(report, read, elapsed)),
        Some(StatsFormat::Json) => say(&format!("{}\n", json(report, read, elapsed))),
        None => {}
    }
}

/// Times in seconds.
fn times(report: &Report, read: Duration, elapsed: Duration) -> Vec<Row<f64>> {
    let stats = &report.stats;
    seconds([
        ("time (s)", "seconds", elapsed),
        ("reading (s)", "seconds_read", read),
        ("diagram (s)", "seconds_diagram", report.diagram_time),
        ("  ordering (s)", "seconds_order", stats.order),
        ("  insertion (s)", "seconds_insertion", stats.insertion),
        ("  making cells (s)", "seconds_cells", stats.merge),
        ("writing (s)", "seconds_write", report.write_time),
    ])
}

/// With the times and the share of cells, these are the columns of thesis table 3.4 and the sum in figure
/// 3.9.
fn counts(report: &Report) -> [Row<u64>; 16] {
    let Report { points, merged, stats, counts, output_bytes, .. } = report;
    [
        ("points", "points", *points),
        ("vertices", "vertices", points - merged),
        ("cells", "cells", counts.finite),
        ("  not simplices", "cells_not_simplices", counts.not_simplices),
        ("  most vertices", "cell_vertices_max", counts.vertices_max),
        ("infinite cells", "infinite_cells", counts.infinite),
        ("facets", "facets", counts.facets),
        ("vertex references", "vertex_references", counts.vertex_references),
        ("cells, facets, references", "elements", counts.elements()),
        ("simplices of the triangulation", "simplices", stats.simplices),
        ("simplices created", "simplices_created", stats.created),
        ("in-sphere tests", "in_sphere_tests", stats.in_sphere_tests),
        ("points merged", "merged", *merged),
        ("cells in the output (bytes)", "cell_bytes", counts.cell_bytes()),
        ("output (bytes)", "output_bytes", *output_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

fn text(report: &Report, read: Duration, elapsed: Duration) -> String {
    let share = report.counts.share_not_simplices();
    lines(&times(report, read, elapsed), counts(report))
        + &format!("{:<30} {share:>15.3}\n", "share that are not simplices")
}

fn json(report: &Report, read: Duration, elapsed: Duration) -> String {
    let mut object = entries(&times(report, read, elapsed), counts(report));
    object.insert("share_not_simplices".into(), report.counts.share_not_simplices().into());
    serde_json::Value::Object(object).to_string()
}
