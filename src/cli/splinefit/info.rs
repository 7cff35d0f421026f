//! `splinefit info`: flags and output.

use std::io::Write;
use std::iter;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::report::{outside, residual_rows};
use super::{Threads, check_stdin, say};
use crate::Common;
use crate::messages::{escaped, escaped_json};
use spmesh_core::error::{Error, Result};
use spmesh_core::output::Output;
use spmesh_core::places::check_apart;
use spmesh_io::raster::Window;
use spmesh_io::source::SourceOptions;
use spmesh_splinefit::{Candidate, Condition, Layout, Points, Smoothness, Spline, Statistics, Summary};

/// Segments that the text output lists.
const LISTED: usize = 5;

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "\
The condition is that of interpolation at Greville sites: in the 2-norm for up to 500 functions; for more, a \
lower estimate in the 1-norm. Splines of degree k have k - 1 continuous derivatives, except across segments \
between knots that are repeated or collinear with others. For degree 2, the gradients of functions on both \
sides of these segments are compared. Residuals are elevations less values.";

#[derive(Debug, Clone, Args)]
#[command(after_help = NOTES)]
pub(super) struct Flags {
    /// A spline, or configurations; - is stdin
    #[arg(value_name = "SPLINE")]
    spline: PathBuf,

    /// Points to compare the spline with
    #[arg(value_name = "POINTS")]
    points: Vec<PathBuf>,

    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: Threads,
}

impl Flags {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let points = self.points.iter().map(|path| ("points", path.as_path()));
        check_stdin([("the spline", self.spline.as_path())].into_iter().chain(points))?;
        let inputs = iter::once(&self.spline).chain(&self.points).map(PathBuf::as_path);
        check_apart(inputs, &[("the report", Path::new("-"))])?;
        // Fail before the work if stdout is closed.
        let mut output = Output::create(Path::new("-"), false)?;
        let (layout, residuals) = self.compare()?;
        if let Some(residuals) = residuals.as_ref().filter(|residuals| residuals.outside > 0) {
            say(common, &outside(residuals));
        }
        let summary = Summary::of(&layout)?;
        let text = match self.json {
            true => escaped_json(&format!("{}\n", json(&summary, &layout, residuals.as_ref()))),
            false => text(&summary, &layout, residuals.as_ref()),
        };
        output.write_all(text.as_bytes()).map_err(|error| Error::io("printing", error))?;
        output.commit()
    }

    /// The layout, with residuals if points are given.
    fn compare(&self) -> Result<(Layout, Option<Statistics>)> {
        if self.points.is_empty() {
            return Ok((Layout::open(&self.spline)?.0, None));
        }
        let spline = Spline::open(&self.spline)?;
        let points = Points::open(&self.points, &SourceOptions::default(), None, false, |_| ())?;
        let residuals = Statistics::of(&spline, &points, self.threads.get(), &|_| ())?;
        Ok((spline.layout, Some(residuals)))
    }
}

fn text(summary: &Summary, layout: &Layout, residuals: Option<&Statistics>) -> String {
    let mut text = String::new();
    let mut line = |label: &str, value: String| text += &format!("{label:<12} {value}\n");
    line("degree", summary.degree.to_string());
    line("knots", format!("{} at {} places", summary.knots, summary.places));
    line("functions", summary.functions.to_string());
    line("crs", spmesh_crs::name(&layout.frame.crs).map_or("unknown".into(), |name| escaped(&name)));
    line("bounds", summary.bounds.map_or("none".into(), box_text));
    line(
        "domain",
        summary.domain.map_or("none: functions sum to one nowhere".into(), |domain| {
            format!("within {}", box_text(domain))
        }),
    );
    line(
        "condition",
        match &summary.condition {
            Condition::Exact(condition) => format!("{condition:.3}"),
            Condition::Estimate(condition) => format!("about {condition:.1}, or more"),
            Condition::None(why) => format!("none: {why}"),
        },
    );
    for (label, value) in smoothness_lines(&summary.smoothness, layout) {
        line(label, value);
    }
    if let Some(residuals) = residuals {
        line("residuals", format!("of {} points", residuals.count));
        for (label, _, value) in residual_rows(residuals) {
            line("", format!("{:<22} {value:.6e}", label.trim()));
        }
        if let Some([x, y]) = residuals.worst {
            line("", format!("{:<22} {x} {y}", "greatest at"));
        }
    }
    text
}

fn box_text(Window { min, max }: Window) -> String {
    format!("{} {} to {} {}", min[0], min[1], max[0], max[1])
}

fn smoothness_lines(smoothness: &Smoothness, layout: &Layout) -> Vec<(&'static str, String)> {
    let Smoothness { order, candidates, folds } = smoothness;
    let (found, what) = match folds {
        Some(folds) => (folds, "gradients jump"),
        None => (candidates, "knots are repeated, or on a line with others"),
    };
    if found.is_empty() {
        return vec![("smoothness", format!("C{order}"))];
    }
    let least = found.iter().map(|candidate| candidate.order).min().unwrap_or(*order);
    let smoothness = |order: i32| if order < 0 { "values jump".to_string() } else { format!("C{order}") };
    let (order, least) = (smoothness(*order), smoothness(least));
    let first = format!("{order} but for {} segments, where {what} (least: {least}):", found.len());
    let segment = |candidate: &Candidate| {
        let [[a, b], [c, d]] = candidate.ends.map(|end| layout.frame.to_decimal(end));
        ("", format!("{a} {b} to {c} {d}"))
    };
    let mut lines = vec![("smoothness", first)];
    lines.extend(found.iter().take(LISTED).map(segment));
    if found.len() > LISTED {
        lines.push(("", format!("and {} more", found.len() - LISTED)));
    }
    lines
}

fn json(summary: &Summary, layout: &Layout, residuals: Option<&Statistics>) -> Value {
    let area = |area: Option<Window>| area.map(|Window { min, max }| json!([min[0], min[1], max[0], max[1]]));
    let condition = match &summary.condition {
        Condition::Exact(condition) => json!({"norm": 2, "value": condition}),
        Condition::Estimate(condition) => json!({"norm": 1, "at_least": condition}),
        Condition::None(why) => json!({"none": why}),
    };
    let segments = |candidates: &[Candidate]| -> Value {
        let segment = |candidate: &Candidate| {
            let ends = candidate.ends.map(|end| layout.frame.to_decimal(end));
            json!({"ends": ends, "order": candidate.order})
        };
        candidates.iter().map(segment).collect()
    };
    let smoothness = json!({
        "order": summary.smoothness.order,
        "candidates": segments(&summary.smoothness.candidates),
        "folds": summary.smoothness.folds.as_deref().map(segments),
    });
    json!({
        "degree": summary.degree,
        "knots": summary.knots,
        "places": summary.places,
        "functions": summary.functions,
        "crs": spmesh_crs::name(&layout.frame.crs),
        "bounds": area(summary.bounds),
        "domain": area(summary.domain),
        "condition": condition,
        "smoothness": smoothness,
        "residuals": residuals.map(residuals_json),
    })
}

fn residuals_json(residuals: &Statistics) -> Value {
    let mut object = Map::new();
    object.insert("count".into(), residuals.count.into());
    object.insert("outside".into(), residuals.outside.into());
    for (_, key, number) in residual_rows(residuals) {
        object.insert(key.trim_start_matches("residual_").into(), number.into());
    }
    object.insert("worst".into(), json!(residuals.worst));
    Value::Object(object)
}
