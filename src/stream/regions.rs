//! Points of space in regions that overlap: the block before the points of each region, and the rules over
//! all regions.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::event::Totals;
use super::header::Header;
use super::kind::Kind;
use crate::model::bounds::Region;
use spmesh_base::error::{Error, Result};

/// Length of the payload of a region, in bytes.
const REGION_LEN: usize = 80;

/// One region of a stream of points in regions. Its points follow it in the stream: those that no other
/// region has, then the others in the order of the counts. A stream has each point once for each region that
/// has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointRegion {
    /// The half-open box of the region, in stored coordinates. Sides may be infinite, but not NaN, and the
    /// box is not empty. Points of the region may lie outside.
    pub bounds: Region<3>,
    /// Points that no other region has.
    pub own: u64,
    /// Points that later regions have too, and no earlier one.
    pub first: u64,
    /// Points that both earlier and later regions have.
    pub again: u64,
    /// Points that earlier regions have too, and no later one.
    pub last: u64,
}

impl PointRegion {
    /// Points of the region, those of other regions included: at most 2^64 - 2 in a region that a reader
    /// returned or a writer accepts. For greater sums, 2^64 - 1.
    pub fn points(&self) -> u64 {
        self.own.saturating_add(self.first).saturating_add(self.again).saturating_add(self.last)
    }

    /// Points that no earlier region has.
    pub fn new_points(&self) -> u64 {
        self.own.saturating_add(self.first)
    }

    /// Decodes the payload of a region; [`RegionRules`] checks the region.
    pub(super) fn decode(bytes: &[u8]) -> Result<Self> {
        if bytes.len() != REGION_LEN {
            return Err(Error::malformed(format!("region of {} bytes, expected {REGION_LEN}", bytes.len())));
        }
        let side = |axis: usize| LE::read_f64(&bytes[8 * axis..]);
        let count = |number: usize| LE::read_u64(&bytes[48 + 8 * number..]);
        Ok(PointRegion {
            bounds: Region { min: [side(0), side(1), side(2)], max: [side(3), side(4), side(5)] },
            own: count(0),
            first: count(1),
            again: count(2),
            last: count(3),
        })
    }

    /// Appends the payload of the region.
    pub(super) fn encode(&self, bytes: &mut Vec<u8>) {
        let PointRegion { bounds, own, first, again, last } = self;
        bounds.sides().as_flattened().iter().for_each(|side| bytes.extend_from_slice(&side.to_le_bytes()));
        [own, first, again, last].iter().for_each(|count| bytes.extend_from_slice(&count.to_le_bytes()));
    }
}

/// Counts the points of regions, and checks that regions agree on which points they share. Writer, reader and
/// text twin have these rules in common.
#[derive(Debug, Default)]
pub(super) struct RegionRules {
    /// Regions so far.
    regions: u64,
    /// Points that the last region states, and those that have come.
    stated: u64,
    found: u64,
    /// Points of regions so far that a later region must have, too.
    live: u64,
}

impl RegionRules {
    /// The rules of a stream with this header; `None` if it has no regions.
    pub(super) fn of(header: &Header) -> Option<RegionRules> {
        (header.kind == Kind::RegionPoints).then(RegionRules::default)
    }

    /// Checks the next region, and counts its new points.
    pub(super) fn region(&mut self, region: &PointRegion, totals: &mut Totals) -> Result<()> {
        self.check_complete()?;
        let number = self.regions + 1;
        let Region { min, max } = region.bounds;
        // A comparison with NaN is false.
        if !(0..3).all(|axis| min[axis] < max[axis]) {
            return Err(Error::malformed(format!("region {number}: the box is empty, or a side is NaN")));
        }
        let points = totals.points.saturating_add(region.new_points());
        if points.max(region.points()) == u64::MAX {
            return Err(Error::malformed(format!(
                "region {number}: its points are beyond counting, at most 2^64 - 2"
            )));
        }
        let shared = region.again + region.last;
        if shared > self.live {
            return Err(Error::malformed(format!(
                "region {number} has {shared} points of earlier regions, but these share {} with later ones",
                self.live
            )));
        }
        totals.points = points;
        self.live = self.live - region.last + region.first;
        (self.regions, self.stated, self.found) = (number, region.points(), 0);
        Ok(())
    }

    /// Counts points of the last region.
    pub(super) fn points(&mut self, count: u64) -> Result<()> {
        if self.regions == 0 {
            return Err(Error::malformed("points before the first region"));
        }
        let found = self.found.saturating_add(count);
        if found > self.stated {
            return Err(Error::malformed(format!(
                "region {} states {} points, at least {found} follow",
                self.regions, self.stated
            )));
        }
        self.found = found;
        Ok(())
    }

    /// Checks the rules of the end: all regions are complete, and each point that is shared was in its last
    /// region. `points` is the number that the header states, if it does.
    pub(super) fn check_end(&self, points: Option<u64>, totals: &Totals) -> Result<()> {
        self.check_complete()?;
        if self.live > 0 {
            return Err(Error::malformed(format!(
                "END: {} points that regions share with later ones are in no later one",
                self.live
            )));
        }
        if points.is_some_and(|points| points != totals.points) {
            return Err(Error::malformed("END: the header states another number of points"));
        }
        Ok(())
    }

    fn check_complete(&self) -> Result<()> {
        if self.found == self.stated {
            return Ok(());
        }
        Err(Error::malformed(format!(
            "region {} states {} points, {} follow",
            self.regions, self.stated, self.found
        )))
    }
}
