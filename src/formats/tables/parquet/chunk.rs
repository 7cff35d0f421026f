//! A column of a group of rows: its pages, each compressed when it is full.

use crate::tables::parquet::thrift::{structure, varint};
use crate::tables::parquet::{PLAIN, RLE};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::zstd_frame;

/// Bytes of values after which a page ends. Readers hold whole pages.
const PAGE_LEN: usize = 1 << 20;

/// `PageType::DATA_PAGE`.
const DATA_PAGE: i32 = 0;

/// A column in the current group.
#[derive(Default)]
pub(crate) struct Chunk {
    /// The page that has not ended.
    page: Page,
    /// The others, each behind its header.
    pub(crate) pages: Vec<u8>,
    /// The length that these would have without compression.
    pub(crate) plain_len: usize,
    /// Rows without a value.
    pub(crate) nulls: usize,
}

impl Chunk {
    /// The next row has a number or an integer.
    pub(crate) fn word(&mut self, word: [u8; 8]) {
        self.page.row(true);
        self.page.values.extend_from_slice(&word);
    }

    /// The next row has a text.
    pub(crate) fn text(&mut self, text: &str) {
        self.page.row(true);
        // If the length does not fit, the page will be refused.
        self.page.values.extend_from_slice(&(text.len() as u32).to_le_bytes());
        self.page.values.extend_from_slice(text.as_bytes());
    }

    /// The next row has nothing.
    pub(crate) fn nothing(&mut self) {
        self.page.row(false);
        self.nulls += 1;
    }

    /// Ends the page if it is full.
    pub(crate) fn end_row(&mut self) -> Result<()> {
        if self.page.values.len() >= PAGE_LEN { self.end_page() } else { Ok(()) }
    }

    /// Ends the page unless it has no rows.
    pub(crate) fn end_page(&mut self) -> Result<()> {
        if self.page.rows == 0 {
            return Ok(());
        }
        let page = std::mem::take(&mut self.page);
        let rows = page.rows;
        let content = page.content();
        let frame = zstd_frame(&content);
        let header = header(rows, &content, &frame)?;
        self.plain_len += header.len() + content.len();
        self.pages.extend_from_slice(&header);
        self.pages.extend_from_slice(&frame);
        Ok(())
    }
}

/// Rows of a column.
#[derive(Default)]
struct Page {
    rows: usize,
    /// Definition levels: 1 where a row has a value, 0 where it has none. Each run of equal ones is twice its
    /// length, then the level; the lowest bit would mark levels that are packed.
    levels: Vec<u8>,
    /// Level and length of the last run, which is not among `levels` yet.
    run: (bool, u64),
    /// The values that are there, one behind the other.
    values: Vec<u8>,
}

impl Page {
    fn row(&mut self, is_present: bool) {
        self.rows += 1;
        if self.run.0 != is_present {
            self.end_run();
            self.run = (is_present, 0);
        }
        self.run.1 += 1;
    }

    fn end_run(&mut self) {
        let (level, len) = self.run;
        if len > 0 {
            varint(&mut self.levels, len << 1);
            self.levels.push(level.into());
        }
    }

    /// The levels behind their length, then the values.
    fn content(mut self) -> Vec<u8> {
        self.end_run();
        let levels_len = (self.levels.len() as u32).to_le_bytes();
        [&levels_len[..], &self.levels, &self.values].concat()
    }
}

/// The `PageHeader` of a page: field numbers are those of parquet.thrift.
fn header(rows: usize, content: &[u8], frame: &[u8]) -> Result<Vec<u8>> {
    let (content_len, frame_len) = (length(content.len())?, length(frame.len())?);
    let rows = length(rows)?;
    Ok(structure(|page| {
        page.i32(1, DATA_PAGE);
        page.i32(2, content_len);
        page.i32(3, frame_len);
        page.structure(5, |data| {
            data.i32(1, rows);
            data.i32(2, PLAIN);
            // Of definition levels, and of repetition levels, which a flat table has none of.
            data.i32(3, RLE);
            data.i32(4, RLE);
        });
    }))
}

fn length(len: usize) -> Result<i32> {
    let message = "encoding the table: a page of Parquet would exceed 2 GB: write text (.tsv, .jsonl)";
    i32::try_from(len).map_err(|_| Error::new(ErrorKind::Usage, message))
}
