//! Rows that wait for their turn in a table whose format has no lines.

use std::ops::Range;

use super::TableSink;
use spmesh_base::error::Result;

/// Fields of rows, one after the other.
#[derive(Debug, Default)]
pub(crate) struct HeldRows {
    fields: Vec<Field>,
    /// The texts of all fields.
    texts: String,
}

#[derive(Debug)]
enum Field {
    Text(Range<usize>),
    Integer(i64),
    Number(f64),
    Nothing,
}

impl HeldRows {
    pub(crate) fn text(&mut self, text: &str) {
        let start = self.texts.len();
        self.texts.push_str(text);
        self.fields.push(Field::Text(start..self.texts.len()));
    }

    pub(crate) fn integer(&mut self, value: i64) {
        self.fields.push(Field::Integer(value));
    }

    pub(crate) fn number(&mut self, value: f64) {
        self.fields.push(Field::Number(value));
    }

    pub(crate) fn nothing(&mut self) {
        self.fields.push(Field::Nothing);
    }

    /// Gives all rows of so many columns to a table.
    pub(crate) fn give(&self, columns: usize, table: &mut TableSink) -> Result<()> {
        for row in self.fields.chunks(columns) {
            for field in row {
                match field {
                    Field::Text(range) => table.field(&self.texts[range.clone()]),
                    Field::Integer(value) => table.integer(*value)?,
                    Field::Number(value) => table.number(*value),
                    Field::Nothing => table.nothing(),
                }
            }
            table.end()?;
        }
        Ok(())
    }
}
