//! Figures of a run of `spfinalize`, as text and as JSON.

use crate::finalize::{Drops, LineStats, Stats};
use crate::lines::ChangeKind;
use spmesh_formats::source::DropReason;
use spmesh_shell::peak_memory;

impl LineStats {
    /// Rows of the report; empty without lines.
    pub(super) fn text(&self) -> String {
        let changes =
            ChangeKind::ALL.iter().map(|&kind| (kind.name().replace('_', " "), self.changes.count(kind)));
        let changes = changes.map(|(name, count)| (format!("lines: {name}"), count));
        let [lakes, rivers, levels] = self.water.unwrap_or_default();
        let points = [
            ("points of lines", self.points as u64),
            ("points replaced by lines", self.replaced),
            ("lakes", lakes),
            ("rivers", rivers),
            ("levels found from points", levels),
        ];
        let rows = points.map(|(name, count)| (name.to_string(), count)).into_iter().chain(changes);
        rows.filter(|(_, count)| *count > 0).map(|(name, count)| format!("{name:<32}{count}\n")).collect()
    }

    /// Adds the figures to those of the run, if there are lines.
    pub(super) fn in_json(&self, mut stats: serde_json::Value) -> serde_json::Value {
        if !self.has_lines {
            return stats;
        }
        let changes =
            ChangeKind::ALL.iter().map(|&kind| (kind.name().into(), self.changes.count(kind).into()));
        let changes: serde_json::Map<_, _> = changes.collect();
        stats["lines"] =
            serde_json::json!({"points": self.points, "replaced": self.replaced, "changes": changes});
        if let Some([lakes, rivers, found]) = self.water {
            stats["water"] = serde_json::json!({"lakes": lakes, "rivers": rivers, "levels_found": found});
        }
        stats
    }
}

/// Numbers of dropped points by reason, in the order in which filters are applied.
fn drops<'a>(stats: &Stats, dropped: &'a Drops) -> impl Iterator<Item = (&'static str, u64)> + use<'a> {
    let filters = DropReason::ALL.into_iter().map(|reason| (reason.name(), dropped.filters.of(reason)));
    let [clip, inside, water] = dropped.areas;
    filters.chain([("clip", clip), ("drop_inside", inside), ("flatten", water), ("thin", stats.thinned)])
}

pub(super) fn stats_text(stats: &Stats, dropped: &Drops) -> String {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.into(), value));
    row("points", stats.points.to_string());
    row("invalid points skipped", stats.invalid.to_string());
    for (reason, count) in drops(stats, dropped).filter(|(_, count)| *count > 0) {
        row(&format!("points dropped: {reason}"), count.to_string());
    }
    for (pass, time) in &stats.passes {
        row(&format!("time of pass {pass}"), format!("{:.2} s", time.as_secs_f64()));
    }
    row("peak memory", format!("{:.1} MB", peak_memory() as f64 / 1e6));
    row("most points buffered", stats.buffered_points_max.to_string());
    row("most bytes buffered in memory", stats.buffered_bytes_max.to_string());
    row("level", stats.level.to_string());
    row("occupied cells", stats.occupied_cells.to_string());
    row("empty cells", stats.empty_cells.to_string());
    row("points per cell, average", format!("{:.0}", stats.cell_points_avg()));
    row("points per cell, most", stats.cell_points_max.to_string());
    row("points spilled", stats.spilled_points.to_string());
    row("bytes spilled", stats.spilled_bytes.to_string());
    row("points spooled", stats.spooled_points.to_string());
    row("bytes spooled", stats.spooled_bytes.to_string());
    rows.iter().map(|(name, value)| format!("{name:<32}{value}\n")).collect()
}

pub(super) fn stats_json(stats: &Stats, dropped: &Drops) -> serde_json::Value {
    let passes: Vec<_> = stats
        .passes
        .iter()
        .map(|(name, time)| serde_json::json!({"pass": name, "seconds": time.as_secs_f64()}))
        .collect();
    let dropped: serde_json::Map<_, _> =
        drops(stats, dropped).map(|(reason, count)| (reason.into(), count.into())).collect();
    serde_json::json!({
        "points": stats.points,
        "dropped": dropped,
        "invalid_skipped": stats.invalid,
        "passes": passes,
        "peak_memory_bytes": peak_memory(),
        "buffered": {"points_max": stats.buffered_points_max, "memory_bytes_max": stats.buffered_bytes_max},
        "level": stats.level,
        "cells": {"occupied": stats.occupied_cells, "empty": stats.empty_cells},
        "points_per_cell": {"avg": stats.cell_points_avg(), "max": stats.cell_points_max},
        "spilled": {"points": stats.spilled_points, "bytes": stats.spilled_bytes},
        "spooled": {"points": stats.spooled_points, "bytes": stats.spooled_bytes},
    })
}
