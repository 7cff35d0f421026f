//! The system of lines, and that of the points.

use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::{System, differences};
use spmesh_stream::Crs;

/// Compares the system of the lines in a file with that of the points; returns a message for the user if only
/// one of them is known.
pub(crate) fn check(file: &str, lines: &Crs, points: &Crs) -> Result<Option<String>> {
    let (of_lines, of_points) = (System::of(lines), System::of(points));
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
    let (of_lines, of_points) = (name(&of_lines), name(&of_points));
    Err(Error::usage(format!(
        "the lines are in {of_lines}, the points in {of_points} ({}): transform the lines, for example with ogr2ogr \
         -t_srs {of_points}",
        found.join(", ")
    ))
    .of_input(file))
}
