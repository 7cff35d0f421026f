//! Notices and statistics of a run.

use std::time::Duration;

use crate::tess3::{Arithmetic, Method, Report, Stats};
use spmesh_shell::rows::{Row, entries, lines, seconds};
use spmesh_shell::{StatsFormat, peak_memory, say};

/// Notices about a model, usually none.
pub(super) fn degeneracy(report: &Report, models: usize) -> Vec<String> {
    let which = if models > 1 { format!("model {}: ", report.model) } else { String::new() };
    report.warnings().into_iter().map(|text| format!("{which}{text}")).collect()
}

/// Prints what `--stats` asks for.
pub(super) fn print(format: Option<StatsFormat>, stats: &Stats, method: &Method, elapsed: Duration) {
    match format {
        Some(StatsFormat::Text) => say(&text(stats, method, elapsed)),
        Some(StatsFormat::Json) => say(&format!("{}\n", json(stats, method, elapsed))),
        None => {}
    }
}

/// Times in seconds. With the counts these are the columns of thesis table 3.3, as far as they were measured.
fn times(stats: &Stats, elapsed: Duration) -> Vec<Row<f64>> {
    let times = stats.sums.times;
    let rows = [
        ("time (s)", "seconds", Some(elapsed)),
        ("reading (s)", "seconds_read", Some(times.read)),
        ("triangulating (s)", "seconds_triangulate", Some(times.triangulate)),
        ("  ordering (s)", "seconds_order", Some(times.order)),
        ("  point location (s)", "seconds_locate", measured(times.locate)),
        ("  predicates (s)", "seconds_predicates", measured(times.predicates)),
        ("  update (s)", "seconds_update", measured(times.update)),
        ("writing (s)", "seconds_write", Some(times.write)),
    ];
    seconds(rows.into_iter().filter_map(|(label, key, time)| Some((label, key, time?))))
}

fn measured(time: Duration) -> Option<Duration> {
    (time > Duration::ZERO).then_some(time)
}

fn counts(stats: &Stats, method: &Method) -> Vec<Row<u64>> {
    let Stats { models, sums, atoms_max } = stats;
    let mut rows = vec![
        ("models", "models", *models),
        ("points", "points", sums.atoms),
        ("points of the largest model", "points_max", *atoms_max),
        ("vertices", "vertices", sums.vertices),
        ("tetrahedra", "tetrahedra", sums.tetrahedra),
        ("facets of the hull", "hull_facets", sums.hull_facets),
        ("tetrahedra created", "tetrahedra_created", sums.created),
        ("in-sphere tests", "in_sphere_tests", sums.in_sphere_tests),
        ("kernel memory (bytes)", "kernel_bytes", sums.kernel_bytes),
        ("peak memory (bytes)", "peak_memory_bytes", peak_memory()),
        ("seed", "seed", method.seed),
    ];
    let (predicates, rounding) = (sums.predicates, sums.rounding);
    match method.arithmetic {
        Arithmetic::Exact => rows.extend([
            ("predicates: filter", "predicates_filter", predicates.filter),
            ("predicates: integer", "predicates_integer", predicates.integer),
            ("predicates: pairs", "predicates_pairs", predicates.pairs),
            ("predicates: residues", "predicates_residues", predicates.residues),
            ("predicates: big integer", "predicates_bigint", predicates.bigint),
            ("predicates: ties broken", "predicates_perturbed", predicates.perturbed),
        ]),
        Arithmetic::Float { check_signs } => {
            rows.push(("points in no tetrahedron", "missing", rounding.missing));
            rows.push(("wrong tetrahedra", "violations", rounding.violations.unwrap_or_default()));
            if check_signs {
                rows.extend([
                    ("in-sphere: wrong signs", "wrong_signs", rounding.wrong_signs),
                    ("in-sphere: zeros not seen", "wrong_zeros", rounding.wrong_zeros),
                    ("in-sphere: rounded values", "rounded", rounding.rounded),
                ]);
            }
        }
    }
    rows
}

/// Peak bytes of the kernel per point, for the model with the highest peak.
fn bytes_per_point(stats: &Stats) -> f64 {
    stats.sums.kernel_bytes as f64 / stats.atoms_max.max(1) as f64
}

fn text(stats: &Stats, method: &Method, elapsed: Duration) -> String {
    lines(&times(stats, elapsed), counts(stats, method))
        + &format!("{:<30} {:>15.1}\n", "kernel bytes per point", bytes_per_point(stats))
}

fn json(stats: &Stats, method: &Method, elapsed: Duration) -> String {
    let mut object = entries(&times(stats, elapsed), counts(stats, method));
    object.insert("kernel_bytes_per_point".into(), bytes_per_point(stats).into());
    serde_json::Value::Object(object).to_string()
}
