//! The flag `--stats`, and the report that it prints: rows for people, or one JSON object.

use std::fmt::Display;
use std::time::Duration;

use clap::Args;
use serde_json::Value;

use super::say;

/// A label for people, a key for programs, the value.
pub type Row<T> = (&'static str, &'static str, T);

/// How `--stats` is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum StatsFormat {
    /// A table for people.
    Text,
    /// One JSON object.
    Json,
}

/// The flag for the counts of a run.
#[derive(Debug, Clone, Copy, Args)]
pub struct StatsFlag {
    /// Print the counts of the run on stderr
    #[arg(id = "stats", long, value_enum, value_name = "FORMAT", num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "text")]
    format: Option<StatsFormat>,
}

impl StatsFlag {
    /// Whether a report is asked for.
    pub fn is_given(self) -> bool {
        self.format.is_some()
    }

    /// Prints the report, if it is asked for.
    pub fn print(self, report: impl FnOnce() -> Report) {
        match self.format {
            Some(StatsFormat::Text) => say(&report().text),
            Some(StatsFormat::Json) => say(&format!("{}\n", report().json)),
            None => {}
        }
    }
}

/// The figures of a run, as text and as JSON.
#[derive(Debug, Default)]
pub struct Report {
    text: String,
    json: Value,
}

impl Report {
    /// A report that begins with the time of the run.
    pub fn of(elapsed: Duration) -> Report {
        Report::default().times([("time (s)", "seconds", elapsed)])
    }

    /// Adds times in seconds.
    pub fn times(self, rows: impl IntoIterator<Item = Row<Duration>>) -> Report {
        rows.into_iter().fold(self, |report, (label, key, time)| {
            let seconds = time.as_secs_f64();
            report.row(label, format!("{seconds:.3}")).entry(key, seconds)
        })
    }

    /// Adds counts.
    pub fn counts<L: Display>(self, rows: impl IntoIterator<Item = (L, &'static str, u64)>) -> Report {
        rows.into_iter().fold(self, |report, (label, key, count)| report.row(label, count).entry(key, count))
    }

    /// Adds a row of text.
    pub fn row(self, label: impl Display, value: impl Display) -> Report {
        self.line(&format!("{:<30} {:>15}", label.to_string(), value.to_string()))
    }

    /// Adds a line of text.
    pub fn line(mut self, line: &str) -> Report {
        self.text += line;
        self.text.push('\n');
        self
    }

    /// Adds an entry of JSON; `a.b` is the entry b of the object a.
    pub fn entry(mut self, key: &str, value: impl Into<Value>) -> Report {
        *key.split('.').fold(&mut self.json, |object, key| &mut object[key]) = value.into();
        self
    }

    /// Adds the reports of parts: their rows, and their objects as a list.
    pub fn parts(mut self, key: &str, parts: impl IntoIterator<Item = Report>) -> Report {
        let mut objects = Vec::new();
        for part in parts {
            self.text += &part.text;
            objects.push(part.json);
        }
        self.entry(key, objects)
    }
}
