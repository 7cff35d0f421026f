//! Points as lines of text: xyz, csv and similar formats.

use super::lines::{Lines, number, quote};
use super::origin::Bytes;
use super::pass::{BATCH_POINTS, Pass, Stated};
use super::placement::Placement;
use super::row_plan::{RowPlan, offers_of};
use spmesh_core::error::{Error, Result};
use spmesh_model::attributes::{Attribute, Attributes, NumberType};
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
    /// The other columns, in their order: each is a number of the record of a line.
    others: Vec<usize>,
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
    let (mut columns, mut named) = (None, None);
    while let Some(line) = lines.next_trimmed()? {
        let line = without_comment(line);
        if line.is_empty() {
            continue;
        }
        let delimiter = delimiter_of(line);
        let fields: Vec<&[u8]> = fields(line, delimiter).collect();
        if names.is_some() || fields.iter().any(|field| number(field).is_some()) {
            let found = columns_of(delimiter, &fields, names.as_ref())?;
            named = attributes_of(&found, names.as_ref()).ok();
            columns = Some(found);
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
        // Names without points below them offer their columns all the same.
        (None, Some(names)) => {
            let found = columns_of(names.delimiter, &[], Some(&names))?;
            named = attributes_of(&found, Some(&names)).ok();
            found
        }
        (None, None) => Columns {
            delimiter: Delimiter::WhiteSpace,
            axes: vec![0, 1],
            others: Vec::new(),
            names_line: Some(0),
            only_two: false,
        },
    };
    let offers = named.iter().flat_map(offers_of).collect();
    let (coordinates, crs) = (Coordinates::F64, Crs::Unknown);
    let stated = Stated { coordinates, has_z, crs, bounds: None, points: None, offers };
    Ok((columns, stated))
}

/// The columns, from the first line of points and any names above it.
fn columns_of(delimiter: Delimiter, fields: &[&[u8]], names: Option<&Names>) -> Result<Columns> {
    let axes: Vec<usize> = (0..fields.len().clamp(2, 3)).collect();
    let others = (axes.len()..fields.len()).collect();
    let only_two = fields.len() == 2;
    let Some(names) = names else {
        return Ok(Columns { delimiter, axes, others, names_line: None, only_two });
    };
    let names_line = Some(names.line);
    if let Some(axes) = named_axes(&names.fields) {
        let others = (0..names.fields.len()).filter(|column| !axes.contains(column)).collect();
        return Ok(Columns { delimiter: names.delimiter, axes, others, names_line, only_two: false });
    }
    let has_number = fields.iter().any(|field| number(field).is_some());
    if names.fields.len() != fields.len() || !has_number {
        return Err(no_text_of_points(names.line));
    }
    if fields.len() > 3 {
        let reason = "cannot tell which columns are the coordinates: call them x, y and z";
        return Err(Error::malformed(reason).at(format!("line {}", names.line)));
    }
    Ok(Columns { delimiter, axes, others, names_line, only_two })
}

/// The columns beside the coordinates as attributes: by their names, or by their numbers from 1 on.
///
/// # Errors
/// If they cannot be attributes: two have one name, or they are too many.
fn attributes_of(columns: &Columns, names: Option<&Names>) -> std::result::Result<Attributes, String> {
    let name_of = |&column: &usize| {
        let name = names.and_then(|names| names.fields.get(column)).filter(|name| !name.is_empty());
        name.map_or(format!("column{}", column + 1), |name| String::from_utf8_lossy(name).into_owned())
    };
    let attribute = |column: &usize| Attribute {
        unknown: Some(f64::NAN.to_le_bytes().to_vec()),
        ..Attribute::new(name_of(column), NumberType::F64)
    };
    Attributes::new(columns.others.iter().map(attribute).collect())
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
    plan: RowPlan,
    record: Vec<u8>,
}

impl TextPass {
    pub(super) fn new(file: Bytes, columns: Columns, plan: RowPlan) -> Self {
        TextPass { lines: Lines::new(file, ""), columns, plan, record: Vec::new() }
    }
}

impl Pass for TextPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
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
            if !self.plan.is_empty() {
                let read = read_others(line, &self.columns, &self.plan, &mut self.record);
                read.map_err(|e| e.at(self.lines.position()))?;
            }
            if placement.put(point, batch).map_err(|e| e.at(self.lines.position()))? {
                self.plan.append(&self.record, rows);
            }
        }
        Ok(true)
    }
}

/// Replaces `record` by the numbers of the columns beside the coordinates, of which those in the plan count.
/// Empty and missing fields are NaN.
fn read_others(line: &[u8], columns: &Columns, plan: &RowPlan, record: &mut Vec<u8>) -> Result<()> {
    record.clear();
    let mut found: Vec<&[u8]> = fields(line, columns.delimiter).collect();
    found.resize(found.len().max(columns.others.last().map_or(0, |last| last + 1)), b"");
    for &column in &columns.others {
        let field = found[column];
        let value = match number(field) {
            Some(value) => value,
            None if field.is_empty() || !plan.uses(record.len()) => f64::NAN,
            None => {
                return Err(Error::malformed(format!(
                    "found {} in column {}, expected a number",
                    quote(field),
                    column + 1
                )));
            }
        };
        record.extend(value.to_le_bytes());
    }
    Ok(())
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
