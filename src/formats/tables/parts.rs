//! Rows on their way to another table, with nothing lost: the parts of one table of many files.
//!
//! A part starts with the names and types of its columns. Each field is a byte that tells its type, and eight
//! bytes, or the length of a text in four and the text; all little-endian. After the last row come a byte of
//! its own and the number of rows, so that a part that was cut off is known.

use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read};
use std::path::Path;

use crate::tables::{Column, ColumnKind, TableSink};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::STRUCTURE_LINE_MAX;

const NOTHING: u8 = 0;
const TEXT: u8 = 1;
const INTEGER: u8 = 2;
const NUMBER: u8 = 3;
const END: u8 = 4;

/// Rows of a part while it is written.
pub(crate) struct PartRows {
    /// What was not written yet.
    pub(crate) bytes: Vec<u8>,
    rows: u64,
}

impl PartRows {
    pub(crate) fn new(columns: &[Column]) -> PartRows {
        PartRows { bytes: head(columns), rows: 0 }
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.bytes.push(TEXT);
        // If the length does not fit, the reader refuses the part.
        self.bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
        self.bytes.extend_from_slice(text.as_bytes());
    }

    pub(crate) fn integer(&mut self, value: i64) {
        self.bytes.push(INTEGER);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    pub(crate) fn number(&mut self, value: f64) {
        self.bytes.push(NUMBER);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    pub(crate) fn nothing(&mut self) {
        self.bytes.push(NOTHING);
    }

    /// Ends a row; returns the number of bytes that were not written yet.
    pub(crate) fn end(&mut self) -> usize {
        self.rows += 1;
        self.bytes.len()
    }

    /// Adds rows of the same columns that were held; returns the number of bytes that were not written yet.
    pub(crate) fn append(&mut self, held: &PartRows) -> usize {
        self.bytes.extend_from_slice(&held.bytes);
        self.rows += held.rows;
        self.bytes.len()
    }

    /// Gives rows that were held to a table of these columns.
    pub(crate) fn give(mut self, table: &mut TableSink) -> Result<()> {
        self.bytes.extend(self.footer());
        PartReader { input: &self.bytes[..], text: Vec::new() }.copy_rows(table)
    }

    /// The end of the part, after the last row.
    pub(crate) fn footer(&self) -> Vec<u8> {
        [&[END][..], &self.rows.to_le_bytes()].concat()
    }
}

fn head(columns: &[Column]) -> Vec<u8> {
    let texts = columns.iter().map(|Column { name, kind }| format!("{name} {kind:?}"));
    format!("spmesh rows\t{}\n", texts.collect::<Vec<_>>().join("\t")).into_bytes()
}

impl TableSink {
    /// Adds the rows of a part, whose columns are those of the table.
    ///
    /// # Errors
    /// If it cannot be read, is damaged, or has other columns; those of [`TableSink::end`].
    pub fn append_part(&mut self, part: &Path) -> Result<()> {
        let name = part.display().to_string();
        let file = File::open(part).map_err(|e| Error::io("reading", e).of_input(&name))?;
        let mut reader = PartReader { input: BufReader::new(file), text: Vec::new() };
        reader.copy_to(self).map_err(|e| e.of_input(name))
    }
}

struct PartReader<R> {
    input: R,
    text: Vec<u8>,
}

impl<R: Read> PartReader<R> {
    fn copy_to(&mut self, table: &mut TableSink) -> Result<()> {
        let expected = head(&table.columns);
        let mut found = Vec::new();
        self.input.by_ref().take(expected.len() as u64).read_to_end(&mut found).map_err(reading)?;
        if found != expected {
            return Err(Error::malformed(
                "the part has other columns than the table: run the sweep without --resume",
            ));
        }
        self.copy_rows(table)
    }

    /// Copies what follows the head.
    fn copy_rows(&mut self, table: &mut TableSink) -> Result<()> {
        let mut rows = 0u64;
        loop {
            for column in 0..table.columns.len() {
                let [tag] = self.bytes()?;
                if tag == END && column == 0 {
                    let is_whole = u64::from_le_bytes(self.bytes()?) == rows;
                    return if is_whole { Ok(()) } else { Err(damaged()) };
                }
                self.field(tag, table.columns[column].kind, table)?;
            }
            rows += 1;
            table.end()?;
        }
    }

    fn field(&mut self, tag: u8, kind: ColumnKind, table: &mut TableSink) -> Result<()> {
        match (tag, kind) {
            (NOTHING, _) => table.nothing(),
            (INTEGER, ColumnKind::Integer) => table.integer(i64::from_le_bytes(self.bytes()?))?,
            (NUMBER, ColumnKind::Number) => table.number(f64::from_le_bytes(self.bytes()?)),
            (TEXT, ColumnKind::Text) => {
                let len = u32::from_le_bytes(self.bytes()?) as usize;
                if len > STRUCTURE_LINE_MAX {
                    return Err(damaged());
                }
                self.text.clear();
                self.input.by_ref().take(len as u64).read_to_end(&mut self.text).map_err(reading)?;
                let text = std::str::from_utf8(&self.text).ok().filter(|text| text.len() == len);
                table.field(text.ok_or_else(damaged)?);
            }
            _ => return Err(damaged()),
        }
        Ok(())
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        match self.input.read_exact(&mut bytes) {
            Err(e) if e.kind() == ErrorKind::UnexpectedEof => Err(damaged()),
            other => other.map(|()| bytes).map_err(reading),
        }
    }
}

fn reading(cause: io::Error) -> Error {
    Error::io("reading", cause)
}

fn damaged() -> Error {
    Error::malformed("the part of the table is damaged or cut off: run the sweep without --resume")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{Rows, TableFormat};

    fn columns() -> Vec<Column> {
        let column = |(name, kind): (&str, ColumnKind)| Column { name: name.to_string(), kind };
        [("a", ColumnKind::Text), ("b", ColumnKind::Integer), ("c", ColumnKind::Number)].map(column).to_vec()
    }

    fn held() -> TableSink {
        let mut table = TableSink::held(TableFormat::Rows, columns());
        for row in 0..3 {
            table.field(&"tab\t".repeat(row));
            table.integer(-(row as i64)).unwrap();
            if row == 1 {
                table.nothing();
            } else {
                table.number(0.1 + row as f64);
            }
            table.end().unwrap();
        }
        table
    }

    fn part() -> Vec<u8> {
        let Rows::Parts(rows) = held().rows else { panic!("rows are held in parts") };
        [head(&columns()), rows.bytes.clone(), rows.footer()].concat()
    }

    fn text(table: TableSink) -> String {
        let Rows::Text(rows) = table.rows else { panic!("a table of text") };
        String::from_utf8(rows.bytes).unwrap()
    }

    fn text_of(part: &[u8], columns: Vec<Column>) -> Result<String> {
        let mut table = TableSink::held(TableFormat::Tsv, columns);
        PartReader { input: part, text: Vec::new() }.copy_to(&mut table)?;
        Ok(text(table))
    }

    #[test]
    fn rows_come_back_and_cuts_are_found() {
        let part = part();
        let expected = "\t0\t0.1\ntab\\t\t-1\t\ntab\\ttab\\t\t-2\t2.1\n";
        assert_eq!(text_of(&part, columns()).unwrap(), expected);
        (0..part.len()).for_each(|len| assert!(text_of(&part[..len], columns()).is_err(), "{len}"));
        // The length of a text, which no memory is taken for.
        let mut long = part.clone();
        let at = part.iter().position(|&byte| byte == b'\n').unwrap() + 2;
        long[at..at + 4].fill(0xff);
        assert!(text_of(&long, columns()).is_err());
        let mut others = columns();
        others[1].name = "d".into();
        assert!(text_of(&part, others).is_err());
        // A row more or less than the end says.
        let mut fewer = part.clone();
        *fewer.iter_mut().nth_back(7).unwrap() += 1;
        assert!(text_of(&fewer, columns()).is_err());
    }

    #[test]
    fn parts_take_rows_that_were_held() {
        let mut table = TableSink::held(TableFormat::Rows, columns());
        table.append(held()).unwrap();
        table.append(held()).unwrap();
        let Rows::Parts(rows) = table.rows else { panic!("rows are held in parts") };
        let mut whole = TableSink::held(TableFormat::Tsv, columns());
        rows.give(&mut whole).unwrap();
        assert_eq!(text(whole), text_of(&part(), columns()).unwrap().repeat(2));
    }
}
