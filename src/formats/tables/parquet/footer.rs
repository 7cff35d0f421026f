//! The end of a file of Parquet: what its columns are, and where their pages are.

use crate::tables::parquet::chunk::Chunk;
use crate::tables::parquet::thrift::{Fields, structure};
use crate::tables::parquet::{MAGIC, PLAIN, RLE};
use crate::tables::{Column, ColumnKind};

/// Values of `Type`, the types of values as they are stored.
const INT64: i32 = 2;
const DOUBLE: i32 = 5;
const BYTE_ARRAY: i32 = 6;
/// `ConvertedType::UTF8`, which older readers look for.
const UTF8: i32 = 0;
/// `FieldRepetitionType::OPTIONAL`: a row may have no value.
const OPTIONAL: i32 = 1;
/// `CompressionCodec::ZSTD`.
const ZSTD: i32 = 6;
/// Version of the format that has all that is written here.
const VERSION: i32 = 1;

/// `FileMetaData` while the file is written.
pub(crate) struct Footer {
    columns: Vec<Column>,
    groups: Vec<Group>,
    /// Bytes of the file so far.
    file_len: u64,
}

/// `RowGroup`.
struct Group {
    rows: u64,
    chunks: Vec<Place>,
}

/// What `ColumnMetaData` states of a column in a group.
pub(crate) struct Place {
    offset: u64,
    len: u64,
    plain_len: u64,
    nulls: u64,
}

impl Footer {
    /// That of a file that has its first bytes alone.
    pub(crate) fn new(columns: &[Column]) -> Footer {
        Footer { columns: columns.to_vec(), groups: Vec::new(), file_len: MAGIC.len() as u64 }
    }

    /// Notes a group whose chunks come next in the file, in order.
    pub(crate) fn add(&mut self, rows: usize, chunks: &[Chunk]) {
        let place = |chunk: &Chunk| {
            let (offset, len) = (self.file_len, chunk.pages.len() as u64);
            self.file_len += len;
            Place { offset, len, plain_len: chunk.plain_len as u64, nulls: chunk.nulls as u64 }
        };
        let chunks = chunks.iter().map(place).collect();
        self.groups.push(Group { rows: rows as u64, chunks });
    }

    /// The metadata, their length, and the bytes that end a file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = structure(|file| self.write(file));
        bytes.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        bytes.extend_from_slice(MAGIC);
        bytes
    }

    /// Field numbers, here and below, are those of parquet.thrift.
    fn write(&self, file: &mut Fields) {
        file.i32(1, VERSION);
        // The first element is the table, the others are its columns.
        let elements = std::iter::once(None).chain(self.columns.iter().map(Some)).collect::<Vec<_>>();
        file.structures(2, elements.into_iter(), |element, column| match column {
            Some(column) => write_column(element, column),
            None => {
                element.text(4, "table");
                element.i32(5, self.columns.len() as i32);
            }
        });
        file.i64(3, self.groups.iter().map(|group| group.rows).sum());
        file.structures(4, self.groups.iter(), |fields, group| self.write_group(fields, group));
        file.text(6, concat!("spmesh ", env!("CARGO_PKG_VERSION")));
    }

    fn write_group(&self, fields: &mut Fields, group: &Group) {
        fields.structures(1, self.columns.iter().zip(&group.chunks), |chunk, (column, place)| {
            // Where there are metadata outside of the footer: nowhere.
            chunk.i64(2, 0);
            chunk.structure(3, |metadata| write_place(metadata, column, place, group.rows));
        });
        fields.i64(2, group.chunks.iter().map(|place| place.plain_len).sum());
        fields.i64(3, group.rows);
    }
}

/// `SchemaElement`.
fn write_column(element: &mut Fields, column: &Column) {
    element.i32(1, stored_type(column));
    element.i32(3, OPTIONAL);
    element.text(4, &column.name);
    if column.kind == ColumnKind::Text {
        element.i32(6, UTF8);
        // `LogicalType::STRING`, a structure without fields.
        element.structure(10, |logical| logical.structure(1, |_| ()));
    }
}

/// `ColumnMetaData`. Rows without a value count as values.
fn write_place(metadata: &mut Fields, column: &Column, place: &Place, rows: u64) {
    metadata.i32(1, stored_type(column));
    metadata.i32s(2, &[PLAIN, RLE]);
    metadata.texts(3, &[&column.name]);
    metadata.i32(4, ZSTD);
    metadata.i64(5, rows);
    metadata.i64(6, place.plain_len);
    metadata.i64(7, place.len);
    metadata.i64(9, place.offset);
    metadata.structure(12, |statistics| statistics.i64(3, place.nulls));
}

fn stored_type(column: &Column) -> i32 {
    match column.kind {
        ColumnKind::Text => BYTE_ARRAY,
        ColumnKind::Integer => INT64,
        ColumnKind::Number => DOUBLE,
    }
}
