//! A text of points whose lines are written again, with one more column.

use std::io::Write;

use crate::source::TextOptions;
use crate::source::origin::{Bytes, Origin};
use crate::text::columns::{self, Columns};
use crate::text::lines::{Lines, number};
use crate::text::read::{Delimiter, delimiter_of, fields, parse};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// Bytes of a line, about.
const LINE_LEN: usize = 64;

/// Fewest decimals of values, and most.
const DECIMALS: [usize; 2] = [3, 9];

/// A text of points with elevations, opened for writing its lines again.
#[derive(Debug)]
pub struct TextFile {
    name: String,
    origin: Origin,
    columns: Columns,
    notices: Vec<String>,
}

impl TextFile {
    pub(crate) fn new(
        name: String,
        origin: Origin,
        options: &TextOptions,
        mut notices: Vec<String>,
    ) -> Result<TextFile> {
        let mut own = Vec::new();
        let state = origin.plain().and_then(|bytes| columns::state(bytes, options, &mut own));
        let (columns, stated) = state.map_err(|e| e.of_input(&name))?;
        notices.extend(own.into_iter().map(|notice| format!("{name}: {notice}")));
        if stated.has_z == Some(false) {
            let message = "points have no elevation: give lines of x y z, or choose their --columns";
            return Err(Error::usage(message).of_input(name));
        }
        Ok(TextFile { name, origin, columns, notices })
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Oddities that the user should know.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Writes the lines again, each point with a value in the column `name`: `values` replaces those of a
    /// batch of up to `most` points, NaN where one is unknown. They have so many decimals, if `None` as many
    /// as the elevation of the first point has, but from 3 to 9.
    ///
    /// # Errors
    /// Malformed, if the file is; if reading, writing or `values` fails.
    pub fn write_with(
        &self,
        (name, decimals): (&str, Option<usize>),
        most: usize,
        output: &mut impl Write,
        mut values: impl FnMut(&[Point], &mut Vec<f64>) -> Result<()>,
    ) -> Result<()> {
        let (mut lines, mut batch, mut found) = (self.lines()?, TextBatch::default(), Vec::new());
        loop {
            lines.next(&mut batch, most, most * LINE_LEN)?;
            if batch.lines.is_empty() {
                return Ok(());
            }
            values(&batch.points, &mut found).map_err(|e| e.of_input(&self.name))?;
            batch.write(name, &found, decimals, output)?;
        }
    }

    /// Starts a pass over all lines.
    ///
    /// # Errors
    /// If the file cannot be opened.
    fn lines(&self) -> Result<TextLines<'_>> {
        let bytes = self.origin.plain().map_err(|e| e.of_input(&self.name))?;
        Ok(TextLines { file: self, lines: Lines::new(bytes, &self.name[..]), decimals: None, comment: None })
    }
}

/// The lines of a text, in their order.
struct TextLines<'f> {
    file: &'f TextFile,
    lines: Lines<Bytes>,
    /// Decimals of the elevation of the first point, once it was read.
    decimals: Option<usize>,
    /// The last comment before the first point, in the batch of this pass.
    comment: Option<usize>,
}

/// Lines, with the points of those that are points.
#[derive(Debug, Default)]
struct TextBatch {
    text: Vec<u8>,
    lines: Vec<CopiedLine>,
    points: Vec<Point>,
    decimals: usize,
}

#[derive(Debug)]
struct CopiedLine {
    /// Where its text ends, with its line end, and where another column belongs.
    end: usize,
    column: usize,
    separator: u8,
    kind: LineKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LineKind {
    Point,
    Names,
    Other,
}

impl TextLines<'_> {
    /// Replaces the content of `batch` with the next lines: `most` points, and as many bytes of text, at
    /// most; leaves it empty at the end.
    ///
    /// # Errors
    /// If reading fails, or a line is no point with finite coordinates; file and line are named.
    fn next(&mut self, batch: &mut TextBatch, most: usize, most_bytes: usize) -> Result<()> {
        batch.text.clear();
        batch.lines.clear();
        batch.points.clear();
        self.comment = None;
        while batch.points.len() < most && batch.text.len() < most_bytes {
            let is_skipped = self.lines.number() < self.file.columns.layout.skip_lines;
            let line = if is_skipped { self.lines.next_line()? } else { self.lines.next_trimmed()? };
            if line.is_none() {
                break;
            }
            let added = if is_skipped { self.add_other(batch, b"") } else { self.add(batch) };
            added.map_err(|e| self.lines.locate(e))?;
        }
        batch.decimals = self.decimals.unwrap_or(DECIMALS[0]);
        Ok(())
    }

