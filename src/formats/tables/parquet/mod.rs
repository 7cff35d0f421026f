//! Rows as a file of Apache Parquet.
//!
//! A file starts and ends with `PAR1`. Groups of rows follow one another; each has its columns, in order, as
//! *chunks* of pages. The footer says where chunks start. What is written is the least that readers ask for:
//!
//! * Each column is optional, and of the type INT64, DOUBLE or BYTE_ARRAY; the last is a string in UTF-8.
//! * A page is a header, then a zstd frame. In it are definition levels, as runs behind their length, then
//!   the values, encoded as PLAIN: eight bytes, or four bytes of length and the text; all little-endian.
//! * Of statistics, there are the numbers of rows without a value. Neither dictionaries nor indexes nor
//!   checksums are written: on tables of atoms, frames are smaller without dictionaries.
//!
//! Specification: apache/parquet-format, README.md (layout), Encodings.md (PLAIN, and RLE for levels) and
//! src/main/thrift/parquet.thrift (metadata, in the compact protocol of Thrift).

mod chunk;
mod footer;
mod thrift;

use self::chunk::Chunk;
use self::footer::Footer;
use crate::tables::Column;
use spmesh_base::error::Result;

/// First and last bytes of a file.
const MAGIC: &[u8; 4] = b"PAR1";

/// Values of `Encoding`.
const PLAIN: i32 = 0;
const RLE: i32 = 3;

/// Rows of a group.
const ROWS_MAX: usize = 1 << 16;

/// Bytes of text in a group.
const TEXT_MAX: usize = 8 << 20;

/// A table while it is written.
///
/// Memory: the pages of the current group, compressed but for the last of each column, and for the footer 32
/// bytes per column of each group.
pub(crate) struct ParquetRows {
    chunks: Vec<Chunk>,
    rows: usize,
    /// Bytes of text in the current group.
    text_len: usize,
    footer: Footer,
    /// Bytes of the file that were not written yet.
    bytes: Vec<u8>,
}

impl ParquetRows {
    pub(crate) fn new(columns: &[Column]) -> ParquetRows {
        ParquetRows {
            chunks: empty_chunks(columns.len()),
            rows: 0,
            text_len: 0,
            footer: Footer::new(columns),
            bytes: MAGIC.to_vec(),
        }
    }

    pub(crate) fn text(&mut self, column: usize, text: &str) {
        self.chunks[column].text(text);
        self.text_len += text.len();
    }

    pub(crate) fn integer(&mut self, column: usize, value: i64) {
        self.chunks[column].word(value.to_le_bytes());
    }

    pub(crate) fn number(&mut self, column: usize, value: f64) {
        self.chunks[column].word(value.to_le_bytes());
    }

    pub(crate) fn nothing(&mut self, column: usize) {
        self.chunks[column].nothing();
    }

    /// Ends a row; returns whether the group is full.
    pub(crate) fn end(&mut self) -> Result<bool> {
        self.rows += 1;
        self.chunks.iter_mut().try_for_each(Chunk::end_row)?;
        Ok(self.rows == ROWS_MAX || self.text_len >= TEXT_MAX)
    }

    /// Ends the group; returns the bytes of the file that are new.
    pub(crate) fn group(&mut self) -> Result<&mut Vec<u8>> {
        if self.rows > 0 {
            self.chunks.iter_mut().try_for_each(Chunk::end_page)?;
            self.footer.add(self.rows, &self.chunks);
            self.chunks.iter().for_each(|chunk| self.bytes.extend_from_slice(&chunk.pages));
            self.chunks = empty_chunks(self.chunks.len());
            (self.rows, self.text_len) = (0, 0);
        }
        Ok(&mut self.bytes)
    }

    /// The end of the file, after the last group.
    pub(crate) fn footer(&self) -> Vec<u8> {
        self.footer.bytes()
    }
}

fn empty_chunks(count: usize) -> Vec<Chunk> {
    std::iter::repeat_with(Chunk::default).take(count).collect()
}
