//! Notices and statistics of a run.

use std::time::Duration;

use crate::dd4::Report;
use spmesh_shell::peak_memory;
use spmesh_shell::stats::{self, Row};

/// The notice about points that coincide.
pub(super) fn merged(report: &Report) -> Option<String> {
    let Report { points, merged, .. } = report;
    let verb = if *merged == 1 { "coincides" } else { "coincide" };
    (*merged > 0).then(|| format!("{merged} of {points} points {verb} with an earlier one"))
}

/// What `--stats` prints; reading took `read`, everything `elapsed`.
pub(super) fn stats(report: &Report, read: Duration, elapsed: Duration) -> stats::Report {
    let share = report.counts.share_not_simplices();
    let printed = stats::Report::of(elapsed).times(times(report, read)).counts(counts(report));
    printed.row("share that are not simplices", format!("{share:.3}")).entry("share_not_simplices", share)
}

fn times(report: &Report, read: Duration) -> [Row<Duration>; 6] {
    let stats = &report.stats;
    [
        ("reading (s)", "seconds_read", read),
        ("diagram (s)", "seconds_diagram", report.diagram_time),
        ("  ordering (s)", "seconds_order", stats.order),
        ("  insertion (s)", "seconds_insertion", stats.insertion),
        ("  making cells (s)", "seconds_cells", stats.merge),
        ("writing (s)", "seconds_write", report.write_time),
    ]
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
