//! Rows as text: tab-separated values, and JSON Lines.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::Write;

use crate::tables::Column;
use crate::tables::number::write_number;

/// Escapes tabs, line breaks and backslashes, so that the text fits a field.
pub(crate) fn escaped(text: &str) -> Cow<'_, str> {
    if text.bytes().any(|byte| matches!(byte, b'\\' | b'\t' | b'\n' | b'\r')) {
        let text = text.replace('\\', "\\\\").replace('\t', "\\t").replace('\n', "\\n").replace('\r', "\\r");
        return Cow::Owned(text);
    }
    Cow::Borrowed(text)
}

/// Rows as text.
pub(crate) struct TextRows {
    /// For each column what comes before its fields.
    before: Vec<String>,
    is_json: bool,
    /// What was not written yet.
    pub(crate) bytes: Vec<u8>,
}

impl TextRows {
    /// A line with the names of the columns comes first.
    pub(crate) fn tsv(columns: &[Column]) -> TextRows {
        let names: Vec<&str> = columns.iter().map(|column| &column.name[..]).collect();
        let separators = columns.iter().enumerate().map(|(place, _)| if place == 0 { "" } else { "\t" });
        TextRows {
            before: separators.map(str::to_string).collect(),
            is_json: false,
            bytes: (names.join("\t") + "\n").into_bytes(),
        }
    }

    pub(crate) fn json_lines(columns: &[Column]) -> TextRows {
        let before = columns.iter().enumerate().map(|(place, column)| {
            let name = serde_json::Value::from(&column.name[..]);
            format!("{}{name}:", if place == 0 { '{' } else { ',' })
        });
        TextRows { before: before.collect(), is_json: true, bytes: Vec::new() }
    }

    pub(crate) fn text(&mut self, column: usize, text: &str) {
        self.start(column);
        if self.is_json {
            serde_json::to_writer(&mut self.bytes, text).expect("a vector takes all");
        } else {
            self.bytes.extend_from_slice(escaped(text).as_bytes());
        }
    }

    pub(crate) fn integer(&mut self, column: usize, value: impl Display) {
        self.start(column);
        write!(self.bytes, "{value}").expect("a vector takes all");
    }

    pub(crate) fn number(&mut self, column: usize, value: f64) {
        // JSON has no infinity.
        if self.is_json && !value.is_finite() {
            self.nothing(column);
            return;
        }
        self.start(column);
        write_number(&mut self.bytes, value);
    }

    pub(crate) fn nothing(&mut self, column: usize) {
        self.start(column);
        self.bytes.extend_from_slice(if self.is_json { b"null" } else { b"" });
    }

    /// Ends a row; returns the number of bytes that were not written yet.
    pub(crate) fn end(&mut self) -> usize {
        self.bytes.extend_from_slice(if self.is_json { b"}\n" } else { b"\n" });
        self.bytes.len()
    }

    fn start(&mut self, column: usize) {
        self.bytes.extend_from_slice(self.before[column].as_bytes());
    }
}
