//! Columns of tables: their types.

use spmesh_delaunay::predicates::Point3;
use spmesh_formats::sink::{Column, ColumnKind};

/// The columns that a line names, with tabs between them. Names have the same type in all tables.
pub(super) fn columns(line: &str) -> Vec<Column> {
    let column = |name: &str| Column { name: name.to_string(), kind: kind(name) };
    line.trim_end().split('\t').map(column).collect()
}

/// The type of the column of a name; numbers unless it is listed.
fn kind(name: &str) -> ColumnKind {
    match name.trim_end_matches(|c: char| c.is_ascii_digit()) {
        "model" | "serial" | "tetrahedra" | "atoms" | "contacts" | "pocket" | "mouth" | "mouths" => {
            ColumnKind::Integer
        }
        "kind" | "atom" | "residue" | "chain" | "molecule" => ColumnKind::Text,
        _ => ColumnKind::Number,
    }
}

/// Distance of two points.
pub(super) fn distance([p, q]: [Point3; 2]) -> f64 {
    (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt()
}
