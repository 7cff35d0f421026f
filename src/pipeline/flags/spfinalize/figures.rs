//! Figures of a run of `spfinalize`, as text and as JSON.

use std::fmt::Display;
use std::time::Duration;

use serde_json::{Value, json};

use crate::finalize::{Drops, LineStats, Stats};
use crate::lines::ChangeKind;
use spmesh_formats::source::DropReason;
use spmesh_shell::stats::Row;
use spmesh_shell::{Report, peak_memory};

impl LineStats {
    /// Adds the figures to those of the run: rows of what there is, and entries if there are lines.
    fn add_to(&self, report: Report) -> Report {
        let [lakes, rivers, levels] = self.water.unwrap_or_default();
        let points = [
            ("points of lines", "lines.points", self.points as u64),
            ("points replaced by lines", "lines.replaced", self.replaced),
            ("lakes", "water.lakes", lakes),
            ("rivers", "water.rivers", rivers),
            ("levels found from points", "water.levels_found", levels),
            ("points raised to the water", "water.raised", self.raised),
        ];
        let points = points.map(|(label, key, count)| (label.to_string(), key.to_string(), count));
        let changes = ChangeKind::ALL.iter().map(|kind| {
            let (name, count) = (kind.name(), self.changes.count(*kind));
            (format!("lines: {}", name.replace('_', " ")), format!("lines.changes.{name}"), count)
        });
        points.into_iter().chain(changes).fold(report, |report, (label, key, count)| {
            let report = if count > 0 { row(report, &label, count) } else { report };
            let is_there = self.has_lines && (self.water.is_some() || !key.starts_with("water"));
            if is_there { report.entry(&key, count) } else { report }
        })
    }
}

/// Numbers of dropped points by reason, in the order in which filters are applied.
fn drops<'a>(stats: &Stats, dropped: &'a Drops) -> impl Iterator<Item = (&'static str, u64)> + use<'a> {
    let filters = DropReason::ALL.into_iter().map(|reason| (reason.name(), dropped.filters.of(reason)));
    let [clip, inside, water] = dropped.areas;
    filters.chain([("clip", clip), ("drop_inside", inside), ("flatten", water), ("thin", stats.thinned)])
}

/// A row of the report.
fn row(report: Report, label: &str, value: impl Display) -> Report {
    report.line(&format!("{label:<32}{value}"))
}

/// What `--stats` prints.
pub(super) fn report(stats: &Stats, dropped: &Drops, lines: &LineStats) -> Report {
    let count = |report, (label, key, count): Row<u64>| row(report, label, count).entry(key, count);
    let first =
        [("points", "points", stats.points), ("invalid points skipped", "invalid_skipped", stats.invalid)];
    let mut report = first.into_iter().fold(Report::default(), count);
    for (reason, count) in drops(stats, dropped) {
        report = report.entry(&format!("dropped.{reason}"), count);
        if count > 0 {
            report = row(report, &format!("points dropped: {reason}"), count);
        }
    }
    for (pass, time) in &stats.passes {
        report = row(report, &format!("time of pass {pass}"), format!("{:.2} s", time.as_secs_f64()));
    }
    let pass = |(name, time): &(_, Duration)| json!({"pass": name, "seconds": time.as_secs_f64()});
    let (peak, mean) = (peak_memory(), stats.cell_points_avg());
    report = row(report, "peak memory", format!("{:.1} MB", peak as f64 / 1e6))
        .entry("passes", stats.passes.iter().map(pass).collect::<Value>())
        .entry("peak_memory_bytes", peak);
    let cells = [
        ("most points buffered", "buffered.points_max", stats.buffered_points_max),
        ("most bytes buffered in memory", "buffered.memory_bytes_max", stats.buffered_bytes_max),
        ("level", "level", stats.level.into()),
        ("occupied cells", "cells.occupied", stats.occupied_cells),
        ("empty cells", "cells.empty", stats.empty_cells),
    ];
    report = cells.into_iter().fold(report, count);
    report = row(report, "points per cell, average", format!("{mean:.0}")).entry("points_per_cell.avg", mean);
    let rest = [
        ("points per cell, most", "points_per_cell.max", stats.cell_points_max),
        ("points spilled", "spilled.points", stats.spilled_points),
        ("bytes spilled", "spilled.bytes", stats.spilled_bytes),
        ("points spooled", "spooled.points", stats.spooled_points),
        ("bytes spooled", "spooled.bytes", stats.spooled_bytes),
        ("regions", "regions.count", stats.regions),
        ("points in all regions", "regions.points", stats.region_points),
        ("points of the largest region", "regions.points_max", stats.region_points_max),
        ("most regions of a point", "regions.of_point_max", stats.regions_of_point_max),
    ];
    lines.add_to(rest.into_iter().fold(report, count))
}
