//! Rows of a summary, as tab-separated values or JSON Lines.

use std::path::Path;

use crate::tables::{Column, ColumnKind, TableSink, escaped};
use serde_json::{Map, Value};
use spmesh_base::error::Result;

/// The names and kinds of columns. Readers take them by name; new ones come last.
pub type Columns = &'static [(&'static str, ColumnKind)];

/// A row: a field for each column, empty if it does not apply.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    columns: Columns,
    fields: Vec<String>,
}

impl Row {
    /// A row of empty fields.
    pub(super) fn new(columns: Columns) -> Row {
        Row { columns, fields: vec![String::new(); columns.len()] }
    }

    /// The field of a column that there is.
    pub(super) fn get(&self, column: &str) -> &str {
        self.find(column).expect("a column of the summary")
    }

    /// The field of a column; `None` if there is no such column.
    pub(super) fn find(&self, column: &str) -> Option<&str> {
        self.place(column).map(|place| &self.fields[place][..])
    }

    /// Fills the field of a column.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn set(&mut self, column: &str, value: impl Into<String>) {
        let place = self.place(column).expect("a column of the summary");
        self.fields[place] = value.into();
    }

    fn place(&self, column: &str) -> Option<usize> {
        self.columns.iter().position(|(name, _)| *name == column)
    }

    /// Writes it to a table of its columns.
    pub(super) fn write(&self, table: &mut TableSink) -> Result<()> {
        for ((_, kind), field) in self.columns.iter().zip(&self.fields) {
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

/// The columns as those of a table.
pub(super) fn table_columns(columns: Columns) -> Vec<Column> {
    columns.iter().map(|&(name, kind)| Column { name: name.to_string(), kind }).collect()
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
    pub(super) fn head(self, columns: Columns) -> String {
        match self {
            Format::Tsv => columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join("\t") + "\n",
            Format::JsonLines => String::new(),
        }
    }

    pub(super) fn line(self, row: &Row) -> String {
        match self {
            Format::Tsv => {
                row.fields.iter().map(|field| escaped(field)).collect::<Vec<_>>().join("\t") + "\n"
            }
            Format::JsonLines => {
                let fields = row.columns.iter().zip(&row.fields);
                let object: Map<String, Value> =
                    fields.map(|(&(name, kind), field)| (name.to_string(), value(kind, field))).collect();
                Value::Object(object).to_string() + "\n"
            }
        }
    }

    /// The row of a line; `None` if it is none of these columns.
    pub(super) fn row(self, line: &str, columns: Columns) -> Option<Row> {
        let fields = match self {
            Format::Tsv => line.split('\t').map(unescaped).collect(),
            Format::JsonLines => {
                let object: Map<String, Value> = serde_json::from_str(line).ok()?;
                let field = |&(name, _): &(&str, ColumnKind)| {
                    Some(match object.get(name)? {
                        Value::Null => String::new(),
                        Value::String(text) => text.clone(),
                        other => other.to_string(),
                    })
                };
                columns.iter().map(field).collect::<Option<Vec<String>>>()?
            }
        };
        (fields.len() == columns.len()).then_some(Row { columns, fields })
    }
}

/// A field as a value of JSON: null if it is empty.
fn value(kind: ColumnKind, field: &str) -> Value {
    if field.is_empty() {
        return Value::Null;
    }
    let number = if kind == ColumnKind::Text { None } else { serde_json::from_str(field).ok() };
    number.unwrap_or_else(|| Value::String(field.to_string()))
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
