//! Points as lines of text: xyz, csv and similar formats.

use crate::source::cut::Cut;
use crate::source::origin::Bytes;
use crate::source::pass::{BATCH_POINTS, Content, Opening, Pass};
use crate::source::placement::Placement;
use crate::source::row_plan::RowPlan;
use crate::text::columns::{self, Columns};
use crate::text::lines::{Lines, number, quote};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// The separator of a line's fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delimiter {
    WhiteSpace,
    Byte(u8),
}

/// The line up to a `#`, or nothing if it starts with `//`.
pub(crate) fn without_comment(line: &[u8]) -> &[u8] {
    if line.starts_with(b"//") {
        return &[];
    }
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    line[..end].trim_ascii_end()
}

pub(crate) fn delimiter_of(line: &[u8]) -> Delimiter {
    let is_number = |word: &[u8]| number(word).is_some();
    if let Some(&byte) = [b';', b','].iter().find(|byte| line.contains(byte)) {
        return Delimiter::Byte(byte);
    }
    // Tabs separate names that may contain blanks; between numbers they are white space like any other.
    let has_numbers = line.split(u8::is_ascii_whitespace).any(is_number);
    if line.contains(&b'\t') && !has_numbers { Delimiter::Byte(b'\t') } else { Delimiter::WhiteSpace }
}

/// The fields of a line, without the quotation marks around them. A delimiter within a field in quotation marks
/// does not end it.
pub(crate) fn fields(line: &[u8], delimiter: Delimiter) -> impl Iterator<Item = &[u8]> {
    let is_white_space = delimiter == Delimiter::WhiteSpace;
    let mut is_quoted = false;
    line.split(move |&byte| {
        is_quoted ^= byte == b'"';
        !is_quoted
            && match delimiter {
                Delimiter::WhiteSpace => byte.is_ascii_whitespace(),
                Delimiter::Byte(delimiter) => byte == delimiter,
            }
    })
    .filter(move |field| !is_white_space || !field.is_empty())
    .map(|field| {
        let field = field.trim_ascii();
        field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
    })
}

/// Opens a text of points.
pub(crate) fn open(file: &Opening, notices: &mut Vec<String>) -> Result<Content> {
    let (columns, stated) = columns::state(file.origin.plain()?, &file.options.text, notices)?;
    let content = Content::new(stated, move |file, plan| {
        let (bytes, columns) = (file.origin.plain()?, columns.clone());
        Ok(Box::new(TextPass::new(bytes, columns, plan, file.options.salvage)))
    });
    Ok(Content { is_costly: true, ..content })
}

/// One pass over the lines of a file.
struct TextPass {
    lines: Lines<Bytes>,
    columns: Columns,
    plan: RowPlan,
    record: Vec<u8>,
    /// Whether a last line without a line end is left out.
    is_salvaged: bool,
    /// Points so far, and what is left if there is such a line.
    read: u64,
    cut: Option<Cut>,
}

impl TextPass {
    pub(crate) fn new(file: Bytes, columns: Columns, plan: RowPlan, is_salvaged: bool) -> Self {
        let lines = Lines::new(file, "");
        TextPass { lines, columns, plan, record: Vec::new(), is_salvaged, read: 0, cut: None }
    }
}

impl Pass for TextPass {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        rows: &mut Vec<u8>,
    ) -> Result<bool> {
        if self.lines.number() == 0 {
            self.columns.layout.skip(&mut self.lines)?;
        }
        for count in 0..BATCH_POINTS {
            if self.lines.next_trimmed()?.is_none() {
                return Ok(count > 0);
            }
            let line = self.columns.layout.content(self.lines.current().trim_ascii());
            if line.is_empty() {
                continue;
            }
            if self.is_salvaged && self.lines.unended().is_some() {
                self.cut = Some(Cut { read: self.read, lost: None });
                return Ok(count > 0);
            }
            let point = match parse(line, &self.columns) {
                Ok(point) => point,
                Err(_) if self.columns.names_line == Some(self.lines.number()) => continue,
                Err(error) => return Err(error.at(self.lines.position())),
            };
            self.read += 1;
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

    fn cut(&self) -> Option<Cut> {
        self.cut
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

/// The coordinates in a line without comments.
pub(crate) fn parse(line: &[u8], columns: &Columns) -> Result<Point> {
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
