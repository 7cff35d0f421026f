//! The notices and statistics of a fit.

use std::time::Duration;

use serde_json::{Value, json};

use crate::fitting::{Choice, FailedTrial};
use crate::splinefit::{
    EXCESS_MAX, Extent, Fitted, Level, Levels, PERCENTILES, Report, SmoothingChoice, Spline, Statistics,
    Stop, Stretch, Validated,
};
use spmesh_base::error::counted;
use spmesh_shell::peak_memory;
use spmesh_shell::stats::{self, Row};

/// Notices for the user.
pub(super) fn notices(report: &Report, spline: &Spline, rejected: Option<u64>) -> Vec<String> {
    let mut notices = Vec::new();
    let functions = spline.layout.basis.len();
    if let Some(search) = &report.search {
        let (tolerance, most) = (search.goal.tolerance, search.goal.max_knots);
        let knots = spline.layout.places();
        let above = search.rounds.last().map_or(0, |round| round.above);
        let outcome = match search.is_reached {
            true => "reached".into(),
            false => format!("{} farther off", counted(above, "point is", "points are")),
        };
        notices.push(format!(
            "{knots} knots (at most {most}), {functions} functions, tolerance {}: {outcome}",
            short(tolerance)
        ));
    }
    if let Some(reason) = &report.failure {
        notices.push(format!("the search for knots failed, so they follow the density of points: {reason}"));
    }
    if let Some(Stretch { ratio, angle, .. }) = report.stretch {
        notices.push(format!(
            "values vary {} times more slowly along {angle} degrees than across, as --anisotropy or the sides of the \
             box of points tell (with --anisotropy 1, coordinates stay as they are)",
            short(ratio)
        ));
    }
    notices.extend(report.levels.as_ref().map(|levels| of_levels(levels, report, spline)));
    if let Some((sites, pure_error)) = report.sites {
        let error = pure_error
            .map(|error| format!("; points of one place differ by {} (standard deviation)", short(error)));
        notices.push(format!(
            "{} at {}{}",
            counted(report.points, "point", "points"),
            counted(sites, "place", "places"),
            error.unwrap_or_default()
        ));
    }
    if let Some(chosen) = &report.chosen {
        if let Some(undetermined @ 1..) = chosen.undetermined {
            notices.push(format!(
                "points leave {undetermined} of {functions} functions undetermined: these alone are smoothed"
            ));
        }
        if !chosen.is_solved {
            let remedy = "smooth all with --lambda reml";
            notices.push(format!("the energy of undetermined functions may not be the least: {remedy}"));
        }
        if let Some(choice) = &chosen.choice {
            notices.extend(of_choice(choice, chosen));
        }
    }
    if let Some((scale, has_settled)) = report.scale {
        notices.push(format!("standard deviation of points: {}", short(scale)));
        if !has_settled {
            notices
                .push("robust weights did not settle in 50 rounds: the fit is that of the last one".into());
        }
    }
    if let Some(rejected) = rejected {
        notices.push(format!("{rejected} of {} rejected", counted(report.points, "point", "points")));
    }
    if report.residuals.outside > 0 {
        notices.push(outside(&report.residuals));
    }
    notices.extend(excess(&report.residuals));
    notices
}

/// How many knots there are, and why there are no more.
fn of_levels(levels: &Levels, report: &Report, spline: &Spline) -> String {
    let (knots, functions) = (spline.layout.places(), spline.layout.basis.len());
    let quality = report.chosen.as_ref().and_then(|chosen| chosen.quality);
    let noise = quality.map(|quality| quality.noise).filter(|noise| noise.is_finite());
    let noise = noise.map(|noise| format!(", noise {}", short(noise))).unwrap_or_default();
    let why = match levels.stop {
        Stop::Noise => ": more knots predict no better, what is left is noise",
        Stop::Rounding => ": what is left are rounding errors of the values",
        Stop::Density => ": as dense as points allow",
        Stop::Given => "",
    };
    let rms = short(report.residuals.root_mean_square);
    format!("{knots} knots, {functions} functions, rms {rms}{noise}{why}")
}

