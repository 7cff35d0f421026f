//! Progress of long work on stderr: a bar on a terminal, JSON lines for programs, or nothing.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::Common;

/// When progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum When {
    /// A bar, if stderr is a terminal.
    Auto,
    /// Not at all.
    Never,
    /// A JSON line per second.
    Json,
}

/// Progress of one pass, counted in points.
pub struct Progress {
    bar: ProgressBar,
    json: Option<(String, Option<u64>, Instant)>,
}

impl Progress {
    /// Starts to show the pass `name`, of `total` points where that is known.
    #[must_use]
    pub fn new(common: &Common, name: &str, total: Option<u64>) -> Self {
        let show = common.progress == When::Auto && !common.quiet;
        let bar = match (show, total) {
            (false, _) => ProgressBar::hidden(),
            (true, Some(total)) => ProgressBar::new(total).with_style(
                ProgressStyle::with_template("{prefix} {wide_bar} {human_pos}/{human_len} points {eta}")
                    .expect("the template is valid"),
            ),
            (true, None) => ProgressBar::new_spinner().with_style(
                ProgressStyle::with_template("{prefix} {spinner} {human_pos} points {elapsed}")
                    .expect("the template is valid"),
            ),
        };
        bar.set_prefix(name.to_string());
        let json = (common.progress == When::Json).then(|| (name.to_string(), total, Instant::now()));
        Progress { bar, json }
    }

    /// Says that `done` points are done.
    pub fn set(&mut self, done: u64) {
        self.bar.set_position(done);
        if let Some((name, total, last)) = &mut self.json
            && last.elapsed() >= Duration::from_secs(1)
        {
            *last = Instant::now();
            super::say(&format!("{}\n", serde_json::json!({"pass": name, "points": done, "total": total})));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
