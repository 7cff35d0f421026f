//! Texts of lines x y z t or x y z t value.

use crate::source::origin::{Bytes, Origin};
use crate::text::lines::{Lines, number, quote};
use crate::text::read::{Delimiter, delimiter_of, fields, without_comment};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::Point4;

/// A text of points whose columns are known.
#[derive(Debug)]
pub(crate) struct Text {
    origin: Origin,
    columns: Columns,
}

/// The columns of a line.
#[derive(Debug, PartialEq)]
struct Columns {
    delimiter: Delimiter,
    count: usize,
    axes: [usize; 4],
    value: Option<usize>,
    /// Line of the names of the columns, if there is one.
    names_line: Option<u64>,
}

/// Finds the columns from the first line of points and any names above it.
pub(crate) fn open(origin: Origin) -> Result<Text> {
    let mut lines = read(&origin)?;
    let mut names: Option<(u64, Vec<String>)> = None;
    while let Some(line) = lines.next_trimmed()? {
        let line = without_comment(line);
        if line.is_empty() {
            continue;
        }
        let delimiter = delimiter_of(line);
        let is_names = names.is_none() && fields(line, delimiter).all(|field| number(field).is_none());
        if is_names {
            let text = |field: &[u8]| String::from_utf8_lossy(field).into_owned();
            let fields = fields(line, delimiter).map(text).collect();
            names = Some((lines.number(), fields));
            continue;
        }
        let count = fields(line, delimiter).count();
        let columns = columns(delimiter, count, names).map_err(|e| e.at(lines.position()))?;
        return Ok(Text { origin, columns });
    }
    Err(match names {
        Some((line, _)) => Error::malformed("expected a line of x y z t").at(format!("line {line}")),
        None => Error::malformed("found no point"),
    })
}

/// The columns for lines of `count` fields and these names above them.
fn columns(delimiter: Delimiter, count: usize, names: Option<(u64, Vec<String>)>) -> Result<Columns> {
    let mut columns = Columns { delimiter, count, axes: [0, 1, 2, 3], value: None, names_line: None };
    let named = match &names {
        Some((line, names)) if names.len() != count => {
            let message = format!("found {count} columns, but line {line} has names for {}", names.len());
            return Err(Error::malformed(message));
        }
        Some((line, names)) => {
            columns.names_line = Some(*line);
            named(names)
        }
        None => None,
    };
    if let Some(axes) = named {
        columns.axes = axes;
        let names = names.map(|(_, names)| names).unwrap_or_default();
        let is_other = |column: &usize| !axes.contains(column);
        columns.value = match count {
            5 => (0..count).find(is_other),
            _ => names.iter().position(|name| is_name(name, &["value", "v"])),
        };
        return Ok(columns);
    }
    columns.value = match count {
        4 => None,
        5 => Some(4),
        _ => {
            let message = format!("found {count} columns, expected x y z t or x y z t value");
            return Err(Error::malformed(message));
        }
    };
    Ok(columns)
}

/// The columns named x, y, z and t, in any order; `None` if one is missing.
fn named(names: &[String]) -> Option<[usize; 4]> {
    let column = |usual: &[&str]| names.iter().position(|name| is_name(name, usual));
    Some([column(&["x"])?, column(&["y"])?, column(&["z"])?, column(&["t", "time"])?])
}

fn is_name(name: &str, usual: &[&str]) -> bool {
    usual.iter().any(|usual| name.eq_ignore_ascii_case(usual))
}

fn read(origin: &Origin) -> Result<Lines<Bytes>> {
    Ok(Lines::new(origin.plain()?, ""))
}

impl Text {
    /// Whether there is a column of values.
    pub(crate) fn has_values(&self) -> bool {
        self.columns.value.is_some()
    }

    /// Passes the points of all lines to `visit`.
    pub(crate) fn scan(&self, visit: &mut dyn FnMut(Point4, Option<f64>) -> Result<()>) -> Result<()> {
        let mut lines = read(&self.origin)?;
        while let Some(line) = lines.next_trimmed()? {
            let line = without_comment(line);
            if line.is_empty() {
                continue;
            }
            match self.columns.parse(line) {
                Ok((point, value)) => visit(point, value)?,
                Err(_) if self.columns.names_line == Some(lines.number()) => {}
                Err(error) => return Err(error.at(lines.position())),
            }
        }
        Ok(())
    }
}

impl Columns {
    fn parse(&self, line: &[u8]) -> Result<(Point4, Option<f64>)> {
        let (mut point, mut value, mut count) = ([0.0; 4], None, 0);
        for (column, field) in fields(line, self.delimiter).enumerate() {
            count += 1;
            let expected = |what: &str| {
                let found = quote(field);
                Error::malformed(format!("found {found} in column {}, expected {what}", column + 1))
            };
            if let Some(axis) = self.axes.iter().position(|&wanted| wanted == column) {
                let coordinate = number(field).filter(|number| number.is_finite());
                // Adding 0.0 turns -0.0 into 0.0.
                point[axis] = coordinate.ok_or_else(|| expected("a finite number"))? + 0.0;
            } else if self.value == Some(column) {
                value = Some(number(field).ok_or_else(|| expected("a number"))?);
            }
        }
        if count != self.count {
            let columns = if count == 1 { "column" } else { "columns" };
            let message = format!("found {count} {columns}, but {} in the first line of points", self.count);
            return Err(Error::malformed(message));
        }
        Ok((point, value))
    }
}
