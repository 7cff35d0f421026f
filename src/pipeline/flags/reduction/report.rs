//! The counts of `--stats`.

use std::time::Duration;

use crate::reduce::Stats;
use spmesh_shell::{Report, peak_memory};

/// What `--stats` prints of a run whose simplices have this name.
pub(crate) fn stats(stats: &Stats, output_bytes: u64, elapsed: Duration, simplices: &'static str) -> Report {
    // Nearly all points are left to the root, where they lie on a surface.
    let share = stats.root_points as f64 / stats.points.max(1) as f64;
    let report = Report::of(elapsed)
        .counts(rows(stats, output_bytes, simplices))
        .counts(stats.predicates.rows())
        .row("share left to the root (%)", format!("{:.1}", 100.0 * share))
        .entry("root_share", share);
    if stats.untagged == 0 {
        return report;
    }
    report.line("note: points without a final cell were held until the end; spfinalize bounds the memory")
}

/// Rows of the report. With the time, the first rows are
/// the columns of thesis tables 5.2 and 5.3.
fn rows(stats: &Stats, output_bytes: u64, simplices: &'static str) -> [(String, &'static str, u64); 21] {
    let rows = [
        ("points", "points", stats.points),
        ("input (bytes)", "input_bytes", stats.input_bytes),
        ("levels of the tree", "level", stats.level),
        ("most simplices active", "active_max", stats.active_max),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
        ("simplices", simplices, stats.simplices),
        ("output (bytes)", "output_bytes", output_bytes),
        ("vertices", "vertices", stats.vertices),
        ("merged duplicates", "merged", stats.merged),
        ("outside of the region", "outside", stats.outside),
        ("cell tags", "cells", stats.cells),
        ("leaves with points", "leaves", stats.leaves),
        ("largest leaf (points)", "leaf_max", stats.leaf_max),
        ("nodes above with points", "inner_nodes", stats.inner_nodes),
        ("largest node above (points)", "inner_node_max", stats.inner_node_max),
        ("points left to the root", "root_points", stats.root_points),
        ("most points held", "held_max", stats.held_max),
        ("points never tagged", "untagged", stats.untagged),
        ("most residual points waiting", "residual_max", stats.residual_max),
        ("residual written (points)", "residual", stats.residual),
        ("width (live vertices)", "width", stats.width),
    ];
    rows.map(|(label, key, value)| (label.replace("simplices", simplices), key, value))
}
