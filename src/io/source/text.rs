//! Points as lines of text: xyz, csv and similar formats.

use super::lines::{Lines, number, quote};
use super::origin::Bytes;
use super::pass::{BATCH_POINTS, Pass, Stated};
use super::placement::Placement;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// The separator of a line's fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    WhiteSpace,
    Byte(u8),
}

/// The columns that hold the coordinates.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    delimiter: Delimiter,
    /// Columns of x, y and, if points have one, z.
    axes: Vec<usize>,
    /// Line of the column names, if there is one.
    names_line: Option<u64>,
    /// Whether the first line of points has only two columns, so that a third column in another line is an
    /// error.
    only_two: bool,
}

/// A line without numbers, before all points.
struct Names {
    line: u64,
    delimiter: Delimiter,
    fields: Vec<Vec<u8>>,
}

/// Finds the columns from the first line that is neither blank nor a comment and, if that holds the names of
/// the columns, from the next one. The pass checks the other lines.
///
/// # Errors
/// If the first line is neither a point nor names of columns, or if the names do not tell which columns are x
/// and y.
pub(super) fn state(file: Bytes) -> Result<(Columns, Stated)> {
    let mut lines = Lines::new(file, "");
    let mut names: Option<Names> = None;
    let mut columns = None;
    while let Some(line) = lines.next_trimmed()? {
        let line = without_comment(line);
        if line.is_empty() {
            continue;
        }
        let delimiter = delimiter_of(line);
        let fields: Vec<&[u8]> = fields(line, delimiter).collect();
        if names.is_some() || fields.iter().any(|field| number(field).is_some()) {
            columns = Some(columns_of(delimiter, &fields, names.as_ref())?);
            break;
        }
        let fields = fields.into_iter().map(<[u8]>::to_vec).collect();
        names = Some(Names { line: lines.number(), delimiter, fields });
    }
    let has_z = columns.as_ref().map(|columns| columns.axes.len() == 3);
    let columns = match (columns, names) {
        (Some(columns), _) => columns,
        (None, Some(names)) if named_axes(&names.fields).is_none() => {
            return Err(no_text_of_points(names.line));
        }
        (None, _) => Columns {
            delimiter: Delimiter::WhiteSpace,
            axes: vec![0, 1],
            names_line: Some(0),
            only_two: false,
        },
    };
    let stated =
        Stated { coordinates: Coordinates::F64, has_z, crs: Crs::Unknown, bounds: None, points: None };
    Ok((columns, stated))
}

/// The columns, from the first line of points and any names above it.
fn columns_of(delimiter: Delimiter, fields: &[&[u8]], names: Option<&Names>) -> Result<Columns> {
    let axes = (0..fields.len().clamp(2, 3)).collect();
    let only_two = fields.len() == 2;
    let Some(names) = names else {
        return Ok(Columns { delimiter, axes, names_line: None, only_two });
    };
    let names_line = Some(names.line);
    if let Some(axes) = named_axes(&names.fields) {
        return Ok(Columns { delimiter: names.delimiter, axes, names_line, only_two: false });
    }
    let has_number = fields.iter().any(|field| number(field).is_some());
    if names.fields.len() != fields.len() || !has_number {
        return Err(no_text_of_points(names.line));
    }
    if fields.len() > 3 {
        let reason = "cannot tell which columns are the coordinates: call them x, y and z";
        return Err(Error::malformed(reason).at(format!("line {}", names.line)));
    }
    Ok(Columns { delimiter, axes, names_line, only_two })
}

fn no_text_of_points(line: u64) -> Error {
    let reason = "expected a point, or the names of the columns: a point is a line of numbers separated by \
                  blanks, commas or semicolons";
    Error::malformed(reason).at(format!("line {line}"))
}

