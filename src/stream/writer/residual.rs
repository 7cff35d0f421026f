//! Writes residuals: points that are left, and walls around what is final.

use std::io::Write;

use super::{StreamWriter, Tag, encode_point};
use crate::model::bounds::Point;
use spmesh_base::error::Result;
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;

impl<W: Write> StreamWriter<W> {
    /// Appends residual points of a stream without attributes, as
    /// [`StreamWriter::residual_points_with_rows`].
    ///
    /// # Errors
    /// As there.
    pub fn residual_points(&mut self, points: &[(Option<u64>, Point)]) -> Result<()> {
        self.residual_points_with_rows(points, &[])
    }

    /// Appends residual points, each with its id if an earlier patch has the vertex. `rows` are their
    /// attributes; empty if the stream has none.
    ///
    /// # Errors
    /// If a coordinate does not fit the encoding, or writing fails.
    pub fn residual_points_with_rows(&mut self, points: &[(Option<u64>, Point)], rows: &[u8]) -> Result<()> {
        let row_len = self.header.attributes.row_len();
        let longest = row_len.max(8 + self.header.point_len());
        let mut rest = rows;
        for points in points.chunks(BLOCK_PAYLOAD_MAX / longest) {
            self.payload.clear();
            for &(id, point) in points {
                self.payload.extend_from_slice(&id.unwrap_or(u64::MAX).to_le_bytes());
                encode_point(&self.header, point, &mut self.payload)?;
            }
            self.flush_block(Tag::ResidualPoints)?;
            let (rows, after) = rest.split_at(points.len() * row_len);
            rest = after;
            self.write_rows(points.len(), rows)?;
            self.totals.residual_points += points.len() as u64;
        }
        Ok(())
    }

    /// Appends walls as the concatenated numbers of their corners, which are residual points written before.
    ///
    /// # Errors
    /// If writing fails.
    pub fn walls(&mut self, walls: &[u32]) -> Result<()> {
        let corners = self.header.kind.vertices_per_wall();
        assert!(walls.len().is_multiple_of(corners), "walls of {corners} corners");
        for walls in walls.chunks(BLOCK_PAYLOAD_MAX / (4 * corners) * corners) {
            let payload = &mut self.payload;
            payload.clear();
            walls.iter().for_each(|corner| payload.extend_from_slice(&corner.to_le_bytes()));
            self.flush_block(Tag::Walls)?;
            self.totals.walls += (walls.len() / corners) as u64;
        }
        Ok(())
    }
}
