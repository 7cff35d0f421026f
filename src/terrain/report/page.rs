//! A report as one page of HTML that needs nothing else: styles and pictures are in it.

use data_encoding::BASE64;

use super::accuracy::{Accuracy, Group, POINTS_MIN};
use super::classes::class_name;
use super::figures::percentile;
use super::json::share;
use super::sample::Differences;
use super::tables::{escaped, fixed, percent, table, whole};
use super::{Cover, Density, Figures, Overlap, Picture, Report, Units, lines};
use spmesh_base::error::Result;
use spmesh_formats::crs;
use spmesh_formats::raster::colour_map::{Colour, VIRIDIS, hex, mix};
use spmesh_formats::raster::png;

const STYLE: &str = include_str!("page.css");
/// Colours of a map, beside that of what has no value.
const COLOURS: u8 = 255;
/// Grey where there are no voids, and colours from few voids to all.
const NO_VOID: Colour = [200, 200, 200];
const VOIDS: [Colour; 2] = [[253, 208, 120], [190, 10, 30]];
/// Bars of the distribution of differences.
const BARS: usize = 31;
/// Flight lines in a table, or pairs of them, at most; JSON has all.
const ROWS_MAX: usize = 200;

impl Report {
    /// The report as a page.
    ///
    /// # Errors
    /// If there is no memory for pictures.
    pub fn page(&self) -> Result<String> {
        let units = Units::of(&self.crs);
        let mut body = format!("<h1>Report on {}</h1>\n", escaped(&self.name));
        body += &format!("<p class=\"about\">{}</p>\n", escaped(&self.about(&units)));
        body += &self.key_figures(&units);
        body += &self.points(&units);
        body += &self.overlap.as_ref().map_or(String::new(), |overlap| overlap_tables(overlap, &units));
        body += &self.accuracy.as_ref().map_or(String::new(), |accuracy| accuracy_tables(accuracy, &units));
        body += &self.maps(&units)?;
        let title = escaped(&self.name);
        Ok(format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>Report on {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n\
             </html>\n"
        ))
    }

    fn about(&self, units: &Units) -> String {
        let system = crs::name(&self.crs).unwrap_or_else(|| "no coordinate reference system".to_string());
        let mesh = match &self.mesh {
            Some((name, triangles)) => format!("; mesh {name} of {} triangles", whole(*triangles)),
            None => String::new(),
        };
        let Units { horizontal, vertical } = units;
        format!(
            "{system}; x and y in {horizontal}, z in {vertical}{mesh}; made by spreport {}",
            env!("CARGO_PKG_VERSION")
        )
    }

    fn key_figures(&self, Units { horizontal, vertical }: &Units) -> String {
        let mut keys = vec![("points", whole(self.tally.points))];
        if let Some(density) = &self.tally.density {
            keys.push(("pulse density", format!("{} per {horizontal}²", fixed(density.pulses, 2))));
            keys.push(("pulse spacing", format!("{} {horizontal}", fixed(density.spacing, 3))));
        }
        if let Some(cover) = &self.cover {
            keys.push(("area of voids", percent(share(cover.voids, cover.cells))));
        }
        if let Some(all) = self.overlap.as_ref().and_then(|overlap| overlap.all.as_ref()) {
            keys.push(("RMSDz of flight lines", format!("{} {vertical}", fixed(all.rmsd, 3))));
        }
        if let Some(accuracy) = &self.accuracy {
            let [open, vegetated] = match &accuracy.by_cover {
                Some([open, vegetated]) => [("RMSE V1, NVA", open), ("RMSE V1, VVA", vegetated)],
                None => [("RMSE V1", &accuracy.all); 2],
            };
            let groups = if accuracy.by_cover.is_some() { vec![open, vegetated] } else { vec![open] };
            for (name, figures) in
                groups.into_iter().filter_map(|(name, group)| Some((name, group.figures.as_ref()?)))
            {
                keys.push((name, format!("{} {vertical}", fixed(figures.rmse, 3))));
            }
        }
        let item = |(name, value): (&str, String)| {
            format!("<div><dt>{name}</dt><dd>{}</dd></div>\n", escaped(&value))
        };
        format!("<dl class=\"keys\">\n{}</dl>\n", keys.into_iter().map(item).collect::<String>())
    }

