//! A report as JSON. Keys are described in docs/terrain.md.

use serde_json::{Map, Value, json};

use super::accuracy::{Accuracy, Group, POINTS_MIN};
use super::classes::class_name;
use super::lines::{self, Overlap};
use super::sample::Differences;
use super::tally::{Density, Tally};
use super::{Cover, Figures, Report, Units};
use spmesh_formats::crs;

/// Changes when a key gets another meaning.
const VERSION: u32 = 1;

impl Report {
    /// The report as JSON, which does not depend on when and where it is made. What is not known is null.
    pub fn json(&self) -> Value {
        let units = Units::of(&self.crs);
        json!({
            "spreport": VERSION,
            "points_of": self.name,
            "mesh": self.mesh.as_ref().map(|(name, triangles)| json!({"name": name, "triangles": triangles})),
            "crs": crs::name(&self.crs),
            "units": {"horizontal": units.horizontal, "vertical": units.vertical},
            "points": points(&self.tally),
            "classes": self.tally.classes.as_ref().map(|classes| {
                let row = |&(class, count): &(u8, u64)| {
                    json!({"class": class, "name": class_name(class), "count": count,
                        "share": share(count, self.tally.points)})
                };
                classes.iter().map(row).collect::<Vec<_>>()
            }),
            "flight_lines": self.tally.sources.as_ref().map(|sources| {
                let row = |(source, count): (&u16, &u64)| {
                    json!({"line": source, "count": count, "share": share(*count, self.tally.points)})
                };
                sources.iter().map(row).collect::<Vec<_>>()
            }),
            "density": self.tally.density.as_ref().map(density),
            "voids": self.cover.as_ref().map(voids),
            "overlap": self.overlap.as_ref().map(overlap),
            "check_points": self.accuracy.as_ref().map(check_points),
        })
    }
}

/// A part of a whole; 0 of nothing.
pub(super) fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

fn points(tally: &Tally) -> Value {
    let returns = tally.returns;
    json!({
        "count": tally.points,
        "withheld": tally.withheld,
        "not_finite": tally.invalid,
        "first_returns": returns.map(|[first, ..]| first),
        "last_returns": returns.map(|[_, last, _]| last),
        "single_returns": returns.map(|[.., single]| single),
        "min": tally.bounds.map(|bounds| bounds.min),
        "max": tally.bounds.map(|bounds| bounds.max),
    })
}

fn density(density: &Density) -> Value {
    let [least, low, median, high, greatest] = density.quantiles;
    json!({
        "cell": density.cell,
        "cells": density.cells,
        "area": density.area,
        "points": density.points,
        "pulses": density.pulses,
        "spacing": density.spacing,
        "of_cells": {"min": least, "p5": low, "median": median, "p95": high, "max": greatest},
        "far_cells": density.far,
    })
}

fn voids(cover: &Cover) -> Value {
    let area = cover.cell * cover.cell;
    json!({
        "cell": cover.cell,
        "cells": cover.cells,
        "area": cover.cells as f64 * area,
        "voids": cover.voids,
        "void_area": cover.voids as f64 * area,
        "void_share": share(cover.voids, cover.cells),
        "distribution": share(cover.quarters, 4 * cover.cells),
        "points_outside": cover.outside,
    })
}

fn overlap(overlap: &Overlap) -> Value {
    let pairs = overlap.pairs.iter().map(|(pair, found)| {
        let mut row = differences(found);
        row.insert("lines".to_string(), json!(pair));
        row
    });
    json!({
        "cell": overlap.cell,
        "slope_max": lines::SLOPE_MAX,
        "points_min": lines::POINTS_MIN,
        "all": overlap.all.as_ref().map(differences),
        "pairs": pairs.collect::<Vec<_>>(),
        "steep": overlap.steep,
        "percentiles_of_one_in": overlap.one_in,
    })
}

fn differences(found: &Differences) -> Map<String, Value> {
    let Differences { cells, mean, rmsd, percentile95, greatest } = found;
    let rows = [
        ("cells", json!(cells)),
        ("mean", json!(mean)),
        ("rmsdz", json!(rmsd)),
        ("p95", json!(percentile95)),
        ("max", json!(greatest)),
    ];
    rows.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
}

fn check_points(accuracy: &Accuracy) -> Value {
    let one = |group: &Group| figures(group, accuracy);
    let many = |groups: &[Group]| groups.iter().map(one).collect::<Vec<_>>();
    let cover = accuracy.by_cover.as_ref();
    json!({
        "name": accuracy.name,
        "count": accuracy.points,
        "outside": accuracy.outside,
        "check_accuracy": accuracy.of_survey,
        "all": one(&accuracy.all),
        "nva": cover.map(|[open, _]| one(open)),
        "vva": cover.map(|[_, vegetated]| one(vegetated)),
        "classes": many(&accuracy.by_class),
        "slopes": many(&accuracy.by_slope),
    })
}

fn figures(group: &Group, accuracy: &Accuracy) -> Value {
    let Some(Figures { count, mean, median, deviation, rmse, nmad, percentile95, min, max, skewness }) =
        &group.figures
    else {
        return json!({"name": group.name, "count": 0, "is_enough": false});
    };
    json!({
        "name": group.name, "count": count, "is_enough": *count >= POINTS_MIN,
        "mean": mean, "median": median, "std": deviation, "rmse_v1": rmse, "rmse_v": accuracy.rmse_v(*rmse),
        "nmad": nmad, "p95": percentile95, "min": min, "max": max, "skewness": skewness,
    })
}