/// The columns named x, y and z, or by other usual names; `None` without x and y.
fn named_axes<Name: AsRef<[u8]>>(names: &[Name]) -> Option<Vec<usize>> {
    let column = |usual: &[&str]| {
        let is_usual =
            |name: &Name| usual.iter().any(|usual| name.as_ref().eq_ignore_ascii_case(usual.as_bytes()));
        names.iter().position(is_usual)
    };
    let mut axes = vec![
        column(&["x", "easting", "lon", "long", "longitude"])?,
        column(&["y", "northing", "lat", "latitude"])?,
    ];
    axes.extend(column(&["z", "elevation", "height", "altitude"]));
    Some(axes)
}

/// The line up to a `#`, or nothing if it starts with `//`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    if line.starts_with(b"//") {
        return &[];
    }
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    line[..end].trim_ascii_end()
}

pub(super) fn delimiter_of(line: &[u8]) -> Delimiter {
    let is_number = |word: &[u8]| number(word).is_some();
    if let Some(&byte) = [b';', b','].iter().find(|byte| line.contains(byte)) {
        return Delimiter::Byte(byte);
    }
    // Tabs separate names that may contain blanks; between numbers they are white space like any other.
    let has_numbers = line.split(u8::is_ascii_whitespace).any(is_number);
    if line.contains(&b'\t') && !has_numbers { Delimiter::Byte(b'\t') } else { Delimiter::WhiteSpace }
}

pub(super) fn fields(line: &[u8], delimiter: Delimiter) -> impl Iterator<Item = &[u8]> {
    let is_white_space = delimiter == Delimiter::WhiteSpace;
    line.split(move |&byte| match delimiter {
        Delimiter::WhiteSpace => byte.is_ascii_whitespace(),
        Delimiter::Byte(delimiter) => byte == delimiter,
    })
    .filter(move |field| !is_white_space || !field.is_empty())
    .map(|field| {
        let field = field.trim_ascii();
        field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
    })
}

/// One pass over the lines of a file.
pub(super) struct TextPass {
    lines: Lines<Bytes>,
    columns: Columns,
}

impl TextPass {
    pub(super) fn new(file: Bytes, columns: Columns) -> Self {
        TextPass { lines: Lines::new(file, ""), columns }
    }
}

impl Pass for TextPass {
    fn next_batch(&mut self, placement: &mut Placement, batch: &mut Vec<Point>) -> Result<bool> {
        for count in 0..BATCH_POINTS {
            let Some(line) = self.lines.next_trimmed()? else { return Ok(count > 0) };
            let line = without_comment(line);
            if line.is_empty() {
                continue;
            }
            let point = match parse(line, &self.columns) {
                Ok(point) => point,
                Err(_) if self.columns.names_line == Some(self.lines.number()) => continue,
                Err(error) => return Err(error.at(self.lines.position())),
            };
            placement.put(point, batch).map_err(|e| e.at(self.lines.position()))?;
        }
        Ok(true)
    }
}

fn parse(line: &[u8], columns: &Columns) -> Result<Point> {
    let mut point = [0.0; 3];
    let mut found = 0;
    let mut count = 0;
    for (column, field) in fields(line, columns.delimiter).enumerate() {
        count = column + 1;
        let Some(axis) = columns.axes.iter().position(|&wanted| wanted == column) else { continue };
        point[axis] = number(field).ok_or_else(|| {
            Error::malformed(format!("found {} in column {}, expected a number", quote(field), column + 1))
        })?;
        found += 1;
        if found == columns.axes.len() && !columns.only_two {
            return Ok(point);
        }
    }
    if columns.only_two && count == 2 {
        return Ok(point);
    }
    if columns.only_two && count > 2 {
        return Err(Error::malformed(format!(
            "found {count} columns in {}, but two in the first line of points",
            quote(line)
        )));
    }
    let needed = columns.axes.iter().max().map_or(0, |column| column + 1);
    Err(Error::malformed(format!(
        "found {count} {} in {}, expected at least {needed}",
        if count == 1 { "column" } else { "columns" },
        quote(line)
    )))
}
