//! Copies the points of leaves into the regions that have them.

use std::convert::Infallible;
use std::num::NonZeroUsize;

use super::buffer::{CELL_COST, CellBuffers};
use super::in_regions::Regions;
use super::options::Options;
use super::run::Stats;
use crate::regions::Members;
use spmesh_base::error::Result;
use spmesh_delaunay::order::{Curve, Places, SpatialOrder};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Extent;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Header, decode_points};

/// Points whose regions are found one by one. More of them are divided into so many parts.
const ALONE: usize = 32;
const PARTS: usize = 4;

/// Points that a thread takes at least.
const PIECE: usize = 2048;

/// Bytes of records whose regions are found together, at most and at least: leaves that cannot be divided may
/// be large.
const TOGETHER_MAX: u64 = 16 << 20;
const TOGETHER_MIN: u64 = 64 << 10;

/// The points of a region are in four groups: those that are in no other region, in a later one, in an
/// earlier and a later one, and in an earlier one.
pub(super) const GROUPS: usize = 4;

/// The regions that the points of each leaf may have.
pub(super) struct LeafRegions {
    /// Where those of each leaf end.
    ends: Vec<u32>,
    regions: Vec<u32>,
}

impl LeafRegions {
    pub(super) fn of(
        regions: &Regions,
        cells: &[CellCode],
        tree: CellTree,
        threads: NonZeroUsize,
    ) -> LeafRegions {
        let work = |cells: &[CellCode]| {
            let mut members = Members::default();
            let all: Vec<u32> = (0..regions.boxes.len() as u32).collect();
            let of_cell = |&cell| {
                let (low, high) = tree.corners(cell);
                members.of_all([low, high], &all, &regions.diagram, &regions.boxes).to_vec()
            };
            Ok::<Vec<_>, Infallible>(cells.iter().map(of_cell).collect())
        };
        let share = cells.len().div_ceil(threads.get()).max(1);
        let Ok(found) = parallel::map(threads, cells.chunks(share), work);
        let mut leaves = LeafRegions { ends: Vec::with_capacity(cells.len()), regions: Vec::new() };
        for found in found.into_iter().flatten() {
            leaves.regions.extend(found);
            leaves.ends.push(leaves.regions.len() as u32);
        }
        leaves
    }

    /// Those of a leaf, increasing.
    pub(super) fn get(&self, leaf: usize) -> &[u32] {
        let start = leaf.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.regions[start as usize..self.ends[leaf] as usize]
    }

    /// The number of leaves whose points each of `regions` regions may have.
    pub(super) fn leaves(&self, regions: usize) -> Vec<u32> {
        let mut leaves = vec![0; regions];
        self.regions.iter().for_each(|&region| leaves[region as usize] += 1);
        leaves
    }

    /// Bytes that they take.
    pub(super) fn bytes(&self) -> u64 {
        (size_of_val(&*self.ends) + size_of_val(&*self.regions)) as u64
    }
}

/// Finds the groups of points, and copies them there.
pub(super) struct Scatter<'r> {
    regions: &'r Regions,
    header: &'r Header,
    finders: Vec<Members>,
    buffers: CellBuffers,
    /// Points of each group.
    counts: Vec<u64>,
    /// Most regions of a point.
    regions_max: usize,
    /// Bytes of records whose regions are found together, at most.
    together_max: usize,
    /// Whether a leaf has more than that. Points that coincide may then be apart, so that each is searched
    /// alone: they must have the same regions.
    is_split: bool,
    order: SpatialOrder,
    /// Records of a leaf, their points, and for each the range of its groups.
    records: Vec<u8>,
    points: Vec<Point>,
    ranges: Vec<[u32; 2]>,
    groups: Vec<u32>,
}

impl<'r> Scatter<'r> {
    /// Bytes for waiting points, at least: twice what the state of all groups takes, and some pages.
    pub(super) fn bytes_min(regions: &Regions) -> u64 {
        2 * (GROUPS * regions.boxes.len()) as u64 * CELL_COST + (1 << 19)
    }

    pub(super) fn new(
        regions: &'r Regions,
        header: &'r Header,
        options: &Options,
        bytes: u64,
    ) -> Result<Self> {
        let groups = GROUPS * regions.boxes.len();
        let records = header.points.unwrap_or(u64::MAX).saturating_mul(GROUPS as u64);
        let folder = options.temp_dir.clone();
        Ok(Scatter {
            regions,
            header,
            finders: (0..options.regions.threads.get()).map(|_| Members::default()).collect(),
            buffers: CellBuffers::new(groups, header.record_len(), records, bytes, folder, false)?,
            counts: vec![0; groups],
            regions_max: 0,
            together_max: (bytes / 16).clamp(TOGETHER_MIN, TOGETHER_MAX) as usize,
            is_split: false,
            order: SpatialOrder::default(),
            records: Vec::new(),
            points: Vec::new(),
            ranges: Vec::new(),
            groups: Vec::new(),
        })
    }

    /// The number of points of each group of a region.
    pub(super) fn counts(&self, region: usize) -> [u64; GROUPS] {
        std::array::from_fn(|group| self.counts[GROUPS * region + group])
    }

    /// Calls `consume` with the records of a group of a region, and forgets them.
    pub(super) fn drain(
        &mut self,
        region: usize,
        group: usize,
        consume: impl FnMut(&[u8]) -> Result<()>,
    ) -> Result<()> {
        self.buffers.drain(GROUPS * region + group, consume)
    }

