//! Writes points with their attributes.

use std::io::Write;

use super::{POINTS_PAYLOAD, StreamWriter, Tag, check_len, encode_points};
use crate::model::bounds::Point;
use spmesh_base::error::Result;
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

impl<W: Write> StreamWriter<W> {
    /// Appends points to a points stream, with a row for each if the header lists attributes.
    ///
    /// # Errors
    /// If a coordinate does not fit the encoding of the header, a region gets more points than it states, or
    /// writing fails.
    pub fn points_with_rows(&mut self, points: &[Point], rows: &[u8]) -> Result<()> {
        let row_len = self.header.attributes.row_len();
        if row_len == 0 {
            return self.points(points);
        }
        assert_eq!(rows.len(), points.len() * row_len, "a row for each point");
        self.count_points(points.len())?;
        let (mut points, mut rows) = (points, rows);
        while !points.is_empty() {
            let count = self.points_left().min(points.len());
            let (now, later) = points.split_at(count);
            let (rows_now, rows_later) = rows.split_at(count * row_len);
            encode_points(&self.header, now, &mut self.points)?;
            self.rows.extend_from_slice(rows_now);
            (points, rows) = (later, rows_later);
            self.flush_if_no_points_left()?;
        }
        Ok(())
    }

    /// Appends records: each is a point that [`encode_points`] has encoded, and then its row, if the header
    /// lists attributes.
    ///
    /// # Errors
    /// If a region gets more points than it states, or writing fails.
    pub fn encoded_records(&mut self, bytes: &[u8]) -> Result<()> {
        if self.header.attributes.is_empty() {
            return self.encoded_points(bytes);
        }
        let (point_len, record_len) = (self.header.point_len(), self.header.record_len());
        debug_assert!(bytes.len().is_multiple_of(record_len));
        self.count_points(bytes.len() / record_len)?;
        for record in bytes.chunks_exact(record_len) {
            let (point, row) = record.split_at(point_len);
            self.points.extend_from_slice(point);
            self.rows.extend_from_slice(row);
            self.flush_if_no_points_left()?;
        }
        Ok(())
    }

    /// Number of points that still fit into the block, with their rows into the block behind it.
    fn points_left(&self) -> usize {
        let (point_len, row_len) = (self.header.point_len(), self.header.attributes.row_len());
        let points_max = (POINTS_PAYLOAD / point_len).min(BLOCK_PAYLOAD_MAX / row_len);
        points_max - self.points.len() / point_len
    }

    fn flush_if_no_points_left(&mut self) -> Result<()> {
        if self.points_left() == 0 { self.flush_points() } else { Ok(()) }
    }

    /// Writes the rows of the points of the block before.
    pub(super) fn flush_rows(&mut self) -> Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        self.check_weights(&self.rows)?;
        std::mem::swap(&mut self.rows, &mut self.payload);
        self.write_block(Tag::Rows)?;
        self.rows.clear();
        Ok(())
    }

    /// Writes the rows of the `points` of the block before, unless there are none.
    pub(super) fn write_rows(&mut self, points: usize, rows: &[u8]) -> Result<()> {
        assert_eq!(rows.len(), points * self.header.attributes.row_len(), "a row for each point");
        if rows.is_empty() {
            return Ok(());
        }
        check_len(rows.len())?;
        self.check_weights(rows)?;
        self.payload.clear();
        self.payload.extend_from_slice(rows);
        self.write_block(Tag::Rows)
    }

    /// Checks that weights are as the header says.
    fn check_weights(&self, rows: &[u8]) -> Result<()> {
        self.header.weights().map_or(Ok(()), |weights| weights.check(rows))
    }

    /// Asserts that points need no rows.
    pub(super) fn expect_no_attributes(&self) {
        assert!(self.header.attributes.is_empty(), "points of this stream have rows");
    }
}
