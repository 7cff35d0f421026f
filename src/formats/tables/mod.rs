//! Tables with typed columns, which are given row by row: tab-separated text, JSON Lines or Parquet.

mod number;
mod parquet;
mod parts;
mod text;

use std::fmt::Display;
use std::io::Write;
use std::path::Path;

use parquet::ParquetRows;
use parts::PartRows;
use text::TextRows;
pub(crate) use text::escaped;

use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_base::places::is_device;

/// Bytes of rows that are buffered before they are written.
const BUFFER_LEN: usize = 1 << 16;

/// Formats of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableFormat {
    /// Fields that tabs separate, below a line with the names of the columns. Numbers have nine digits.
    #[default]
    Tsv,
    /// An object on each line, with the names of the columns as keys. Numbers have nine digits.
    JsonLines,
    /// Apache Parquet, with numbers as they are in memory.
    Parquet,
    /// A part of another table ([`TableSink::append_part`]): not for users.
    Rows,
}

impl TableFormat {
    /// All of them.
    pub const ALL: [TableFormat; 3] = [TableFormat::Tsv, TableFormat::JsonLines, TableFormat::Parquet];

    /// The format that the ending of a name stands for; `None` if it stands for no table, or `path` is a
    /// device, such as /dev/fd/3.parquet.
    pub fn of(path: &Path) -> Option<TableFormat> {
        let ending = path.extension().filter(|_| !is_device(path))?.to_str()?.to_ascii_lowercase();
        Some(match &ending[..] {
            "tsv" => TableFormat::Tsv,
            "jsonl" | "ndjson" => TableFormat::JsonLines,
            "parquet" => TableFormat::Parquet,
            _ => return None,
        })
    }

    /// The usual ending of names, which is also the name of the format.
    pub fn ending(self) -> &'static str {
        match self {
            TableFormat::Tsv => "tsv",
            TableFormat::JsonLines => "jsonl",
            TableFormat::Parquet => "parquet",
            TableFormat::Rows => "rows",
        }
    }
}

/// Types of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Text.
    Text,
    /// Integers; in Parquet, of 64 bits with a sign.
    Integer,
    /// Numbers as f64.
    Number,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// The type of its fields.
    pub kind: ColumnKind,
}

/// A table while it is written, field by field. Without [`TableSink::commit`], a file gets no name.
///
/// Memory: 64 kB; for Parquet a group of 65,536 rows or 8 MB of text.
pub struct TableSink {
    rows: Rows,
    /// `None` if the rows are held for another table.
    output: Option<Output>,
    columns: Vec<Column>,
    /// Fields of the current row.
    fields: usize,
}

pub(crate) enum Rows {
    Text(TextRows),
    Parquet(Box<ParquetRows>),
    Parts(PartRows),
}

impl TableSink {
    /// A table without rows.
    pub fn create(format: TableFormat, columns: Vec<Column>, output: Output) -> TableSink {
        let rows = match format {
            TableFormat::Tsv => Rows::Text(TextRows::tsv(&columns)),
            TableFormat::JsonLines => Rows::Text(TextRows::json_lines(&columns)),
            TableFormat::Parquet => Rows::Parquet(Box::new(ParquetRows::new(&columns))),
            TableFormat::Rows => Rows::Parts(PartRows::new(&columns)),
        };
        TableSink { rows, output: Some(output), columns, fields: 0 }
    }

    /// Rows without a table, which [`TableSink::append`] gives to one of this format and these columns.
    ///
    /// Memory: the rows.
    pub fn held(format: TableFormat, columns: Vec<Column>) -> TableSink {
        let mut rows = match format {
            TableFormat::Tsv => Rows::Text(TextRows::tsv(&columns)),
            TableFormat::JsonLines => Rows::Text(TextRows::json_lines(&columns)),
            TableFormat::Parquet | TableFormat::Rows => Rows::Parts(PartRows::new(&columns)),
        };
        // Without what comes before the first row.
        if let Rows::Text(TextRows { bytes, .. }) | Rows::Parts(PartRows { bytes, .. }) = &mut rows {
            bytes.clear();
        }
        TableSink { rows, output: None, columns, fields: 0 }
    }

