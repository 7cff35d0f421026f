//! Pass 3 for points on surfaces: writes them in overlapping regions ([`crate::regions`]).

use std::convert::Infallible;
use std::io::Write;
use std::num::NonZeroUsize;

use super::buffer::CellBuffers;
use super::options::{InRegions, Options, WhenRegions};
use super::plan::Plan;
use super::work::Work;
use crate::reduce::are_on_surface;
use crate::regions::{Boxes, Diagram, Members, Sample};
use spmesh_base::error::Result;
use spmesh_delaunay::order::{Curve, Places, SpatialOrder};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Extent;
use spmesh_formats::source::Description;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Header, Kind, PointRegion, StreamWriter, decode_points};

/// Points of the sample for each region: with more, fewer points are in several regions.
const SAMPLED_PER_REGION: u64 = 1_000;

/// The sample is at most this part of the points, and at least so many.
const SAMPLED_PART: u64 = 8;
const SAMPLED_MIN: u64 = 8;

/// Most points of a sample, and bytes that each takes with its tetrahedra.
const SAMPLED_MAX: u64 = 1 << 17;
const SAMPLED_BYTES: u64 = 1_200;

/// Regions do not pay if points are in as many on average: most of them near one sphere.
const COPIES_MAX: f64 = 4.0;

/// Fewer points do not tell on what they lie.
const TELLING: usize = 1 << 12;

/// Points whose regions are found together.
const CLUSTER: usize = 32;

/// Points that a thread takes at least.
const PIECE: usize = 64 * CLUSTER;

/// Bytes of records whose regions are found together, at most and at least: leaves that cannot be divided may
/// be large.
const TOGETHER_MAX: u64 = 16 << 20;
const TOGETHER_MIN: u64 = 64 << 10;

/// Bytes of the memory budget for each region, at least.
const BYTES_PER_REGION: u64 = 2 << 10;

/// Bytes for waiting points that are taken at least.
const MEMORY_MIN: u64 = 1 << 20;

/// A region and a point copied into it, in groups: those of no other region, those that are in a later one,
/// in an earlier and a later one, and in an earlier one.
const GROUPS: usize = 4;

/// The sample that the counting pass takes, if points may come in regions.
pub(super) fn sample(options: &Options, description: &Description) -> Option<Sample> {
    let most = (options.budget.bytes() / 3 / SAMPLED_BYTES).clamp(SAMPLED_MIN, SAMPLED_MAX);
    options.may_have_regions(description.dims).then(|| Sample::new(most as usize))
}

/// The division of space into regions.
pub(super) struct Regions {
    diagram: Diagram,
    boxes: Boxes,
}

/// Finds the groups of points, and copies them there.
struct Scatter<'r> {
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

impl Work<'_> {
    /// The regions for `points` points, if they come in regions.
    pub(super) fn regions(&mut self, points: u64, options: &Options) -> Result<Option<Regions>> {
        let Some(sample) = self.sample.take() else { return Ok(None) };
        let InRegions { when, points: region_points, .. } = options.regions;
        // About as many points are copies.
        let most = options.budget.bytes() / BYTES_PER_REGION;
        let count = points.saturating_mul(2).div_ceil(region_points.max(1)).min(most.max(1));
        let sampled = (SAMPLED_PER_REGION.saturating_mul(count)).min(points / SAMPLED_PART).max(SAMPLED_MIN);
        let mut sample = sample.take(usize::MAX);
        let tells = sample.len() >= TELLING;
        if when == WhenRegions::Auto && (points <= region_points || !tells || !are_on_surface(&sample)) {
            return Ok(None);
        }
        sample.truncate(sampled as usize);
        let Some(mut diagram) = Diagram::of(&sample)? else { return Ok(None) };
        let boxes = Boxes::lay(&mut diagram, count as usize);
        let pays = boxes.len() > 1 && boxes.copies(&diagram) < COPIES_MAX;
        Ok((when == WhenRegions::Always || pays).then_some(Regions { diagram, boxes }))
    }

    /// Holds the points of all regions, and writes one region after the other.
    pub(super) fn write_in_regions<W: Write>(
        &mut self,
        regions: &Regions,
        mut plan: Plan,
        header: Header,
        options: &Options,
        output: W,
    ) -> Result<()> {
        plan.take_empty();
        let header = Header { kind: Kind::RegionPoints, chunked: false, ..header };
        let mut writer = StreamWriter::new(output, header)?;
        let header = writer.header().clone();
        // Half for points whose leaf is not complete, half for those whose regions are found: near points
        // together, since much of the search is common to them.
        let bytes = options.budget.bytes().saturating_sub(regions.diagram.bytes()).max(MEMORY_MIN) / 2;
        let mut scatter = Scatter::new(regions, &header, options, bytes)?;
        self.hold_leaves(plan, options, &header, bytes, |leaf, _, buffers| {
            buffers.drain(leaf, |records| scatter.add(records))?;
            scatter.end_leaf()
        })?;
        let Scatter { mut buffers, counts, regions_max, .. } = scatter;
        for (number, counts) in counts.chunks_exact(GROUPS).enumerate() {
            let &[own, first, again, last] = counts else { unreachable!("chunks of four") };
            let region = PointRegion { bounds: regions.boxes.get(number), own, first, again, last };
            writer.region(&region)?;
            for group in 0..GROUPS {
                buffers.drain(GROUPS * number + group, |bytes| writer.encoded_records(bytes))?;
            }
            self.stats.region_points += region.points();
            self.stats.region_points_max = self.stats.region_points_max.max(region.points());
        }
        (self.stats.regions, self.stats.regions_of_point_max) =
            (regions.boxes.len() as u64, regions_max as u64);
        buffers.add_to(&mut self.stats);
        writer.end(0, 0).map(drop)
    }
}

