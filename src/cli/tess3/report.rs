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

/// Times in seconds: a label for people, a key for programs, the value. With the counts these are the columns of
/// thesis table 3.3.
fn times(stats: &Stats, elapsed: Duration) -> [(&'static str, &'static str, f64); 8] {
    let times = stats.sums.times;
    let seconds = |time: Duration| time.as_secs_f64();
    [
        ("time (s)", "seconds", seconds(elapsed)),
        ("reading (s)", "seconds_read", seconds(times.read)),
        ("triangulating (s)", "seconds_triangulate", seconds(times.triangulate)),
        ("  ordering (s)", "seconds_order", seconds(times.order)),
        ("  point location (s)", "seconds_locate", seconds(times.locate)),
        ("  cavities: predicates (s)", "seconds_predicates", seconds(times.cavity)),
        ("  cavities: update (s)", "seconds_update", seconds(times.update)),
        ("writing (s)", "seconds_write", seconds(times.write)),
    ]
}

/// Counts: a label for people, a key for programs, the value.
fn counts(stats: &Stats) -> [(&'static str, &'static str, u64); 14] {
    let Stats { models, sums, atoms_max } = stats;
    let predicates = sums.predicates;
    [
        ("models", "models", *models),
        ("points", "points", sums.atoms),
        ("points of the largest model", "points_max", *atoms_max),
        ("vertices", "vertices", sums.vertices),
        ("tetrahedra", "tetrahedra", sums.tetrahedra),
        ("facets of the hull", "hull_facets", sums.hull_facets),
        ("tetrahedra created", "tetrahedra_created", sums.created),
        ("kernel memory (bytes)", "kernel_bytes", sums.kernel_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
        ("predicates: filter", "predicates_filter", predicates.filter),
        ("predicates: integer", "predicates_integer", predicates.integer),
        ("predicates: expansion", "predicates_expansion", predicates.expansion),
        ("predicates: big integer", "predicates_bigint", predicates.bigint),
        ("predicates: ties broken", "predicates_perturbed", predicates.perturbed),
    ]
}

/// Bytes that the kernel held per point, of the model that took most.
fn bytes_per_point(stats: &Stats) -> f64 {
    stats.sums.kernel_bytes as f64 / stats.atoms_max.max(1) as f64
}

fn text(stats: &Stats, elapsed: Duration) -> String {
    let mut text = String::new();
    for (label, _, seconds) in times(stats, elapsed) {
        text += &format!("{label:<30} {seconds:>15.3}\n");
    }
    for (label, _, count) in counts(stats) {
        text += &format!("{label:<30} {count:>15}\n");
    }
    text + &format!("{:<30} {:>15.1}\n", "kernel bytes per point", bytes_per_point(stats))
}

fn json(stats: &Stats, elapsed: Duration) -> String {
    let mut object = serde_json::Map::new();
    object
        .extend(times(stats, elapsed).into_iter().map(|(_, key, seconds)| (key.to_string(), seconds.into())));
    object.extend(counts(stats).into_iter().map(|(_, key, count)| (key.to_string(), count.into())));
    object.insert("kernel_bytes_per_point".into(), bytes_per_point(stats).into());
    serde_json::Value::Object(object).to_string()
}
