//! Rows as groups of Parquet: columns that are compressed with zstd.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::{Column, ColumnKind};
use spmesh_core::error::{Error, ErrorKind, Result};

/// Rows of a group.
const ROWS_MAX: usize = 1 << 16;

/// Bytes of text in a group.
const TEXT_MAX: usize = 8 << 20;

/// Level of a field that has a value; 0 stands for none.
const PRESENT: i16 = 1;

/// Groups of rows. They are encoded to memory, so that failures of the output stay failures of the output.
pub(super) struct ParquetRows {
    writer: SerializedFileWriter<Vec<u8>>,
    columns: Vec<Values>,
    rows: usize,
    /// Bytes of text in the current group.
    text_len: usize,
}

/// The fields of a column in the current group.
struct Values {
    /// For each row, whether there is a value.
    levels: Vec<i16>,
    present: Present,
}

/// Those that are there.
enum Present {
    /// One behind the other, with the end of each.
    Text(Vec<u8>, Vec<usize>),
    Integers(Vec<i64>),
    Numbers(Vec<f64>),
}

impl ParquetRows {
    pub(super) fn new(columns: &[Column]) -> Result<ParquetRows> {
        let compression = Compression::ZSTD(parquet::basic::ZstdLevel::default());
        let producer = concat!("spmesh ", env!("CARGO_PKG_VERSION")).to_string();
        let properties =
            WriterProperties::builder().set_compression(compression).set_created_by(producer).build();
        let schema = schema(columns).map_err(failed)?;
        let writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).map_err(failed)?;
        let columns = columns.iter().map(|column| Values::new(column.kind)).collect();
        Ok(ParquetRows { writer, columns, rows: 0, text_len: 0 })
    }

    pub(super) fn text(&mut self, column: usize, text: &str) {
        if let Present::Text(bytes, ends) = self.present(column) {
            bytes.extend_from_slice(text.as_bytes());
            ends.push(bytes.len());
            self.text_len += text.len();
        }
    }

    pub(super) fn integer(&mut self, column: usize, value: i64) {
        if let Present::Integers(values) = self.present(column) {
            values.push(value);
        }
    }

    pub(super) fn number(&mut self, column: usize, value: f64) {
        if let Present::Numbers(values) = self.present(column) {
            values.push(value);
        }
    }

    pub(super) fn nothing(&mut self, column: usize) {
        self.columns[column].levels.push(0);
    }

    fn present(&mut self, column: usize) -> &mut Present {
        let Values { levels, present } = &mut self.columns[column];
        levels.push(PRESENT);
        present
    }

    /// Ends a row; returns whether the group is full.
    pub(super) fn end(&mut self) -> bool {
        self.rows += 1;
        self.rows == ROWS_MAX || self.text_len >= TEXT_MAX
    }

    /// Ends the group; returns the bytes of the file that are new.
    ///
    /// # Errors
    /// If encoding fails.
    pub(super) fn group(&mut self) -> Result<&mut Vec<u8>> {
        if self.rows > 0 {
            self.encode().map_err(failed)?;
        }
        (self.rows, self.text_len) = (0, 0);
        Ok(self.writer.inner_mut())
    }

    fn encode(&mut self) -> ParquetResult<()> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            column.encode(&mut group)?;
        }
        group.close()?;
        self.writer.flush()?;
        Ok(())
    }

    /// The end of the file, after the last group.
    ///
    /// # Errors
    /// If encoding fails.
    pub(super) fn footer(self) -> Result<Vec<u8>> {
        self.writer.into_inner().map_err(failed)
    }
}

impl Values {
    fn new(kind: ColumnKind) -> Values {
        let present = match kind {
            ColumnKind::Text => Present::Text(Vec::new(), Vec::new()),
            ColumnKind::Integer => Present::Integers(Vec::new()),
            ColumnKind::Number => Present::Numbers(Vec::new()),
        };
        Values { levels: Vec::new(), present }
    }

    fn encode(&mut self, group: &mut SerializedRowGroupWriter<'_, Vec<u8>>) -> ParquetResult<()> {
        let levels = std::mem::take(&mut self.levels);
        match &mut self.present {
            Present::Text(bytes, ends) => {
                let all = ByteArray::from(std::mem::take(bytes));
                let mut start = 0;
                let text = |end| {
                    let from = std::mem::replace(&mut start, end);
                    all.slice(from, end - from)
                };
                let texts: Vec<ByteArray> = std::mem::take(ends).into_iter().map(text).collect();
                write::<ByteArrayType>(group, &texts, &levels)
            }
            Present::Integers(values) => write::<Int64Type>(group, &std::mem::take(values), &levels),
            Present::Numbers(values) => write::<DoubleType>(group, &std::mem::take(values), &levels),
        }
    }
}

/// Writes the next column of a group.
fn write<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[T::T],
    levels: &[i16],
) -> ParquetResult<()> {
    let too_many = || ParquetError::General("more columns than the schema has".to_string());
    let mut column = group.next_column()?.ok_or_else(too_many)?;
    column.typed::<T>().write_batch(values, Some(levels), None)?;
    column.close()
}

fn schema(columns: &[Column]) -> ParquetResult<Arc<Type>> {
    let field = |column: &Column| {
        let (physical, logical) = match column.kind {
            ColumnKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            ColumnKind::Integer => (Physical::INT64, None),
            ColumnKind::Number => (Physical::DOUBLE, None),
        };
        let field = Type::primitive_type_builder(&column.name, physical).with_logical_type(logical);
        field.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<ParquetResult<Vec<_>>>()?;
    Type::group_type_builder("table").with_fields(fields).build().map(Arc::new)
}

fn failed(error: ParquetError) -> Error {
    Error::new(ErrorKind::Io, format!("encoding the table: {error}"))
}