    /// Tables about the points.
    fn points(&self, units: &Units) -> String {
        let tally = &self.tally;
        let mut rows = vec![
            row("points", whole(tally.points)),
            row("withheld, left out", whole(tally.withheld)),
            row("with a coordinate that is not finite, left out", whole(tally.invalid)),
        ];
        let returns = ["first returns", "last returns", "single returns"]
            .into_iter()
            .zip(tally.returns.into_iter().flatten());
        rows.extend(returns.map(|(name, count)| row(name, whole(count))));
        let mut html = table("Counts", &["", "number"], &rows);
        html += &tally.density.as_ref().map_or(String::new(), |density| density_table(density, units));
        html += &self.cover.as_ref().map_or(String::new(), |cover| void_table(cover, units));
        let line = |name: String, count: u64| vec![name, whole(count), percent(share(count, tally.points))];
        if let Some(classes) = &tally.classes {
            let rows =
                classes.iter().map(|&(class, count)| line(format!("{class} {}", class_name(class)), count));
            html += &table("Classes", &["class", "points", "share"], &rows.collect::<Vec<_>>());
        }
        if let Some(sources) = &tally.sources {
            let rows = sources.iter().take(ROWS_MAX).map(|(source, &count)| line(source.to_string(), count));
            html += &table("Flight lines", &["line", "points", "share"], &rows.collect::<Vec<_>>());
        }
        format!("<h2>Points</h2>\n<div class=\"tables\">\n{html}</div>\n")
    }

    fn maps(&self, Units { horizontal, vertical }: &Units) -> Result<String> {
        let mut html = String::new();
        if let Some(density) = &self.tally.density {
            let mut values: Vec<f64> = density.picture.values().flatten().collect();
            values.sort_unstable_by(f64::total_cmp);
            let top = if values.is_empty() { 0.0 } else { percentile(&values, 98.0) };
            let top = if top > 0.0 { top } else { 1.0 };
            let ends = ["0".to_string(), format!("{} and more per {horizontal}²", fixed(top, 1))];
            let colour = |part: f64| VIRIDIS.at(part);
            html += &map(&density.picture, "Pulse density", horizontal, top, &colour, &ends)?;
        }
        if let Some(cover) = &self.cover {
            let colour = |part: f64| if part > 0.0 { mix(VOIDS[0], VOIDS[1], part) } else { NO_VOID };
            let ends = ["no void".to_string(), "all void".to_string()];
            html += &map(&cover.picture, "Voids", horizontal, 1.0, &colour, &ends)?;
        }
        if let Some(accuracy) = &self.accuracy {
            html += &histogram(accuracy, vertical);
        }
        Ok(format!("<h2>Pictures</h2>\n<div class=\"pictures\">\n{html}</div>\n"))
    }
}

/// A row of a name and what it is.
fn row(name: &str, value: String) -> Vec<String> {
    vec![name.to_string(), value]
}

fn density_table(density: &Density, Units { horizontal, .. }: &Units) -> String {
    let per = |density: f64| format!("{} per {horizontal}²", fixed(density, 2));
    let [least, low, median, high, greatest] = density.quantiles.map(per);
    let rows = [
        row("points", per(density.points)),
        row("first returns (pulse density)", per(density.pulses)),
        row("pulse spacing", format!("{} {horizontal}", fixed(density.spacing, 3))),
        row(&format!("cells of {} {horizontal} with points", density.cell), whole(density.cells)),
        row("their area", format!("{} {horizontal}²", whole(density.area.round() as u64))),
        row("pulse density of cells: least", least),
        row("5th percentile", low),
        row("median", median),
        row("95th percentile", high),
        row("greatest", greatest),
    ];
    table("Density", &["", "value"], &rows)
}

