//! Points of a text that is held in memory, with what one of its columns says.

use crate::source::labelled::{LabelledPoints, Labels};
use crate::source::origin::Origin;
use crate::source::pass::Stated;
use crate::text::columns::{self, Columns};
use crate::text::lines::Lines;
use crate::text::options::{Column, TextOptions};
use crate::text::read::{fields, parse};
use spmesh_base::error::{Error, Result};

/// Reads a text of points with elevations.
///
/// # Errors
/// If a line is no point with finite coordinates; usage, if there is no elevation or no such column.
pub(crate) fn read(
    origin: &Origin,
    label: Option<&Column>,
    layout: &TextOptions,
    found: &mut LabelledPoints,
) -> Result<()> {
    let (columns, stated) = columns::state(origin.plain()?, layout, &mut found.notices)?;
    if stated.has_z == Some(false) {
        return Err(Error::usage("points have no elevation: give lines of x y z, or choose their --columns"));
    }
    let label = label.map(|label| column_of(label, &columns, &stated)).transpose()?;
    let (mut lines, mut labels) = (Lines::new(origin.plain()?, ""), Labels::default());
    layout.skip(&mut lines)?;
    while lines.next_trimmed()?.is_some() {
        let line = layout.content(lines.current().trim_ascii());
        if line.is_empty() {
            continue;
        }
        let at_line = |e: Error| e.at(lines.position());
        let point = match parse(line, &columns) {
            Ok(point) => point,
            Err(_) if columns.names_line == Some(lines.number()) => continue,
            Err(error) => return Err(at_line(error)),
        };
        let said = label.and_then(|column| fields(line, columns.delimiter).nth(column));
        let said = said.map(|said| String::from_utf8_lossy(said).into_owned());
        labels.number(said).and_then(|number| found.put(point, number)).map_err(at_line)?;
    }
    found.labels = labels.finish();
    Ok(())
}

/// The place of a column beside the coordinates in a line.
fn column_of(label: &Column, columns: &Columns, stated: &Stated) -> Result<usize> {
    let names: Vec<&str> = stated.offers.iter().map(|offer| offer.attribute.name.as_str()).collect();
    let place = match label {
        Column::Number(number) => columns.others.iter().position(|&other| other + 1 == *number),
        Column::Name(name) => names.iter().position(|own| own.eq_ignore_ascii_case(name)),
    };
    let shown = match label {
        Column::Number(number) => number.to_string(),
        Column::Name(name) => format!("\"{name}\""),
    };
    place.and_then(|place| columns.others.get(place).copied()).ok_or_else(|| {
        let others = if names.is_empty() { "none".to_string() } else { names.join(", ") };
        Error::usage(format!(
            "there is no column {shown} beside x, y and z (--class-field): there is {others}"
        ))
    })
}
