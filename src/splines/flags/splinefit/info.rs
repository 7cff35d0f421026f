//! `splinefit info`: flags and output.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::report::{excess, extent_json, outside, residual_rows};
use super::{check_stdin, say};
use crate::splinefit::{
    Candidate, Condition, Excess, Extent, Jump, Layout, Points, Smoothness, Spline, Statistics, Summary,
};
use spmesh_base::error::{Error, Result, counted};
use spmesh_base::output::Output;
use spmesh_formats::detect::SPLINEFIT;
use spmesh_formats::raster::Window;
use spmesh_formats::source::SourceOptions;
use spmesh_shell::Common;
use spmesh_shell::messages::{escaped, escaped_json};
use spmesh_shell::resources::ThreadsFlag;

/// Segments that the text output lists.
const LISTED: usize = 5;

// Paragraphs are single lines: they are wrapped to the width of the terminal.
const NOTES: &str = "\
The condition is that of interpolation at Greville sites: in the 2-norm for up to 500 functions; for more, \
a lower estimate in the 1-norm. Splines of degree k have k - 1 continuous derivatives, except across \
segments between knots that are repeated or collinear with others. For degree 2, the gradients of \
functions on both sides of these segments are compared. Jumps are those of the spline: its value and \
gradient are continuous wherever knots do not allow a jump, which is exact; elsewhere both sides are \
compared at a few places of each segment, up to rounding. Residuals are elevations less values. The least \
and greatest value are searched near Greville sites and knots. With points, there is a warning if the \
spline leaves the range of elevations by more than a quarter of it.";

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
    threads: ThreadsFlag,
}

impl Flags {
    pub(super) fn run(&self, common: &Common) -> Result<()> {
        let points = self.points.iter().map(|path| ("points", path.as_path()));
        check_stdin([("the spline", self.spline.as_path())].into_iter().chain(points))?;
        // Fail before the work if stdout is closed.
        let mut output = Output::create(Path::new("-"), false)?;
        let Compared { layout, coefficients, extent, residuals } = self.compare()?;
        if let Some(residuals) = residuals.as_ref().filter(|residuals| residuals.outside > 0) {
            say(common, &outside(residuals));
        }
        residuals.as_ref().and_then(excess).iter().for_each(|text| say(common, text));
        let summary = Summary::of(&layout, coefficients.as_deref())?;
        let report = Report { summary: &summary, layout: &layout, extent, residuals: residuals.as_ref() };
        let text = match self.json {
            true => escaped_json(&format!("{}\n", report.json())),
            false => report.text(),
        };
        output.write_all(text.as_bytes()).map_err(|error| Error::io("printing", error))?;
        output.commit()
    }

    fn compare(&self) -> Result<Compared> {
        if self.points.is_empty() {
            let (layout, coefficients) = Layout::open(&self.spline)?;
            if coefficients.len() != layout.basis.len() {
                return Ok(Compared { layout, coefficients: None, extent: None, residuals: None });
            }
            let spline = Spline::new(layout, coefficients);
            let extent = Extent::of(&spline);
            let Spline { layout, coefficients, .. } = spline;
            return Ok(Compared { layout, coefficients: Some(coefficients), extent, residuals: None });
        }
        let spline = Spline::open(&self.spline)?;
        let options = SourceOptions { reader: &SPLINEFIT, holds_points: true, ..SourceOptions::default() };
        let points = Points::open(&self.points, &options, None, Vec::new(), false, |_| ())?;
        let found = Statistics::of(&spline, &points, |_| false, self.threads.get(), &|_| ())?;
        let Spline { layout, coefficients, .. } = spline;
        let (extent, residuals) = (found.extent, Some(found));
        Ok(Compared { layout, coefficients: Some(coefficients), extent, residuals })
    }
}

/// A layout, with coefficients and extent of a spline, and with residuals if points are given.
struct Compared {
    layout: Layout,
    coefficients: Option<Vec<f64>>,
    extent: Option<Extent>,
    residuals: Option<Statistics>,
}

