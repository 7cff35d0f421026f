//! Points as lines of text: xyz, csv and their kin.

use std::io::BufReader;

use super::BATCH_POINTS;
use super::input::{Pass, Stated};
use super::lines::{LineReader, number, quote};
use super::origin::FileView;
use super::placement::Placement;
use crate::bounds::Point;
use crate::error::{Error, Result};
use crate::stream::{Coordinates, Crs};

/// What separates the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Delimiter {
    WhiteSpace,
    Byte(u8),
}

/// Where the coordinates of a line are.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    delimiter: Delimiter,
    /// Columns of x, y and, if points have one, z.
    axes: Vec<usize>,
    /// Line of the column names, if there is one.
    names_line: Option<u64>,
}

/// Finds the columns from the first line that is neither blank nor comment, and from the next one if that
/// holds the names of the columns. Whether the lines are good is for the pass to tell.
pub(super) fn state(file: FileView) -> Result<(Columns, Stated)> {
    let mut lines = LineReader::new(BufReader::new(file));
    let mut found: Option<Columns> = None;
    let mut has_points = false;
    while let Some(line) = lines.next_line()? {
        let line = without_comment(line);
        if line.is_empty() {
            continue;
        }
        let delimiter = delimiter_of(line);
        let fields: Vec<&[u8]> = fields(line, delimiter).collect();
        if found.is_some() || fields.iter().any(|field| number(field).is_some()) {
            has_points = true;
            found.get_or_insert(Columns { delimiter, axes: first_axes(&fields), names_line: None });
            break;
        }
        let axes = named_axes(&fields).unwrap_or_else(|| first_axes(&fields));
        found = Some(Columns { delimiter, axes, names_line: Some(lines.number()) });
    }
    let columns =
        found.unwrap_or(Columns { delimiter: Delimiter::WhiteSpace, axes: vec![0, 1], names_line: None });
    let has_z = has_points.then_some(columns.axes.len() == 3);
    let stated =
        Stated { coordinates: Coordinates::F64, has_z, crs: Crs::Unknown, bounds: None, points: None };
    Ok((columns, stated))
}

/// The first two or three columns.
fn first_axes(fields: &[&[u8]]) -> Vec<usize> {
    (0..fields.len().clamp(2, 3)).collect()
}

/// The columns that are called x, y and z, if x and y are there.
fn named_axes(names: &[&[u8]]) -> Option<Vec<usize>> {
    let column = |axis: &[u8]| names.iter().position(|name| name.eq_ignore_ascii_case(axis));
    let mut axes = vec![column(b"x")?, column(b"y")?];
    axes.extend(column(b"z"));
    Some(axes)
}

/// The line up to a `#`, or nothing if it starts with `//`.
fn without_comment(line: &[u8]) -> &[u8] {
    if line.starts_with(b"//") {
        return &[];
    }
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    line[..end].trim_ascii_end()
}

fn delimiter_of(line: &[u8]) -> Delimiter {
    let is_number = |word: &[u8]| number(word).is_some();
    if let Some(&byte) = [b';', b','].iter().find(|byte| line.contains(byte)) {
        return Delimiter::Byte(byte);
    }
    // Tabs separate names that may contain blanks; between numbers they are white space as any other.
    let has_numbers = line.split(u8::is_ascii_whitespace).any(is_number);
    if line.contains(&b'\t') && !has_numbers { Delimiter::Byte(b'\t') } else { Delimiter::WhiteSpace }
}

fn fields(line: &[u8], delimiter: Delimiter) -> impl Iterator<Item = &[u8]> {
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
    lines: LineReader<BufReader<FileView>>,
    columns: Columns,
}

impl TextPass {
    pub(super) fn new(file: FileView, columns: Columns) -> Self {
        TextPass { lines: LineReader::new(BufReader::with_capacity(1 << 18, file)), columns }
    }
}

impl Pass for TextPass {
    fn next_batch(&mut self, placement: &mut Placement, batch: &mut Vec<Point>) -> Result<bool> {
        for count in 0..BATCH_POINTS {
            let Some(line) = self.lines.next_line()? else { return Ok(count > 0) };
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
        if found == columns.axes.len() {
            return Ok(point);
        }
    }
    let needed = columns.axes.iter().max().map_or(0, |column| column + 1);
    Err(Error::malformed(format!(
        "found {count} {} in {}, expected at least {needed}",
        if count == 1 { "column" } else { "columns" },
        quote(line)
    )))
}