/// Notices about a chosen `lambda` and its tension.
fn of_choice(choice: &Choice, chosen: &SmoothingChoice) -> Vec<String> {
    let tension = chosen.tension;
    let floor = if chosen.is_raised {
        ", which predicts better than what is likeliest"
    } else if choice.is_at_floor() {
        ", the least that the distance of points allows"
    } else {
        ""
    };
    let tension = if tension > 0.0 { format!(" and tension {}", short(tension)) } else { String::new() };
    let mut notices = vec![format!("smoothed with lambda {}{tension}{floor}", short(chosen.lambda))];
    if let Some(first) = choice.failed.first() {
        let all = choice.failed.len() + choice.trials.len();
        notices.push(format!(
            "the search passed over {} of {all} values of lambda, as no spline has them; of {} it found: {}",
            choice.failed.len(),
            short(first.lambda),
            first.reason
        ));
    }
    notices
}

/// The outcome of cross-validation.
pub(super) fn of_validation(validated: &Validated) -> String {
    let outside = match validated.outside {
        0 => String::new(),
        outside => {
            format!(" ({} outside of the domain of the others)", counted(outside, "point is", "points are"))
        }
    };
    format!(
        "cross-validation of {}: rms {}, mean {}, intervals of 95 % hold {:.1} %{outside}",
        counted(validated.predictions.len() as u64, "point", "points"),
        short(validated.root_mean_square()),
        short(validated.mean()),
        100.0 * validated.held(),
    )
}

/// The warning about a spline that leaves the range of elevations.
pub(super) fn excess(residuals: &Statistics) -> Option<String> {
    let excess = residuals.excess().filter(|excess| excess.share > EXCESS_MAX)?;
    let [low, high] = residuals.range?;
    let [x, y] = excess.place;
    Some(format!(
        "warning: the spline is {} at {x} {y}, but elevations are between {} and {}: smooth more, or give \
         points there",
        short(excess.value),
        short(low),
        short(high)
    ))
}

/// A number with four digits.
fn short(number: f64) -> String {
    let rounded = format!("{number:.3e}");
    match number.abs() {
        0.0 => "0".into(),
        // Without trailing zeros after the point.
        1e-4..1e6 => rounded.parse().map_or(rounded, |number: f64| number.to_string()),
        _ => rounded,
    }
}

/// The notice about points outside of the domain.
pub(super) fn outside(residuals: &Statistics) -> String {
    let all = residuals.count + residuals.outside;
    format!("{} of {all} points are outside of the domain, and do not count", residuals.outside)
}

/// What `--stats` prints.
pub(super) fn stats(
    fitted: &Fitted,
    rejected: Option<u64>,
    validated: Option<&Validated>,
    seed: u64,
    time: Duration,
    output_bytes: u64,
) -> stats::Report {
    let report = stats::Report::of(time).counts(count_rows(fitted, rejected, seed, output_bytes));
    let report = number_rows(fitted).into_iter().fold(report, |report, (label, key, number)| {
        report.row(label, format!("{number:.6e}")).entry(key, number)
    });
    let validation = validated.map(|validated| {
        json!({
            "points": validated.predictions.len(), "outside": validated.outside, "mean": validated.mean(),
            "rms": validated.root_mean_square(), "held": validated.held(),
        })
    });
    details(report, &fitted.report).entry("validation", json!(validation))
}

fn count_rows(fitted: &Fitted, rejected: Option<u64>, seed: u64, output_bytes: u64) -> Vec<Row<u64>> {
    let Fitted { spline, report, .. } = fitted;
    let mut rows = vec![
        ("points", "points", report.points),
        ("points outside of the domain", "outside", report.residuals.outside),
        ("degree", "degree", spline.layout.basis.degree() as u64),
        ("knots", "knots", spline.layout.places() as u64),
        ("functions", "functions", spline.layout.basis.len() as u64),
    ];
    if let Some(search) = &report.search {
        rows.push(("rounds", "rounds_count", search.rounds.len() as u64));
        rows.push(("tolerance reached", "is_reached", search.is_reached.into()));
    }
    rows.extend(report.sites.map(|(sites, _)| ("places", "places", sites)));
    let undetermined = report.chosen.as_ref().and_then(|chosen| chosen.undetermined);
    rows.extend(undetermined.map(|count| ("undetermined functions", "undetermined", count as u64)));
    rows.extend(rejected.map(|count| ("rejected points", "rejected", count)));
    rows.push(("seed", "seed", seed));
    rows.push(("output (bytes)", "output_bytes", output_bytes));
    rows.push(("peak memory (bytes)", "peak_memory_bytes", peak_memory()));
    rows
}

