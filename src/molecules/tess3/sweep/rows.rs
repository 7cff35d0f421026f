//! The rows of a sweep's summary: one for each mesh, or for a file that failed.

use std::path::Path;

use super::Sweep;
use super::file::{End, Model};
use crate::tess3::Report;
use spmesh_formats::ledger::{Columns, Row};
use spmesh_formats::sink::ColumnKind::{Integer, Number, Text};

/// The columns. Readers take them by name; new ones come last.
pub const COLUMNS: Columns = &[
    ("file", Text),
    ("model", Integer),
    ("atoms", Integer),
    ("unique_points", Integer),
    ("tetrahedra", Integer),
    ("hull_facets", Integer),
    ("seconds", Number),
    ("peak_memory_bytes", Integer),
    ("output", Text),
    ("output_bytes", Integer),
    ("options", Text),
    ("error", Text),
    ("warnings", Text),
    ("version", Text),
    ("input_bytes", Integer),
    ("input_modified", Text),
    ("input_sha256", Text),
    ("violations", Integer),
    ("topology_bytes", Integer),
    ("topology_modified", Text),
    ("topology_sha256", Text),
];

/// The rows of a file: one per model, or one for the failure.
pub(super) fn of(file: &Path, end: &End, sweep: &Sweep) -> Vec<Row> {
    let blank = || {
        let mut row = sweep.batch.row(file, end);
        row.set("peak_memory_bytes", end.noted.map_or(String::new(), |bytes| bytes.to_string()));
        row
    };
    let Ok(models) = &end.result else { return vec![blank()] };
    let row = |model: &Model| {
        let mut row = blank();
        let Model { report, output, bytes, warnings } = model;
        row.set("seconds", format!("{:.6}", report.times.total().as_secs_f64()));
        enter(report, &mut row);
        row.set("output", output.to_string_lossy());
        row.set("output_bytes", bytes.to_string());
        row.set("warnings", warnings.join("; "));
        row
    };
    models.iter().map(row).collect()
}

fn enter(report: &Report, row: &mut Row) {
    let Report { model, atoms, vertices, tetrahedra, hull_facets, .. } = report;
    row.set("model", model.to_string());
    row.set("atoms", atoms.to_string());
    if !report.is_of_cells {
        row.set("unique_points", vertices.to_string());
        row.set("tetrahedra", tetrahedra.to_string());
        row.set("hull_facets", hull_facets.to_string());
    }
    if let Some(violations) = report.rounding.violations {
        row.set("violations", violations.to_string());
    }
}