    /// Adds the last line read.
    fn add(&mut self, batch: &mut TextBatch) -> Result<()> {
        let columns = &self.file.columns;
        let raw = self.lines.current();
        let trimmed = raw.trim_ascii();
        let content = columns.layout.content(trimmed);
        if content.is_empty() {
            let is_comment = self.decimals.is_none() && columns.layout.comment(trimmed).is_some();
            self.comment = if is_comment { Some(batch.lines.len()) } else { self.comment };
            let end = trimmed.to_vec();
            return self.add_other(batch, &end);
        }
        let column = raw.len() - raw.trim_ascii_start().len() + content.len();
        let kind = match parse(content, columns) {
            Ok(point) if point.iter().all(|coordinate| coordinate.is_finite()) => {
                batch.points.push(point);
                LineKind::Point
            }
            Ok(_) => return Err(Error::malformed("found NaN or infinity, expected finite coordinates")),
            Err(_) if columns.names_line == Some(self.lines.number()) => LineKind::Names,
            Err(error) => return Err(error),
        };
        if kind == LineKind::Point && self.decimals.is_none() {
            let elevation = columns.axes.get(2).and_then(|&z| fields(content, columns.delimiter).nth(z));
            self.decimals = Some(elevation.map_or(DECIMALS[0], decimals_of));
            self.name_comment(batch);
        }
        let separator = separator(columns.delimiter, content);
        self.put(batch, column, separator, kind);
        Ok(())
    }

    /// Adds a line that is no point, whose text without white space around it is `trimmed`.
    fn add_other(&self, batch: &mut TextBatch, trimmed: &[u8]) -> Result<()> {
        let raw = self.lines.current();
        let column = raw.len() - raw.trim_ascii_start().len() + trimmed.len();
        self.put(batch, column, b' ', LineKind::Other);
        Ok(())
    }

    fn put(&self, batch: &mut TextBatch, column: usize, separator: u8, kind: LineKind) {
        let start = batch.text.len();
        batch.text.extend_from_slice(self.lines.current());
        batch.text.extend_from_slice(self.lines.line_end());
        let column = start + column.min(self.lines.current().len());
        batch.lines.push(CopiedLine { end: batch.text.len(), column, separator, kind });
    }

    /// A comment before the first point that names the columns gets one name more: otherwise they would have
    /// no names for a reader that counts.
    fn name_comment(&self, batch: &mut TextBatch) {
        let columns = &self.file.columns;
        let Some(at) = self.comment.filter(|_| columns.names_line.is_none()) else { return };
        let start = if at == 0 { 0 } else { batch.lines[at - 1].end };
        let line = &mut batch.lines[at];
        let Some(names) = columns.layout.comment(batch.text[start..line.column].trim_ascii()) else { return };
        let delimiter = columns.layout.separator.map_or_else(|| delimiter_of(names), |given| given.0);
        let has_numbers = fields(names, delimiter).any(|field| number(field).is_some());
        let count = fields(names, delimiter).count();
        if count == columns.axes.len() + columns.others.len() && !has_numbers {
            (line.separator, line.kind) = (separator(delimiter, names), LineKind::Names);
        }
    }
}

impl TextBatch {
    /// Writes its lines. Those of points get one of the `values`; a line of names gets `name`.
    ///
    /// # Errors
    /// If writing fails.
    fn write(
        &self,
        name: &str,
        values: &[f64],
        decimals: Option<usize>,
        output: &mut impl Write,
    ) -> Result<()> {
        let (mut start, mut values) = (0, values.iter());
        let decimals = decimals.unwrap_or(self.decimals);
        let mut text = Vec::with_capacity(self.text.len() + 12 * self.points.len());
        for &CopiedLine { end, column, separator, kind } in &self.lines {
            text.extend_from_slice(&self.text[start..column]);
            match kind {
                LineKind::Other => {}
                LineKind::Names => {
                    text.push(separator);
                    text.extend(quoted(name, separator).as_bytes());
                }
                LineKind::Point => {
                    text.push(separator);
                    let value = values.next().copied().unwrap_or(f64::NAN);
                    text.extend(decimal(value, decimals).as_bytes());
                }
            }
            text.extend_from_slice(&self.text[column..end]);
            start = end;
        }
        output.write_all(&text).map_err(|e| Error::io("writing", e))
    }
}

/// What comes before another column in a line: white space is that of the line.
fn separator(delimiter: Delimiter, line: &[u8]) -> u8 {
    match delimiter {
        Delimiter::Byte(byte) => byte,
        Delimiter::WhiteSpace if line.contains(&b'\t') => b'\t',
        Delimiter::WhiteSpace => b' ',
    }
}

/// The number of decimals that a word has, within limits; the most for one with an exponent.
fn decimals_of(word: &[u8]) -> usize {
    let [least, most] = DECIMALS;
    if word.iter().any(|byte| byte.eq_ignore_ascii_case(&b'e')) {
        return most;
    }
    let point = word.iter().position(|&byte| byte == b'.');
    point.map_or(0, |point| word.len() - point - 1).clamp(least, most)
}

/// A number with so many decimals, without the sign of a zero.
fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_string() } else { text }
}

/// A name as a field.
fn quoted(name: &str, separator: u8) -> String {
    let is_plain = !name.bytes().any(|byte| byte == separator || byte.is_ascii_whitespace());
    if is_plain { name.to_string() } else { format!("\"{name}\"") }
}