fn void_table(cover: &Cover, Units { horizontal, .. }: &Units) -> String {
    let area = |cells: u64| {
        let area = cells as f64 * cover.cell * cover.cell;
        format!("{} {horizontal}²", whole(area.round() as u64))
    };
    let rows = [
        row("side of cells (four pulse spacings)", format!("{} {horizontal}", cover.cell)),
        row("cells of the extent", whole(cover.cells)),
        row("area of the extent", area(cover.cells)),
        row("voids: cells without a first return", whole(cover.voids)),
        row("their area", area(cover.voids)),
        row("their share", percent(share(cover.voids, cover.cells))),
        row("quarters of cells with a first return", percent(share(cover.quarters, 4 * cover.cells))),
        row("points far from all others, left out", whole(cover.outside)),
    ];
    table("Voids", &["", "value"], &rows)
}

fn overlap_tables(overlap: &Overlap, Units { horizontal, vertical }: &Units) -> String {
    let row = |name: String, found: &Differences| {
        let Differences { cells, mean, rmsd, percentile95, greatest } = found;
        let numbers = [mean, rmsd, percentile95, greatest].map(|number| fixed(*number, 3));
        [vec![name, whole(*cells)], numbers.to_vec()].concat()
    };
    let all = overlap.all.iter().map(|all| row("all".to_string(), all));
    let pairs = overlap.pairs.iter().map(|([one, other], found)| row(format!("{one} - {other}"), found));
    let rows: Vec<_> = all.chain(pairs.take(ROWS_MAX)).collect();
    let head = ["lines", "cells", "mean", "RMSDz", "95th percentile", "greatest"];
    let mut notes = format!(
        "In cells of {} {horizontal} with at least {} single returns of each line, without vegetation, water and noise, on \
         slopes below {}°: the elevation of the first line minus that of the second. {} pairs were steeper, or too narrow.",
        overlap.cell,
        lines::POINTS_MIN,
        lines::SLOPE_MAX,
        whole(overlap.steep)
    );
    if overlap.one_in > 1 {
        notes += &format!(" Percentiles are those of one cell in {}.", whole(overlap.one_in));
    }
    let table = table(&format!("Differences of flight lines ({vertical})"), &head, &rows);
    format!("<h2>Flight lines</h2>\n{table}<p>{}</p>\n", escaped(&notes))
}

fn accuracy_tables(accuracy: &Accuracy, Units { vertical, .. }: &Units) -> String {
    let row = |group: &Group| {
        let Some(Figures { count, mean, median, deviation, rmse, nmad, percentile95, min, max, skewness }) =
            group.figures
        else {
            return vec![group.name.clone(), "0".to_string()];
        };
        let or_none = |value: Option<f64>| value.map_or("–".to_string(), |value| fixed(value, 3));
        let numbers = [Some(rmse), accuracy.rmse_v(rmse), Some(mean), Some(median), deviation, Some(nmad)];
        let ends = [Some(percentile95), Some(min), Some(max), skewness];
        let numbers = numbers.into_iter().chain(ends).map(or_none);
        [group.name.clone(), whole(count)].into_iter().chain(numbers).collect()
    };
    let head = [
        "check points",
        "number",
        "RMSE V1",
        "RMSE V",
        "mean",
        "median",
        "std",
        "NMAD",
        "95th |d|",
        "min",
        "max",
        "skewness",
    ];
    let cover = accuracy.by_cover.iter().flatten();
    let main: Vec<_> = [&accuracy.all].into_iter().chain(cover).map(row).collect();
    let mut html = format!(
        "<h2>Check points</h2>\n{}",
        table(&format!("Mesh minus check point ({vertical})"), &head, &main)
    );
    if !accuracy.by_class.is_empty() {
        html += &table("By class", &head, &accuracy.by_class.iter().map(row).collect::<Vec<_>>());
    }
    html += &table("By slope of the mesh", &head, &accuracy.by_slope.iter().map(row).collect::<Vec<_>>());
    let inside = accuracy.points - accuracy.outside;
    let mut notes = format!(
        "{} of {} check points of {} lie on the mesh.",
        whole(inside),
        whole(accuracy.points),
        accuracy.name
    );
    notes += &match accuracy.of_survey {
        Some(survey) => format!(" RMSE V has {survey} {vertical} as error of the check points (RMSE V2)."),
        None => " RMSE V needs the error of the check points (--check-accuracy).".to_string(),
    };
    if inside < POINTS_MIN {
        notes += &format!(" The standard of the ASPRS asks for {POINTS_MIN} check points at least.");
    }
    html + &format!("<p>{}</p>\n", escaped(&notes))
}

