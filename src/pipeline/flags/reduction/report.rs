//! The counts of `--stats`.

use crate::reduce::Stats;
use spmesh_shell::{StatsFormat, peak_memory, say};

/// The values that `--stats` prints.
pub(crate) struct Report {
    pub(crate) stats: Stats,
    pub(crate) output_bytes: u64,
    pub(crate) seconds: f64,
    /// The name of the simplices.
    pub(crate) simplices: &'static str,
}

impl Report {
    /// Prints the counts on stderr.
    pub(crate) fn print(&self, format: StatsFormat) {
        match format {
            StatsFormat::Text => say(&text_report(self)),
            StatsFormat::Json => say(&format!("{}\n", json_report(self))),
        }
    }
}

/// Rows of the report: a label for people, a key for programs, the value. With the time, the first rows are
/// the columns of thesis tables 5.2 and 5.3.
fn rows(report: &Report) -> [(String, &'static str, u64); 27] {
    let (stats, simplices) = (&report.stats, report.simplices);
    let rows = [
        ("points", "points", stats.points),
        ("input (bytes)", "input_bytes", stats.input_bytes),
        ("levels of the tree", "level", stats.level),
        ("most simplices active", "active_max", stats.active_max),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
        ("simplices", simplices, stats.simplices),
        ("output (bytes)", "output_bytes", report.output_bytes),
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
        ("predicates: filter", "predicates_filter", stats.predicates.filter),
        ("predicates: integer", "predicates_integer", stats.predicates.integer),
        ("predicates: pairs", "predicates_pairs", stats.predicates.pairs),
        ("predicates: residues", "predicates_residues", stats.predicates.residues),
        ("predicates: big integer", "predicates_bigint", stats.predicates.bigint),
        ("predicates: ties broken", "predicates_perturbed", stats.predicates.perturbed),
    ];
    rows.map(|(label, key, value)| (label.replace("simplices", simplices), key, value))
}

/// Share of the points that was left to the root: nearly all, where points lie on a surface.
fn root_share(stats: &Stats) -> f64 {
    stats.root_points as f64 / stats.points.max(1) as f64
}

fn text_report(report: &Report) -> String {
    let mut text = format!("{:<30} {:>15.3}\n", "time (s)", report.seconds);
    for (label, _, value) in rows(report) {
        text += &format!("{label:<30} {value:>15}\n");
    }
    text += &format!("{:<30} {:>15.1}\n", "share left to the root (%)", 100.0 * root_share(&report.stats));
    if report.stats.untagged > 0 {
        text += "note: points without a final cell were held until the end; spfinalize bounds the memory\n";
    }
    text
}

fn json_report(report: &Report) -> String {
    let mut object = serde_json::Map::new();
    object.insert("seconds".into(), report.seconds.into());
    object.insert("root_share".into(), root_share(&report.stats).into());
    object.extend(rows(report).into_iter().map(|(_, key, value)| (key.to_string(), value.into())));
    serde_json::Value::Object(object).to_string()
}
