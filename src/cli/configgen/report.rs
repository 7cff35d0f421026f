//! What a run says when it is done.

use std::time::Duration;

use crate::cli::{StatsFormat, peak_memory, say};
use crate::configgen::{DegreeCounts, Flips, Made, Options, Report, RuleName};
use crate::error::Result;

/// What the parts of a run took that are not in its report.
pub(super) struct Times {
    pub(super) read: Duration,
    pub(super) write: Duration,
    pub(super) total: Duration,
}

/// What the user should know of the knots and the flips.
pub(super) fn notices(report: &Report, options: &Options) -> Vec<String> {
    let mut notices = Vec::new();
    let Report { points, repeated, flips, .. } = report;
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
///
/// # Errors
/// As [`DegreeCounts::of`].
pub(super) fn print(
    format: Option<StatsFormat>,
    made: &Made,
    options: &Options,
    times: &Times,
    output_bytes: u64,
) -> Result<()> {
    let Some(format) = format else { return Ok(()) };
    // Before counting, which takes some itself.
    let peak = peak_memory();
    let count = |configurations| DegreeCounts::of(&made.knots, configurations);
    let degrees = made.degrees.iter().map(count).collect::<Result<Vec<_>>>()?;
    let whole = whole_rows(&made.report, output_bytes, peak);
    let times = time_rows(&made.report, times);
    let seed = uses_seed(options).then_some(options.seed);
    match format {
        StatsFormat::Text => say(&text(&times, &whole, seed, &degrees)),
        StatsFormat::Json => say(&format!("{}\n", json(&times, &whole, seed, &degrees))),
    }
    Ok(())
}

fn uses_seed(options: &Options) -> bool {
    options.rule == RuleName::Random || matches!(options.flips, Some(Flips::Random(_, None)))
}

/// A label for people, a key for programs, the value.
type Row<T> = (&'static str, &'static str, T);

fn time_rows(report: &Report, times: &Times) -> [Row<f64>; 5] {
    [
        ("time (s)", "seconds", times.total),
        ("reading (s)", "seconds_read", times.read),
        ("start triangulation (s)", "seconds_start", report.start_time),
        ("higher degrees (s)", "seconds_degrees", report.degrees_time),
        ("writing (s)", "seconds_write", times.write),
    ]
    .map(|(label, key, time)| (label, key, time.as_secs_f64()))
}

fn whole_rows(report: &Report, output_bytes: u64, peak: u64) -> [Row<u64>; 7] {
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

fn text(times: &[Row<f64>], whole: &[Row<u64>], seed: Option<u64>, degrees: &[DegreeCounts]) -> String {
    let mut text = String::new();
    for (label, _, seconds) in times {
        text += &format!("{label:<30} {seconds:>15.3}\n");
    }
    let seed = seed.map(|seed| ("seed", "seed", seed));
    let degrees = degrees.iter().flat_map(degree_rows);
    for (label, _, count) in whole.iter().copied().chain(seed).chain(degrees) {
        text += &format!("{label:<30} {count:>15}\n");
    }
    text
}

fn json(times: &[Row<f64>], whole: &[Row<u64>], seed: Option<u64>, degrees: &[DegreeCounts]) -> String {
    let mut object = serde_json::Map::new();
    object.extend(times.iter().map(|&(_, key, seconds)| (key.to_string(), seconds.into())));
    object.extend(whole.iter().map(|&(_, key, count)| (key.to_string(), count.into())));
    if let Some(seed) = seed {
        object.insert("seed".into(), seed.into());
    }
    let of_degree = |counts: &DegreeCounts| -> serde_json::Value {
        degree_rows(counts).into_iter().map(|(_, key, count)| (key.to_string(), count)).collect()
    };
    object.insert("degrees".into(), degrees.iter().map(of_degree).collect());
    serde_json::Value::Object(object).to_string()
}