impl<'r> Scatter<'r> {
    fn new(regions: &'r Regions, header: &'r Header, options: &Options, bytes: u64) -> Result<Self> {
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

    /// Adds whole records of a leaf.
    fn add(&mut self, records: &[u8]) -> Result<()> {
        self.records.extend_from_slice(records);
        if self.records.len() < self.together_max {
            return Ok(());
        }
        self.is_split = true;
        self.copy()
    }

    /// The leaf has no more records.
    fn end_leaf(&mut self) -> Result<()> {
        self.copy()?;
        self.is_split = false;
        Ok(())
    }

    /// Copies the records so far into the groups of their points.
    fn copy(&mut self) -> Result<()> {
        let record_len = self.header.record_len();
        self.points.clear();
        for record in self.records.chunks_exact(record_len) {
            decode_points(self.header, &record[..self.header.point_len()], &mut self.points);
        }
        // Adding zero turns -0.0 into 0.0, so that equal points are the same.
        self.points.iter_mut().for_each(|point| *point = point.map(|coordinate| coordinate + 0.0));
        self.find_groups();
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
    fn find_groups(&mut self) {
        let Scatter { points, finders, regions, order, ranges, groups, is_split, .. } = self;
        let cluster = if *is_split { 1 } else { CLUSTER };
        ranges.clear();
        groups.clear();
        if points.is_empty() {
            return;
        }
        let places = order.sort(points, &Extent::of(points), Curve::default());
        let share = points.len().div_ceil(finders.len()).next_multiple_of(PIECE);
        let threads = NonZeroUsize::new(finders.len()).unwrap_or(NonZeroUsize::MIN);
        let pieces: Vec<_> = places.clone().chunks(share).zip(finders).collect();
        let work = |(places, finder): (Places, &mut Members)| {
            Ok::<_, Infallible>(groups_of(points, places, cluster, regions, finder))
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

/// Points with the ranges of their groups, and the groups of all of them.
type Found = (Vec<(u32, [u32; 2])>, Vec<u32>);

fn groups_of(
    points: &[Point],
    places: Places,
    cluster: usize,
    regions: &Regions,
    finder: &mut Members,
) -> Found {
    let Regions { diagram, boxes } = regions;
    let (mut ranges, mut groups) = (Vec::with_capacity(places.len()), Vec::with_capacity(2 * places.len()));
    let mut near = Vec::with_capacity(cluster);
    for places in places.chunks(cluster) {
        near.clear();
        near.extend(places.clone().map(|place| points[place as usize]));
        if cluster > 1
            && let Some(only) = finder.of_all(&near, diagram, boxes)
        {
            let range = enter(&[only], &mut groups);
            ranges.extend(places.map(|place| (place, range)));
            continue;
        }
        for (place, &point) in places.zip(&near) {
            ranges.push((place, enter(finder.of(point, diagram, boxes), &mut groups)));
        }
    }
    (ranges, groups)
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
