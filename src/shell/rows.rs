//! What `--stats` prints: rows for people, or the entries of a JSON object.

use std::time::Duration;

use serde_json::{Map, Value};

use super::{StatsFormat, say};

/// A label for people, a key for programs, the value.
pub type Row<T> = (&'static str, &'static str, T);

/// Times in seconds.
pub fn seconds(rows: impl IntoIterator<Item = Row<Duration>>) -> Vec<Row<f64>> {
    rows.into_iter().map(|(label, key, time)| (label, key, time.as_secs_f64())).collect()
}

/// Prints the time of a run and its counts.
pub fn print(format: StatsFormat, time: Duration, counts: impl IntoIterator<Item = Row<u64>>) {
    let times = seconds([("time (s)", "seconds", time)]);
    match format {
        StatsFormat::Text => say(&lines(&times, counts)),
        StatsFormat::Json => say(&format!("{}\n", Value::Object(entries(&times, counts)))),
    }
}

/// Lines of times, then lines of counts.
pub fn lines(times: &[Row<f64>], counts: impl IntoIterator<Item = Row<u64>>) -> String {
    let mut text = String::new();
    for (label, _, seconds) in times {
        text += &format!("{label:<30} {seconds:>15.3}\n");
    }
    for (label, _, count) in counts {
        text += &format!("{label:<30} {count:>15}\n");
    }
    text
}

/// Entries of a JSON object: times, then counts.
pub fn entries(times: &[Row<f64>], counts: impl IntoIterator<Item = Row<u64>>) -> Map<String, Value> {
    let times = times.iter().map(|&(_, key, seconds)| (key.to_string(), seconds.into()));
    times.chain(counts.into_iter().map(|(_, key, count)| (key.to_string(), count.into()))).collect()
}
