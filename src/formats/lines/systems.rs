//! The system of lines, and that of the points.

use crate::crs::{Kind, System, differences, requested};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Crs;

/// What a file says about the system of its lines.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LineSystem {
    /// The system, if the file states one.
    pub crs: Crs,
    /// Whether the lines may be in degrees of WGS 84: those of GeoJSON are, by RFC 7946, and no member states
    /// it.
    pub may_be_degrees: bool,
}

impl LineSystem {
    /// Compares the system of the lines in a file with that of the points; returns a message for the user if
    /// only one of them is known.
    ///
    /// # Errors
    /// Usage, if they differ.
    pub fn check(&self, file: &str, points: &Crs) -> Result<Option<String>> {
        let (mut of_lines, of_points) = (System::of(&self.crs), System::of(points));
        let mut remark = "";
        let has_map = |system: &System| {
            system.horizontal.as_ref().is_some_and(|h| matches!(h.kind, Kind::Projected(..)))
        };
        if self.may_be_degrees && has_map(&of_points) {
            of_lines = System::of(&requested("EPSG:4326")?);
            remark = " (GeoJSON without the member crs)";
        }
        let name = |system: &System| system.name().unwrap_or_else(|| "a system without a name".to_string());
        if of_lines.horizontal.is_none() || of_points.horizontal.is_none() {
            let is_known = of_lines.horizontal.is_some() || of_points.horizontal.is_some();
            let (unknown, known) =
                if of_lines.horizontal.is_none() { ("lines", &of_points) } else { ("points", &of_lines) };
            let notice = || {
                format!(
                    "{file}: the {unknown} state no coordinate reference system: taking them to be in {}",
                    name(known)
                )
            };
            return Ok(is_known.then(notice));
        }
        let found = differences(&of_lines, &of_points);
        if found.is_empty() {
            return Ok(None);
        }
        Err(Error::usage(format!(
            "the lines are in {}{remark}, the points in {} ({}): transform the lines, for example with \
             ogr2ogr -t_srs{}",
            name(&of_lines),
            name(&of_points),
            found.join(", "),
            of_points.argument()
        ))
        .of_input(file))
    }
}
