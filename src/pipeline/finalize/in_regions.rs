//! Pass 3 for points on surfaces: writes them in overlapping regions ([`crate::regions`]).

use std::io::Write;

use super::options::{InRegions, Options, WhenRegions};
use super::plan::Plan;
use super::scatter::{GROUPS, LeafRegions, Scatter};
use super::work::Work;
use crate::reduce::are_on_surface;
use crate::regions::{Boxes, Diagram, Sample, tetrahedra_on_curves};
use spmesh_base::error::Result;
use spmesh_formats::source::Description;
use spmesh_stream::{Header, Kind, PointRegion, StreamWriter};

/// Points of the sample for each region: with more, fewer points are in several regions.
const SAMPLED_PER_REGION: u64 = 2_000;

/// The sample is at most this part of the points, and at least so many.
const SAMPLED_PART: u64 = 8;
const SAMPLED_MIN: u64 = 8;

/// Most points of a sample, and bytes that each takes with its tetrahedra.
const SAMPLED_MAX: u64 = 1 << 17;
const SAMPLED_BYTES: u64 = 1_200;

/// In so many regions is a point, as long as nothing is known.
const COPIES: f64 = 1.5;

/// Regions do not pay if points are in as many on average: most of them near one sphere.
const COPIES_MAX: f64 = 4.0;

/// A sample of fewer points does not tell whether they lie on a surface.
const TELLING: usize = 1 << 12;

/// Bytes of the memory budget for each region, at least.
const BYTES_PER_REGION: u64 = 2 << 10;

/// Bytes of a tetrahedron in a stream of the mesh of points on a curve.
const BYTES_PER_TETRAHEDRON: f64 = 18.0;

/// Bytes for waiting points that are taken at least.
const MEMORY_MIN: u64 = 1 << 20;

/// The sample that the counting pass takes, if points may come in regions.
pub(super) fn sample(options: &Options, description: &Description) -> Option<Sample> {
    let most = (options.budget.bytes() / 3 / SAMPLED_BYTES).clamp(SAMPLED_MIN, SAMPLED_MAX);
    options.may_have_regions(description.dims).then(|| Sample::new(most as usize))
}

/// The division of space into regions.
pub(super) struct Regions {
    pub(super) diagram: Diagram,
    pub(super) boxes: Boxes,
}

/// Writes regions, one after the other, as soon as all leaves that may have points of them are complete.
struct Regional<'r, W: Write> {
    regions: &'r Regions,
    writer: StreamWriter<W>,
    /// For each region, the leaves that it waits for.
    waits: Vec<u32>,
    /// Regions that have been written, and their points.
    written: usize,
    points: u64,
    points_max: u64,
}

impl<W: Write> Regional<'_, W> {
    /// The points of a leaf are in the regions that may have them.
    fn leaf_is_complete(&mut self, regions: &[u32], scatter: &mut Scatter) -> Result<()> {
        regions.iter().for_each(|&region| self.waits[region as usize] -= 1);
        while self.waits.get(self.written) == Some(&0) {
            self.write(scatter)?;
        }
        Ok(())
    }

    /// Writes the next region.
    fn write(&mut self, scatter: &mut Scatter) -> Result<()> {
        let number = self.written;
        let [own, first, again, last] = scatter.counts(number);
        let region = PointRegion { bounds: self.regions.boxes.get(number), own, first, again, last };
        self.writer.region(&region)?;
        for group in 0..GROUPS {
            scatter.drain(number, group, |bytes| self.writer.encoded_records(bytes))?;
        }
        self.written += 1;
        self.points += region.points();
        self.points_max = self.points_max.max(region.points());
        Ok(())
    }
}

impl Work<'_> {
    /// The regions for `points` points, if they come in regions.
    pub(super) fn regions(&mut self, points: u64, options: &Options) -> Result<Option<Regions>> {
        let Some(mut sample) = self.sample.take() else { return Ok(None) };
        let InRegions { when, points: region_points, .. } = options.regions;
        let most = (options.budget.bytes() / BYTES_PER_REGION).max(1);
        let of_copies = |copies: f64| (points as f64 * copies / region_points.max(1) as f64).ceil() as u64;
        let count = of_copies(COPIES).min(most);
        let sampled = (SAMPLED_PER_REGION.saturating_mul(count)).min(points / SAMPLED_PART).max(SAMPLED_MIN);
        let distinct = sample.distinct().unwrap_or(points);
        let (mut sample, before) = sample.take(usize::MAX);
        if let Some(tetrahedra) = tetrahedra_on_curves(&sample, distinct)? {
            let gigabytes = tetrahedra * BYTES_PER_TETRAHEDRON / 1e9;
            self.observer.notice(&format!(
                "points on curves have tetrahedra by the square of their number: about {tetrahedra:.1e}, a mesh of {gigabytes:.1} GB"
            ));
            return Ok(None);
        }
        let tells = sample.len() >= TELLING;
        if when == WhenRegions::Auto && (points <= region_points || !tells || !are_on_surface(&sample)) {
            return Ok(None);
        }
        sample.truncate(sampled as usize);
        let Some(mut diagram) = Diagram::of(&sample)? else { return Ok(None) };
        let boxes = Boxes::lay(&diagram, &before, count as usize);
        // Now it is known how many copies there will be, and so how large the regions.
        let count = of_copies(boxes.copies(&diagram)).min(most);
        let boxes = Boxes::lay(&diagram, &before, count as usize);
        let pays = boxes.len() > 1 && boxes.copies(&diagram) < COPIES_MAX;
        if when == WhenRegions::Auto && !pays {
            return Ok(None);
        }
        boxes.place_centres(&mut diagram);
        Ok(Some(Regions { diagram, boxes }))
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
        let of_leaves = LeafRegions::of(regions, plan.cells(), plan.tree(), options.regions.threads);
        let header = Header { kind: Kind::RegionPoints, chunked: false, ..header };
        let writer = StreamWriter::new(output, header)?;
        let header = writer.header().clone();
        let waits = of_leaves.leaves(regions.boxes.len());
        let mut regional = Regional { regions, writer, waits, written: 0, points: 0, points_max: 0 };
        // Half for points whose leaf is not complete, half for those whose regions are found: near points
        // together, since much of the search is common to them.
        let held = regions.diagram.bytes() + of_leaves.bytes();
        let bytes = options.budget.bytes().saturating_sub(held).max(MEMORY_MIN) / 2;
        let mut scatter = Scatter::new(regions, &header, options, bytes.max(Scatter::bytes_min(regions)))?;
        self.hold_leaves(plan, options, &header, bytes, |leaves, _, buffers| {
            // So that the first regions are complete soon where all leaves are complete at once.
            leaves.sort_by_key(|&leaf| of_leaves.get(leaf)[0]);
            leaves.iter().try_for_each(|&leaf| {
                let found = of_leaves.get(leaf);
                buffers.drain(leaf, |records| scatter.add(records, found))?;
                scatter.end_leaf(found)?;
                regional.leaf_is_complete(found, &mut scatter)
            })
        })?;
        let Regional { writer, written, points, points_max, .. } = regional;
        debug_assert_eq!(written, regions.boxes.len(), "all leaves are complete");
        (self.stats.regions, self.stats.region_points) = (written as u64, points);
        self.stats.region_points_max = points_max;
        scatter.add_to(&mut self.stats);
        writer.end(0, 0).map(drop)
    }
}