    /// Adds the figures to `stats`.
    pub(super) fn add_to(&self, stats: &mut Stats) {
        stats.regions_of_point_max = self.regions_max as u64;
        self.buffers.add_to(stats);
    }

    /// Adds whole records of a leaf whose points have some of these regions.
    pub(super) fn add(&mut self, records: &[u8], found: &[u32]) -> Result<()> {
        if let &[only] = found {
            let group = GROUPS * only as usize;
            self.counts[group] += (records.len() / self.header.record_len()) as u64;
            self.regions_max = self.regions_max.max(1);
            return self.buffers.push(group, records);
        }
        self.records.extend_from_slice(records);
        if self.records.len() < self.together_max {
            return Ok(());
        }
        self.is_split = true;
        self.copy(found)
    }

    /// The leaf has no more records.
    pub(super) fn end_leaf(&mut self, found: &[u32]) -> Result<()> {
        self.copy(found)?;
        self.is_split = false;
        Ok(())
    }

    /// Copies the records so far into the groups of their points.
    fn copy(&mut self, found: &[u32]) -> Result<()> {
        let record_len = self.header.record_len();
        self.points.clear();
        for record in self.records.chunks_exact(record_len) {
            decode_points(self.header, &record[..self.header.point_len()], &mut self.points);
        }
        // Adding zero turns -0.0 into 0.0, so that equal points are the same.
        self.points.iter_mut().for_each(|point| *point = point.map(|coordinate| coordinate + 0.0));
        self.find_groups(found);
        for (record, &[start, end]) in self.records.chunks_exact(record_len).zip(&self.ranges) {
            for &group in &self.groups[start as usize..end as usize] {
                self.counts[group as usize] += 1;
                self.buffers.push(group as usize, record)?;
            }
            self.regions_max = self.regions_max.max((end - start) as usize);
        }
        self.records.clear();
        Ok(())
    }

    /// Finds the groups of the points, along a curve, so that near ones are together.
    fn find_groups(&mut self, found: &[u32]) {
        let Scatter { points, finders, regions, order, ranges, groups, is_split, .. } = self;
        ranges.clear();
        groups.clear();
        if points.is_empty() {
            return;
        }
        let places = order.sort(points, &Extent::of(points), Curve::default());
        let share = points.len().div_ceil(finders.len()).next_multiple_of(PIECE);
        let threads = NonZeroUsize::new(finders.len()).unwrap_or(NonZeroUsize::MIN);
        let pieces: Vec<_> = places.clone().chunks(share).zip(finders).collect();
        let alone = if *is_split { PIECE } else { ALONE };
        let work = |(places, members): (Places, &mut Members)| {
            let mut finding =
                Finding { points, regions, members, alone, ranges: Vec::new(), groups: Vec::new() };
            places.chunks(PIECE).for_each(|places| finding.find(places, found));
            Ok::<_, Infallible>((finding.ranges, finding.groups))
        };
        let Ok(found) = parallel::map(threads, pieces, work);
        ranges.resize(points.len(), [0; 2]);
        for (of_piece, of_points) in found {
            let before = groups.len() as u32;
            for (point, range) in of_piece {
                ranges[point as usize] = range.map(|end| before + end);
            }
            groups.extend(of_points);
        }
        // What was found of one of several equal points holds for all, but they must have the same.
        let mut earlier: Option<u32> = None;
        for place in places {
            if let Some(earlier) =
                earlier.filter(|&earlier| points[earlier as usize] == points[place as usize])
            {
                ranges[place as usize] = ranges[earlier as usize];
            }
            earlier = Some(place);
        }
    }
}

/// Finds the groups of points on one thread.
struct Finding<'f> {
    points: &'f [Point],
    regions: &'f Regions,
    members: &'f mut Members,
    /// So few points are searched one by one.
    alone: usize,
    /// Points with the ranges of their groups, and the groups of all of them.
    ranges: Vec<(u32, [u32; 2])>,
    groups: Vec<u32>,
}

impl Finding<'_> {
    /// Finds the groups of points that have some of the regions `found`.
    fn find(&mut self, places: Places, found: &[u32]) {
        let Regions { diagram, boxes } = self.regions;
        if self.alone < PIECE
            && let Some(only) = self.members.only(self.extent(places.clone()), diagram, boxes)
        {
            let range = enter(&[only], &mut self.groups);
            self.ranges.extend(places.map(|place| (place, range)));
        } else if places.len() <= self.alone {
            for place in places {
                let regions = self.members.of(self.points[place as usize], found, diagram, boxes);
                self.ranges.push((place, enter(regions, &mut self.groups)));
            }
        } else {
            places.clone().chunks(places.len().div_ceil(PARTS)).for_each(|part| self.find(part, found));
        }
    }

    fn extent(&self, places: Places) -> [Point; 2] {
        let Extent { lower, upper, .. } = Extent::of_each(places.map(|place| self.points[place as usize]));
        [lower, upper]
    }
}

/// Appends the groups of a point that is in these regions; returns their range.
fn enter(regions: &[u32], groups: &mut Vec<u32>) -> [u32; 2] {
    let (start, last) = (groups.len() as u32, regions.len() - 1);
    groups.extend(regions.iter().enumerate().map(|(i, &region)| {
        let group = match i {
            _ if last == 0 => 0,
            0 => 1,
            _ if i == last => 3,
            _ => 2,
        };
        GROUPS as u32 * region + group
    }));
    [start, groups.len() as u32]
}
