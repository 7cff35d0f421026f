//! The rows of the points of an event, one by one.

use spmesh_stream::Header;

/// Rows in the order of their points; empty ones without attributes.
pub(crate) struct Rows<'a> {
    rest: &'a [u8],
    row_len: usize,
}

impl<'a> Rows<'a> {
    /// The rows of an event of a stream with this header.
    pub(crate) fn new(header: &Header, rows: &'a [u8]) -> Self {
        Rows { rest: rows, row_len: header.attributes.row_len() }
    }

    /// The row of the next point. There must be one.
    pub(crate) fn next(&mut self) -> &'a [u8] {
        let (row, rest) = self.rest.split_at(self.row_len);
        self.rest = rest;
        row
    }
}