    /// Adds rows that were held.
    ///
    /// # Errors
    /// If writing fails.
    pub fn append(&mut self, held: TableSink) -> Result<()> {
        let len = match (&mut self.rows, held.rows) {
            (Rows::Text(rows), Rows::Text(held)) => {
                rows.bytes.extend_from_slice(&held.bytes);
                rows.bytes.len()
            }
            (Rows::Parts(rows), Rows::Parts(held)) => rows.append(&held),
            (_, Rows::Parts(held)) => return held.give(self),
            _ => unreachable!("rows are held for a table of their format"),
        };
        if len >= BUFFER_LEN { self.flush() } else { Ok(()) }
    }

    /// Adds a text to the row.
    pub fn field(&mut self, text: &str) {
        let column = self.next(ColumnKind::Text);
        match &mut self.rows {
            Rows::Text(rows) => rows.text(column, text),
            Rows::Parquet(rows) => rows.text(column, text),
            Rows::Parts(rows) => rows.text(text),
        }
    }

    /// Adds an integer to the row.
    ///
    /// # Errors
    /// Usage, if it is beyond the integers of Parquet.
    pub fn integer(&mut self, value: impl Display + TryInto<i64> + Copy) -> Result<()> {
        let column = self.next(ColumnKind::Integer);
        match &mut self.rows {
            Rows::Text(rows) => rows.integer(column, value),
            rows => match (value.try_into(), rows) {
                (Ok(value), Rows::Parquet(rows)) => rows.integer(column, value),
                (Ok(value), Rows::Parts(rows)) => rows.integer(value),
                _ => {
                    let name = &self.columns[column].name;
                    let message =
                        format!("{value} in column {name} exceeds 63 bits: write text (.tsv, .jsonl)");
                    return Err(Error::usage(message));
                }
            },
        }
        Ok(())
    }

    /// Adds a number to the row.
    pub fn number(&mut self, value: f64) {
        let column = self.next(ColumnKind::Number);
        match &mut self.rows {
            Rows::Text(rows) => rows.number(column, value),
            Rows::Parquet(rows) => rows.number(column, value),
            Rows::Parts(rows) => rows.number(value),
        }
    }

    /// Adds nothing to the row, where a column does not apply.
    pub fn nothing(&mut self) {
        let column = self.fields;
        self.fields += 1;
        match &mut self.rows {
            Rows::Text(rows) => rows.nothing(column),
            Rows::Parquet(rows) => rows.nothing(column),
            Rows::Parts(rows) => rows.nothing(),
        }
    }

    /// Ends the row.
    ///
    /// # Errors
    /// If writing fails.
    pub fn end(&mut self) -> Result<()> {
        debug_assert_eq!(self.fields, self.columns.len(), "a field for each column");
        self.fields = 0;
        let is_full = match &mut self.rows {
            Rows::Text(rows) => rows.end() >= BUFFER_LEN,
            Rows::Parquet(rows) => rows.end()?,
            Rows::Parts(rows) => rows.end() >= BUFFER_LEN,
        };
        if is_full { self.flush() } else { Ok(()) }
    }

    /// Writes all rows, and gives the output its name.
    ///
    /// # Errors
    /// If writing fails.
    pub fn commit(mut self) -> Result<()> {
        self.flush()?;
        let mut output = self.output.expect("rows are not held");
        let footer = match &self.rows {
            Rows::Text(_) => Vec::new(),
            Rows::Parquet(rows) => rows.footer(),
            Rows::Parts(rows) => rows.footer(),
        };
        output.write_all(&footer).map_err(write_error)?;
        output.commit()
    }

    /// Writes the rows so far.
    fn flush(&mut self) -> Result<()> {
        let Some(output) = &mut self.output else { return Ok(()) };
        let bytes = match &mut self.rows {
            Rows::Text(rows) => &mut rows.bytes,
            Rows::Parquet(rows) => rows.group()?,
            Rows::Parts(rows) => &mut rows.bytes,
        };
        output.write_all(bytes).map_err(write_error)?;
        bytes.clear();
        Ok(())
    }

    /// The column of the next field.
    fn next(&mut self, kind: ColumnKind) -> usize {
        let column = self.fields;
        debug_assert_eq!(self.columns[column].kind, kind, "the type of column {}", self.columns[column].name);
        self.fields += 1;
        column
    }
}

fn write_error(cause: std::io::Error) -> Error {
    Error::io("writing the table", cause)
}
