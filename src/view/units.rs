//! Names of the units of a picture.

use spmesh_formats::crs::System;
use spmesh_stream::Crs;

/// The units of a stream.
#[derive(Debug, Clone)]
pub(super) struct Units {
    /// What lengths of the plan are called.
    pub(super) plan: String,
    /// What heights are called, if that is known.
    heights: Option<String>,
    /// Units of the plan that one unit of height is.
    pub(super) of_heights: f64,
}

impl Units {
    pub(super) fn of(crs: &Crs) -> Units {
        let system = System::of(crs);
        let plan = system.horizontal.as_ref().map(|horizontal| horizontal.unit.symbol.clone());
        Units {
            plan: plan.unwrap_or_else(|| "units".into()),
            heights: system.vertical.as_ref().map(|vertical| vertical.unit.symbol.clone()),
            of_heights: system.vertical_ratio().unwrap_or(1.0),
        }
    }

    /// The label of elevations.
    pub(super) fn elevation(&self) -> String {
        self.heights.as_ref().map_or("Elevation".into(), |unit| format!("Elevation ({unit})"))
    }
}
