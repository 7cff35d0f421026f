//! Rows of a summary, as tab-separated values or JSON Lines.

use std::path::Path;

use serde_json::{Map, Value};
use spmesh_base::error::Result;
use spmesh_formats::sink::{Column, ColumnKind, TableSink};

/// The columns. Readers take them by name; new ones come last.
pub(super) const COLUMNS: [&str; 18] = [
    "file",
    "model",
    "atoms",
    "unique_points",
    "tetrahedra",
    "hull_facets",
    "seconds",
    "peak_memory_bytes",
    "output",
    "output_bytes",
    "options",
    "error",
    "warnings",
    "version",
    "input_bytes",
    "input_modified",
    "input_sha256",
    "violations",
];

/// Columns that hold numbers: from `model` to `peak_memory_bytes`, and other counts.
fn is_number(column: usize) -> bool {
    (1..8).contains(&column) || matches!(COLUMNS[column], "output_bytes" | "input_bytes" | "violations")
}

/// The columns with their types.
pub(super) fn columns() -> Vec<Column> {
    let kind = |column: usize| match COLUMNS[column] {
        "seconds" => ColumnKind::Number,
        _ if is_number(column) => ColumnKind::Integer,
        _ => ColumnKind::Text,
    };
    let named = |(place, name): (usize, &&str)| Column { name: name.to_string(), kind: kind(place) };
    COLUMNS.iter().enumerate().map(named).collect()
}

/// A row: a field for each column, empty if it does not apply.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Row([String; COLUMNS.len()]);

impl Row {
    pub(super) fn get(&self, column: &str) -> &str {
        &self.0[place(column)]
    }

    pub(super) fn set(&mut self, column: &str, value: impl Into<String>) {
        self.0[place(column)] = value.into();
    }
}

impl Row {
    /// Writes it to a table of these columns.
    pub(super) fn write(&self, table: &mut TableSink) -> Result<()> {
        for (Column { kind, .. }, field) in columns().iter().zip(&self.0) {
            match (kind, field.parse::<i64>(), field.parse::<f64>()) {
                (ColumnKind::Text, ..) if !field.is_empty() => table.field(field),
                (ColumnKind::Integer, Ok(value), _) => table.integer(value)?,
                (ColumnKind::Number, _, Ok(value)) => table.number(value),
                _ => table.nothing(),
            }
        }
        table.end()
    }
}

fn place(column: &str) -> usize {
    COLUMNS.iter().position(|&name| name == column).expect("a column of the summary")
}

/// How a summary is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    /// Tab-separated values with a line of columns.
    Tsv,
    /// A JSON object on each line.
    JsonLines,
}

impl Format {
    /// The format that the ending of a name stands for.
    pub(super) fn of(path: &Path) -> Format {
        let is_json = |ending: &str| ["jsonl", "ndjson"].iter().any(|json| ending.eq_ignore_ascii_case(json));
        match path.extension().and_then(|ending| ending.to_str()) {
            Some(ending) if is_json(ending) => Format::JsonLines,
            _ => Format::Tsv,
        }
    }

    /// What comes before all rows.
    pub(super) fn head(self) -> String {
        match self {
            Format::Tsv => COLUMNS.join("\t") + "\n",
            Format::JsonLines => String::new(),
        }
    }

    pub(super) fn line(self, row: &Row) -> String {
        match self {
            Format::Tsv => row.0.each_ref().map(|field| escaped(field)).join("\t") + "\n",
            Format::JsonLines => {
                let fields = COLUMNS.iter().zip(&row.0).enumerate();
                let object: Map<String, Value> =
                    fields.map(|(column, (&name, field))| (name.to_string(), value(column, field))).collect();
                Value::Object(object).to_string() + "\n"
            }
        }
    }

    /// The row of a line; `None` if it is none.
    pub(super) fn row(self, line: &str) -> Option<Row> {
        let mut row = Row::default();
        match self {
            Format::Tsv => {
                let fields: Vec<String> = line.split('\t').map(unescaped).collect();
                row.0 = fields.try_into().ok()?;
            }
            Format::JsonLines => {
                let object: Map<String, Value> = serde_json::from_str(line).ok()?;
                for (name, field) in COLUMNS.iter().zip(&mut row.0) {
                    *field = match object.get(*name)? {
                        Value::Null => String::new(),
                        Value::String(text) => text.clone(),
                        other => other.to_string(),
                    };
                }
            }
        }
        Some(row)
    }
}

/// A field as a value of JSON: null if it is empty.
fn value(column: usize, field: &str) -> Value {
    if field.is_empty() {
        return Value::Null;
    }
    let number = if is_number(column) { serde_json::from_str(field).ok() } else { None };
    number.unwrap_or_else(|| Value::String(field.to_string()))
}

/// Escapes tabs and line breaks, so that the text fits a field.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('\t', "\\t").replace('\n', "\\n").replace('\r', "\\r")
}

fn unescaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text.chars();
    while let Some(next) = rest.next() {
        plain.push(match next {
            '\\' => match rest.next() {
                Some('t') => '\t',
                Some('n') => '\n',
                Some('r') => '\r',
                other => other.unwrap_or('\\'),
            },
            other => other,
        });
    }
    plain
}
