//! Notices and statistics of a run.

use std::time::Duration;

use crate::tess3::{Arithmetic, Method, Report, Stats};
use spmesh_shell::peak_memory;
use spmesh_shell::stats::{self, Row};

/// Notices about a model, usually none.
pub(super) fn degeneracy(report: &Report, models: usize) -> Vec<String> {
    let which = if models > 1 { format!("model {}: ", report.model) } else { String::new() };
    report.warnings().into_iter().map(|text| format!("{which}{text}")).collect()
}

/// What `--stats` prints.
pub(super) fn stats(stats: &Stats, method: &Method, elapsed: Duration) -> stats::Report {
    // Peak bytes of the kernel, for the model with the highest peak.
    let share = stats.sums.kernel_bytes as f64 / stats.atoms_max.max(1) as f64;
    let report = stats::Report::of(elapsed).times(times(stats)).counts(counts(stats, method));
    report.row("kernel bytes per point", format!("{share:.1}")).entry("kernel_bytes_per_point", share)
}

/// Times. With the counts these are the columns of thesis table 3.3, as far as they were measured.
fn times(stats: &Stats) -> impl Iterator<Item = Row<Duration>> {
    let times = stats.sums.times;
    let rows = [
        ("reading (s)", "seconds_read", Some(times.read)),
        ("triangulating (s)", "seconds_triangulate", Some(times.triangulate)),
        ("  ordering (s)", "seconds_order", Some(times.order)),
        ("  point location (s)", "seconds_locate", measured(times.locate)),
        ("  predicates (s)", "seconds_predicates", measured(times.predicates)),
        ("  update (s)", "seconds_update", measured(times.update)),
        ("writing (s)", "seconds_write", Some(times.write)),
    ];
    rows.into_iter().filter_map(|(label, key, time)| Some((label, key, time?)))
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
        Arithmetic::Exact => rows.extend(predicates.rows()),
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
