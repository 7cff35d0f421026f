//! Writes points in regions.

use std::io::Write;

use super::{StreamWriter, Tag};
use crate::regions::PointRegion;
use spmesh_base::error::Result;

impl<W: Write> StreamWriter<W> {
    /// Starts a region of a stream of points in regions. As many points as it states must follow before the
    /// next region and before the end, in the order of its counts. Flushes the points of the region before.
    ///
    /// # Errors
    /// Malformed, if the box is empty, the region before lacks points, or the region has more points of
    /// earlier regions than these share; I/O, if writing fails.
    pub fn region(&mut self, region: &PointRegion) -> Result<()> {
        self.flush_points()?;
        let rules = self.region_rules.as_mut().expect("the kind of the stream has regions");
        rules.region(region, &mut self.totals)?;
        self.payload.clear();
        region.encode(&mut self.payload);
        self.flush_block(Tag::Region)
    }

    /// Counts points that are about to be written.
    pub(super) fn count_points(&mut self, count: usize) -> Result<()> {
        match &mut self.region_rules {
            Some(rules) if count > 0 => rules.points(count as u64)?,
            Some(_) => {}
            None => self.totals.points += count as u64,
        }
        Ok(())
    }
}
