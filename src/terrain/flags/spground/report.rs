//! The report, and the counts of `--stats`.

use serde_json::json;

use super::{Finished, Flags};
use crate::ground::{Class, Parameters};
use spmesh_shell::peak_memory;
use spmesh_shell::stats::Row;

impl Flags {
    /// What is ground.
    pub(super) fn parameters_json(&self) -> serde_json::Value {
        let Parameters {
            cell,
            window,
            slope,
            residual_slope,
            step,
            reach,
            threshold,
            scaling,
            pit,
            highest,
            gap,
        } = self.parameters.parameters();
        json!({
            "cell": cell, "window": window, "slope": slope, "residual_slope": residual_slope, "rise": step,
            "reach": reach, "threshold": threshold, "scaling": scaling, "pit": pit, "max_height": highest, "noise_gap": gap,
        })
    }

    /// The report. A mesh has no points of each class.
    pub(super) fn report_of(&self, finished: &Finished) -> serde_json::Value {
        let Finished { found, counts, files, .. } = finished;
        let mut report = json!({ "parameters": self.parameters_json() });
        if let Some(found) = found {
            report["points"] = json!(found.points);
            report["cells"] = json!(found.cells);
            report["noise_cells"] = json!(found.noise);
            report["object_cells"] = json!(found.objects);
            report["triangles"] = json!(found.triangles);
        }
        if self.mesh().is_none() {
            let classes = Class::ALL.iter().zip(counts.classes);
            report["files"] = json!(files);
            report["points_written"] = json!(counts.points);
            report["kept"] = json!(counts.kept);
            report["classes"] =
                classes.map(|(class, count)| ((*class as u8).to_string(), json!(count))).collect();
        }
        report
    }
}

/// The counts of `--stats`.
pub(super) fn rows(Finished { found, counts, .. }: &Finished) -> Vec<Row<u64>> {
    let found = found.clone().unwrap_or_default();
    let mut rows = vec![
        ("points", "points", found.points),
        ("cells", "cells", found.cells),
        ("cells of noise", "noise_cells", found.noise),
        ("triangles of the surface", "triangles", found.triangles),
    ];
    if counts.points > 0 {
        let [other, ground, low, high] = counts.classes;
        rows.extend([
            ("points of the ground (2)", "ground", ground),
            ("low noise (7)", "low_noise", low),
            ("high noise (18)", "high_noise", high),
            ("other points (1)", "other", other),
            ("points that kept their class", "kept", counts.kept),
        ]);
    }
    rows.push(("peak memory (bytes)", "peak_memory_bytes", peak_memory()));
    rows
}