/// A map with its scale and legend. Values from 0 to `top` have colours.
fn map(
    picture: &Picture,
    title: &str,
    unit: &str,
    top: f64,
    colour: &dyn Fn(f64) -> Colour,
    ends: &[String; 2],
) -> Result<String> {
    let colours: Vec<Colour> = (0..=COLOURS)
        .map(|number| colour(f64::from(number.saturating_sub(1)) / f64::from(COLOURS - 1)))
        .collect();
    // Any value above zero has another colour than zero.
    let number = |value: f64| {
        1 + (value / top * f64::from(COLOURS - 1)).ceil().clamp(0.0, f64::from(COLOURS - 1)) as u8
    };
    let pixels: Vec<u8> = picture.values().map(|value| value.map_or(0, number)).collect();
    let image = BASE64.encode(&png(picture.columns as u32, &pixels, &colours)?);
    let width = picture.columns as f64 * picture.side;
    let bar = round_length(width / 3.0);
    let stops: Vec<String> = (0..=8u8).map(|stop| hex(colour(f64::from(stop) / 8.0))).collect();
    let [low, high] = ends.each_ref().map(|end| escaped(end));
    let (aspect, part, unit) =
        (picture.columns as f64 / picture.rows as f64, 100.0 * bar / width, escaped(unit));
    Ok(format!(
        "<figure>\n<figcaption>{title}</figcaption>\n<div class=\"map\" style=\"--aspect: {aspect:.5}\">\n\
         <img alt=\"{title}: a map of {} by {} pixels\" src=\"data:image/png;base64,{image}\">\n\
         <div class=\"scale\" style=\"width: {part:.3}%\"><span>{bar} {unit}</span></div>\n</div>\n\
         <div class=\"legend\"><span>{low}</span><span class=\"ramp\" style=\"background: linear-gradient(to right, \
         {})\"></span><span>{high}</span></div>\n</figure>\n",
        picture.columns,
        picture.rows,
        stops.join(", ")
    ))
}

/// The greatest of 1, 2, 5, 10 and so on that is not above `length`.
fn round_length(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    [5.0, 2.0].into_iter().map(|factor| factor * power).find(|round| *round <= length).unwrap_or(power)
}

/// The distribution of differences; nothing if all are the same.
fn histogram(accuracy: &Accuracy, unit: &str) -> String {
    let all = &accuracy.differences;
    if all.len() < 2 {
        return String::new();
    }
    let (low, high) = (percentile(all, 1.0), percentile(all, 99.0));
    if low == high {
        return String::new();
    }
    let mut counts = [0u64; BARS];
    for difference in all {
        let bar = ((difference - low) / (high - low) * BARS as f64) as usize;
        counts[bar.min(BARS - 1)] += 1;
    }
    let most = counts.into_iter().max().unwrap_or(1) as f64;
    let bars = counts.iter().enumerate().map(|(bar, &count)| {
        let height = 100.0 * count as f64 / most;
        format!("<rect x=\"{}\" y=\"{:.2}\" width=\"9\" height=\"{height:.2}\"/>", 10 * bar, 100.0 - height)
    });
    let bars: String = bars.collect();
    let [low, high, unit] = [fixed(low, 3), fixed(high, 3), escaped(unit)];
    format!(
        "<figure>\n<figcaption>Mesh minus check point</figcaption>\n<svg class=\"bars\" role=\"img\" aria-label=\"Distribution \
         of differences\" viewBox=\"0 0 {} 100\" preserveAspectRatio=\"none\">{bars}</svg>\n<div class=\"legend ends\">\
         <span>{low} {unit} and less</span><span>{high} {unit} and more</span></div>\n</figure>\n",
        10 * BARS - 1
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_of_scales_have_round_lengths() {
        for (length, expected) in [(33.0, 20.0), (50.0, 50.0), (0.9, 0.5), (1.1, 1.0), (4999.0, 2000.0)] {
            assert!((round_length(length) - expected).abs() < 1e-12, "{length}");
        }
    }
}