/// What is printed.
struct Report<'a> {
    summary: &'a Summary,
    layout: &'a Layout,
    extent: Option<Extent>,
    residuals: Option<&'a Statistics>,
}

impl Report<'_> {
    fn text(&self) -> String {
        let mut text = text(self.summary, self.layout);
        if let Some(Extent { least, greatest }) = &self.extent {
            let of = |(value, [x, y]): &(f64, [f64; 2])| format!("{value} at {x} {y}");
            text += &line("values", &format!("from {} to {}", of(least), of(greatest)));
        }
        if let Some(residuals) = self.residuals {
            text += &residuals_text(residuals);
        }
        text
    }

    fn json(&self) -> Value {
        let mut object = json(self.summary, self.layout, self.residuals);
        object["extent"] = extent_json(self.extent.as_ref());
        object
    }
}

/// A line of text.
fn line(label: &str, value: &str) -> String {
    format!("{label:<12} {value}\n")
}

fn residuals_text(residuals: &Statistics) -> String {
    let mut text = line("residuals", &format!("of {}", counted(residuals.count, "point", "points")));
    for (label, _, value) in residual_rows(residuals) {
        text += &line("", &format!("{:<22} {value:.6e}", label.trim()));
    }
    if let Some([x, y]) = residuals.worst {
        text += &line("", &format!("{:<22} {x} {y}", "greatest at"));
    }
    let Some([low, high]) = residuals.range else { return text };
    let leaves = match residuals.excess() {
        None => String::new(),
        Some(Excess { value, place: [x, y], share }) => {
            format!("; the spline leaves this range by {:.2} % of it: {value} at {x} {y}", 100.0 * share)
        }
    };
    text + &line("elevations", &format!("from {low} to {high}{leaves}"))
}

fn text(summary: &Summary, layout: &Layout) -> String {
    let mut text = String::new();
    let mut line = |label: &str, value: String| text += &line(label, &value);
    line("degree", summary.degree.to_string());
    line("knots", format!("{} at {} places", summary.knots, summary.places));
    line("functions", summary.functions.to_string());
    line("crs", spmesh_formats::crs::name(&layout.frame.crs).map_or("unknown".into(), |name| escaped(&name)));
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
    if let Some(jumps) = &summary.smoothness.jumps {
        line("jumps", format!("of the value: {}", jump_text(&jumps.value)));
        line("", format!("of the gradient: {}", jump_text(&jumps.gradient)));
    }
    text
}

fn box_text(Window { min, max }: Window) -> String {
    format!("{} {} to {} {}", min[0], min[1], max[0], max[1])
}

fn smoothness_lines(smoothness: &Smoothness, layout: &Layout) -> Vec<(&'static str, String)> {
    let Smoothness { order, candidates, folds, .. } = smoothness;
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

/// The greatest jump, or that there is none.
fn jump_text(Jump { segments, greatest, at }: &Jump) -> String {
    match (segments, at) {
        (0, _) => "none (exact: knots exclude it)".into(),
        (_, None) => format!("none found, across {segments} segments where knots allow it"),
        (_, Some([x, y])) => {
            format!("up to {greatest:e}, at {x} {y}, across {segments} segments where knots allow it")
        }
    }
}

fn jump_json(Jump { segments, greatest, at }: &Jump) -> Value {
    json!({"exact": *segments == 0, "segments": segments, "greatest": greatest, "at": at})
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
        "jumps": summary.smoothness.jumps.map(|jumps| {
            json!({"value": jump_json(&jumps.value), "gradient": jump_json(&jumps.gradient)})
        }),
    });
    json!({
        "degree": summary.degree,
        "knots": summary.knots,
        "places": summary.places,
        "functions": summary.functions,
        "crs": spmesh_formats::crs::name(&layout.frame.crs),
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
    object.insert("range".into(), json!(residuals.range));
    let excess = residuals.excess();
    let excess = excess.map(|e| json!({"value": e.value, "at": e.place, "share": e.share.min(f64::MAX)}));
    object.insert("excess".into(), excess.into());
    Value::Object(object)
}