fn number_rows(fitted: &Fitted) -> Vec<Row<f64>> {
    let report = &fitted.report;
    let mut rows = Vec::new();
    rows.extend(report.search.as_ref().map(|search| ("tolerance", "tolerance", search.goal.tolerance)));
    rows.extend(report.chosen.as_ref().map(|chosen| ("lambda", "lambda", chosen.lambda)));
    rows.extend(report.chosen.as_ref().map(|chosen| ("tension", "tension", chosen.tension)));
    let quality = report.chosen.as_ref().and_then(|chosen| chosen.quality);
    rows.extend(quality.map(|quality| ("noise", "noise", quality.noise)));
    rows.extend(quality.map(|quality| ("effective parameters", "parameters", quality.parameters)));
    rows.extend(report.sites.and_then(|(_, error)| Some(("noise at one place", "pure_error", error?))));
    rows.extend(report.scale.map(|(scale, _)| ("standard deviation", "scale", scale)));
    rows.extend(residual_rows(&report.residuals));
    rows
}

/// Residuals in numbers.
pub(super) fn residual_rows(residuals: &Statistics) -> Vec<Row<f64>> {
    const LABELS: [(&str, &str); PERCENTILES.len()] = [
        ("  median of magnitudes", "residual_median"),
        ("  75 % are below", "residual_75"),
        ("  90 % are below", "residual_90"),
        ("  95 % are below", "residual_95"),
        ("  99 % are below", "residual_99"),
    ];
    let whole = [
        ("residuals: greatest", "residual_max", residuals.greatest),
        ("  root of mean square", "residual_rms", residuals.root_mean_square),
        ("  mean", "residual_mean", residuals.mean),
    ];
    let parts = LABELS.iter().zip(residuals.percentiles).map(|(&(label, key), number)| (label, key, number));
    whole.into_iter().chain(parts).collect()
}

/// Adds details for JSON only: rounds and trials.
fn details(mut details: stats::Report, report: &Report) -> stats::Report {
    if let Some(search) = &report.search {
        let round = |round: &crate::fitting::Round| {
            json!({
                "knots": round.knots, "functions": round.functions, "residual_max": round.greatest,
                "residual_rms": round.root_mean_square, "above": round.above,
            })
        };
        let rounds: Value = search.rounds.iter().map(round).collect();
        details = details.entry("rounds", rounds);
    }
    if let Some(levels) = &report.levels {
        let level = |level: &Level| {
            json!({
                "step": level.step, "knots": level.knots, "lambda": level.lambda, "score": level.score,
                "noise": level.noise, "residual_rms": level.residual, "correlation": level.correlation,
            })
        };
        let all: Value = levels.levels.iter().map(level).collect();
        let stop = match levels.stop {
            Stop::Noise => "noise",
            Stop::Rounding => "rounding",
            Stop::Density => "density",
            Stop::Given => "given",
        };
        details = details.entry("distance", levels.distance).entry("levels", all).entry("stop", stop);
    }
    let stretch = report.stretch.map(|Stretch { ratio, angle, .. }| json!({"ratio": ratio, "angle": angle}));
    details = details.entry("anisotropy", json!(stretch));
    let extent = extent_json(report.residuals.extent.as_ref());
    details = details.entry("range", json!(report.residuals.range)).entry("extent", extent);
    if let Some(choice) = report.chosen.as_ref().and_then(|chosen| chosen.choice.as_ref()) {
        let trial = |trial: &crate::fitting::Trial| json!({"lambda": trial.lambda, "score": trial.score});
        let failed = |trial: &FailedTrial| json!({"lambda": trial.lambda, "reason": trial.reason});
        let [trials, failed]: [Value; 2] =
            [choice.trials.iter().map(trial).collect(), choice.failed.iter().map(failed).collect()];
        details = details.entry("trials", trials).entry("failed_trials", failed);
    }
    details
}

/// The least and the greatest value of a spline, with their places.
pub(super) fn extent_json(extent: Option<&Extent>) -> Value {
    let of = |(value, place): (f64, [f64; 2])| json!({"value": value, "at": place});
    extent.map_or(Value::Null, |extent| json!({"least": of(extent.least), "greatest": of(extent.greatest)}))
}
