//! What a run says when it is done.

use std::time::Duration;

use crate::cli::{StatsFormat, peak_memory, say};
use crate::tess3::{Report, Stats};

/// What the user should know of a model: nothing, mostly.
pub(super) fn degeneracy(report: &Report, models: usize) -> Vec<String> {
    let which = if models > 1 { format!("model {}: ", report.model) } else { String::new() };
    let mut texts = Vec::new();
    let merged = report.atoms - report.vertices;
    if merged > 0 {
        let verb = if merged == 1 { "coincides" } else { "coincide" };
        texts.push(format!("{which}{merged} of {} points {verb} with an earlier one", report.atoms));
    }
    if report.hull_facets == 0 {
        let reason =
            if report.vertices < 4 { "fewer than four different points" } else { "all points in a plane" };
        texts.push(format!("{which}no tetrahedra: {reason} ({} points)", report.atoms));
    }
    texts
}

/// Prints what `--stats` asks for.
pub(super) fn print(format: Option<StatsFormat>, stats: &Stats, elapsed: Duration) {
    match format {
        Some(StatsFormat::Text) => say(&text(stats, elapsed)),
        Some(StatsFormat::Json) => say(&format!("{}\n", json(stats, elapsed))),
        None => {}
    }
}

/// Times: a label for people, a key for programs, the value.
fn times(stats: &Stats, elapsed: Duration) -> [(&'static str, &'static str, f64); 4] {
    let times = stats.sums.times;
    [
        ("time (s)", "seconds", elapsed.as_secs_f64()),
        ("reading (s)", "seconds_read", times.read.as_secs_f64()),
        ("triangulating (s)", "seconds_triangulate", times.triangulate.as_secs_f64()),
        ("writing (s)", "seconds_write", times.write.as_secs_f64()),
    ]
}

/// Counts: a label for people, a key for programs, the value.
fn counts(stats: &Stats) -> [(&'static str, &'static str, u64); 6] {
    let Stats { models, sums } = stats;
    [
        ("models", "models", *models),
        ("points", "points", sums.atoms),
        ("vertices", "vertices", sums.vertices),
        ("tetrahedra", "tetrahedra", sums.tetrahedra),
        ("facets of the hull", "hull_facets", sums.hull_facets),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
    ]
}

fn text(stats: &Stats, elapsed: Duration) -> String {
    let mut text = String::new();
    for (label, _, seconds) in times(stats, elapsed) {
        text += &format!("{label:<30} {seconds:>15.3}\n");
    }
    for (label, _, count) in counts(stats) {
        text += &format!("{label:<30} {count:>15}\n");
    }
    text
}

fn json(stats: &Stats, elapsed: Duration) -> String {
    let mut object = serde_json::Map::new();
    object
        .extend(times(stats, elapsed).into_iter().map(|(_, key, seconds)| (key.to_string(), seconds.into())));
    object.extend(counts(stats).into_iter().map(|(_, key, count)| (key.to_string(), count.into())));
    serde_json::Value::Object(object).to_string()
}
