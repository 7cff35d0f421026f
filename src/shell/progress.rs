//! Progress of long work on stderr: a bar on a terminal, JSON lines for programs, or nothing.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::Common;
use spmesh_base::parallel::Ticker;
use spmesh_base::upstream;

/// How often a pass shows that it goes on.
const TICK: Duration = Duration::from_millis(100);

/// When progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum When {
    /// A bar, if stderr is a terminal and no program behind this one in a pipe shows one.
    Auto,
    /// A bar, if stderr is a terminal.
    Always,
    /// Not at all.
    Never,
    /// A JSON line per second.
    Json,
}

/// Progress of one pass, counted in points or in other units.
pub struct Progress {
    bar: ProgressBar,
    json: Option<(String, Option<u64>, Instant)>,
    /// The plural of the counted items.
    unit: &'static str,
    /// Moves the bar when nothing is counted.
    ticker: Option<Ticker>,
}

impl Progress {
    /// Starts to show the pass `name`, of `total` points where that is known.
    pub fn new(common: &Common, name: &str, total: Option<u64>) -> Self {
        Self::counting("points", common, name, total)
    }

    /// Starts to show the pass `name`, of `total` units where that is known. If the output goes to a pipe, the
    /// program behind it shows how far the work is.
    pub fn counting(unit: &'static str, common: &Common, name: &str, total: Option<u64>) -> Self {
        let is_last = !upstream::is_pipe(std::io::stdout());
        Self::shown(is_last, unit, common, name, total)
    }

    /// Starts to show the pass `name`, of `total` points where that is known, before there is any output.
    pub fn before_output(common: &Common, name: &str, total: Option<u64>) -> Self {
        Self::shown(true, "points", common, name, total)
    }

    fn shown(is_wanted: bool, unit: &'static str, common: &Common, name: &str, total: Option<u64>) -> Self {
        let show = !common.quiet
            && match common.progress {
                When::Auto => is_wanted,
                When::Always => true,
                When::Never | When::Json => false,
            };
        let bar = match (show, total) {
            (false, _) => ProgressBar::hidden(),
            (true, Some(total)) => ProgressBar::new(total).with_style(
                ProgressStyle::with_template(&format!(
                    "{{prefix}} {{wide_bar}} {{human_pos}}/{{human_len}} {unit} {{eta}}"
                ))
                .expect("the template is valid"),
            ),
            (true, None) => ProgressBar::new_spinner().with_style(
                ProgressStyle::with_template(&format!(
                    "{{prefix}} {{spinner}} {{human_pos}} {unit} {{elapsed}}"
                ))
                .expect("the template is valid"),
            ),
        };
        bar.set_prefix(name.to_string());
        let json = (common.progress == When::Json).then(|| (name.to_string(), total, Instant::now()));
        Progress { bar, json, unit, ticker: None }
    }

    /// Shows that the pass `name` is running, without a count.
    pub fn waiting(common: &Common, name: &str) -> Self {
        let mut progress = Self::counting("points", common, name, None);
        if !progress.bar.is_hidden() {
            let style = ProgressStyle::with_template("{prefix} {spinner} {elapsed}");
            progress.bar.set_style(style.expect("the template is valid"));
            let bar = progress.bar.clone();
            // Without a thread, the display stands still.
            progress.ticker = Ticker::start("progress", TICK, move || bar.tick()).ok();
        }
        progress
    }

    /// Says that `done` units are done.
    pub fn set(&mut self, done: u64) {
        self.bar.set_position(done);
        if let Some((name, total, last)) = &mut self.json
            && last.elapsed() >= Duration::from_secs(1)
        {
            *last = Instant::now();
            let line = serde_json::json!({"pass": name, self.unit: done, "total": total});
            super::say(&format!("{line}\n"));
        }
    }

    /// Prints a line on stderr, beside the bar.
    pub fn say(&self, text: &str) {
        self.bar.suspend(|| super::messages::say_line(text));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.ticker = None;
        self.bar.finish_and_clear();
    }
}
