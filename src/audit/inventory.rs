//! Counts the content of a stream.

use std::collections::HashSet;

use super::configurations::{Claim, FARAWAY};
use super::regions::RegionInventory;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells4::Point4;
use spmesh_stream::{ConfigurationBlock, Event, Header, MemoryRules, Patch, Totals};

/// Counts of a stream, gathered event by event. It also verifies the rules that the reader of the container
/// does not check, because that takes memory.
#[derive(Debug)]
pub struct Inventory {
    rules: MemoryRules,
    vertices_per_simplex: usize,
    vertices_per_wall: usize,
    labels: u64,
    found: Option<Bounds>,
    totals: Totals,
    patches: u64,
    largest_patch: PatchSize,
    cells: CellPoints,
    /// Points since the last tag.
    run: u64,
    /// The content of four dimensions.
    four: Inventory4,
    configurations: ConfigurationInventory,
    constraints: ConstraintInventory,
    regions: RegionInventory,
}

/// Size of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct PatchSize {
    /// Simplices.
    pub simplices: u64,
    /// Vertices that the patch brings.
    pub new: u64,
    /// Vertices of earlier patches that it uses.
    pub imported: u64,
}

/// Points before cell tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CellPoints {
    /// Number of times that points were followed by tags.
    pub runs: u64,
    /// Points in all these runs.
    pub points: u64,
    /// Points in the longest.
    pub max: u64,
}

impl Inventory {
    /// An inventory of a stream with this header.
    pub fn new(header: &Header) -> Self {
        Inventory {
            rules: MemoryRules::new(header),
            vertices_per_simplex: header.kind.vertices_per_simplex(),
            vertices_per_wall: header.kind.vertices_per_wall(),
            labels: 0,
            found: None,
            totals: Totals::default(),
            patches: 0,
            largest_patch: PatchSize::default(),
            cells: CellPoints::default(),
            run: 0,
            four: Inventory4::default(),
            configurations: ConfigurationInventory::default(),
            constraints: ConstraintInventory::default(),
            regions: RegionInventory::default(),
        }
    }

    /// Adds the next event.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] as [`MemoryRules::check`].
    pub fn event(&mut self, event: &Event) -> Result<()> {
        self.rules.check(event)?;
        match event {
            Event::Points(points) => {
                self.extend(points.iter().copied());
                if self.regions.regions == 0 {
                    self.totals.points += points.len() as u64;
                }
                self.run += points.len() as u64;
            }
            Event::Cells(cells) => {
                self.totals.cells += cells.len() as u64;
                self.end_run();
            }
            Event::Region(region) => {
                self.regions.region(region);
                self.totals.points = self.totals.points.saturating_add(region.new_points());
            }
            Event::Patch(patch) => {
                self.patch(patch);
                self.constraints.event(event);
            }
            Event::Segments(_) | Event::OpenSegments(_) => self.constraints.event(event),
            Event::Labels(labels) => self.labels += labels.len() as u64,
            Event::ResidualPoints(points) => {
                self.extend(points.iter().map(|&(_, point)| point));
                self.totals.residual_points += points.len() as u64;
            }
            Event::Walls(walls) => self.totals.walls += (walls.len() / self.vertices_per_wall) as u64,
            Event::Points4(_) | Event::Cells4(_) | Event::Simplices4(_) => self.four.event(event),
            Event::Configurations(block) => self.configurations.block(block),
            Event::Functions(functions) => self.totals.vertices += functions.len() as u64,
            Event::Coefficients(numbers) => self.totals.residual_points += numbers.len() as u64,
            Event::End(totals) => self.totals = *totals,
        }
        Ok(())
    }

    /// Totals of the blocks so far; after the end, what END states.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// The content of four dimensions.
    pub fn four(&self) -> &Inventory4 {
        &self.four
    }

    /// The configurations.
    pub fn configurations(&self) -> &ConfigurationInventory {
        &self.configurations
    }

    /// The regions of points.
    pub fn regions(&self) -> RegionInventory {
        self.regions
    }

    /// What constrains a triangle mesh.
    pub fn constraints(&self) -> &ConstraintInventory {
        &self.constraints
    }

    /// Bounding box of all points, in stored coordinates, of two or three dimensions.
    pub fn found_bounds(&self) -> Option<Bounds> {
        self.found
    }

    /// Most vertices that were live at once: the width of the stream.
    pub fn width(&self) -> usize {
        self.rules.live_max()
    }

    /// Number of vertices that have a label.
    pub fn labels(&self) -> u64 {
        self.labels
    }

    /// Number of patches.
    pub fn patches(&self) -> u64 {
        self.patches
    }

    /// Size of the patch with the most simplices.
    pub fn largest_patch(&self) -> PatchSize {
        self.largest_patch
    }

    /// Points before cell tags; in a chunked stream these are the points of single cells.
    pub fn cell_points(&self) -> CellPoints {
        self.cells
    }

    fn patch(&mut self, patch: &Patch) {
        self.extend(patch.new.iter().copied());
        let size = PatchSize {
            simplices: (patch.simplices.len() / self.vertices_per_simplex) as u64,
            new: patch.new.len() as u64,
            imported: patch.imported.len() as u64,
        };
        self.totals.vertices += size.new;
        self.totals.simplices += size.simplices;
        self.patches += 1;
        self.largest_patch = self.largest_patch.max(size);
    }

    fn extend(&mut self, points: impl Iterator<Item = Point>) {
        for point in points {
            self.found.get_or_insert(Bounds::of_point(point)).extend(point);
        }
    }

    fn end_run(&mut self) {
        let run = std::mem::take(&mut self.run);
        if run > 0 {
            self.cells.runs += 1;
            self.cells.points += run;
            self.cells.max = self.cells.max.max(run);
        }
    }
}

/// Counts of segments and of the sides on them.
#[derive(Debug, Default)]
pub struct ConstraintInventory {
    /// Segments.
    pub segments: u64,
    /// Sides of triangles that lie on segments. An edge between two triangles has two.
    pub sides: u64,
    /// Segments that leave the mesh.
    pub open_segments: u64,
    lines: HashSet<u32>,
}

impl ConstraintInventory {
    pub(super) fn event(&mut self, event: &Event) {
        match event {
            Event::Segments(segments) => {
                self.segments += segments.len() as u64;
                self.lines.extend(segments.iter().map(|segment| segment.line));
            }
            Event::Patch(patch) => self.sides += patch.sides.len() as u64,
            Event::OpenSegments(open) => self.open_segments += open.len() as u64,
            _ => {}
        }
    }

    /// Number of different lines that segments belong to.
    pub fn lines(&self) -> u64 {
        self.lines.len() as u64
    }
}

/// Counts of the configurations of one degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DegreeInventory {
    /// The degree.
    pub degree: u32,
    /// What they claim to be.
    pub claim: Claim,
    /// Interior sets.
    pub groups: u64,
    /// Configurations of three knots.
    pub finite: u64,
    /// Configurations of two knots and the faraway point.
    pub infinite: u64,
}

/// Counts of all degrees, gathered block by block.
#[derive(Debug, Default)]
pub struct ConfigurationInventory {
    degrees: Vec<DegreeInventory>,
    last: Option<Vec<u32>>,
}

impl ConfigurationInventory {
    /// Counts by increasing degree.
    pub fn degrees(&self) -> &[DegreeInventory] {
        &self.degrees
    }

    /// Adds a block.
    pub(super) fn block(&mut self, block: &ConfigurationBlock) {
        if self.degrees.last().is_none_or(|last| last.degree != block.degree) {
            let (degree, claim) = (block.degree, block.claim);
            self.degrees.push(DegreeInventory { degree, claim, groups: 0, finite: 0, infinite: 0 });
            self.last = None;
        }
        let Some(inventory) = self.degrees.last_mut() else { return };
        let goes_on = block.groups().next().is_some_and(|(first, _)| self.last.as_deref() == Some(first));
        let infinite = block.boundaries.iter().filter(|boundary| boundary[2] == FARAWAY).count() as u64;
        inventory.groups += block.counts.len() as u64 - u64::from(goes_on);
        inventory.finite += block.boundaries.len() as u64 - infinite;
        inventory.infinite += infinite;
        self.last = block.last_interior().map(<[u32]>::to_vec).or(self.last.take());
    }
}

/// Counts of a stream of four dimensions, gathered event by event.
#[derive(Debug, Default)]
pub struct Inventory4 {
    /// Smallest and largest x, y, z, t.
    pub found_bounds: Option<[Point4; 2]>,
    /// Points whose value is known.
    pub values_known: u64,
    /// Finite cells.
    pub finite: u64,
    /// Finite cells of five vertices.
    pub simplices: u64,
    /// Infinite cells.
    pub infinite: u64,
    /// Most vertices of a cell.
    pub vertices_max: usize,
    /// Most neighbours of a cell.
    pub neighbours_max: usize,
}

impl Inventory4 {
    /// Adds an event with content of four dimensions.
    pub(super) fn event(&mut self, event: &Event) {
        match event {
            Event::Points4(block) => {
                block.points.iter().for_each(|&point| self.extend(point));
                let values = block.values.iter().flatten();
                self.values_known += values.filter(|value| !value.is_nan()).count() as u64;
            }
            Event::Cells4(cells) => {
                for cell in cells.iter() {
                    self.finite += u64::from(!cell.is_infinite);
                    self.simplices += u64::from(!cell.is_infinite && cell.vertices.len() == 5);
                    self.infinite += u64::from(cell.is_infinite);
                    self.vertices_max = self.vertices_max.max(cell.vertices.len());
                    self.neighbours_max = self.neighbours_max.max(cell.neighbours.len());
                }
            }
            _ => {}
        }
    }

    fn extend(&mut self, point: Point4) {
        let [min, max] = self.found_bounds.get_or_insert([point; 2]);
        for axis in 0..4 {
            min[axis] = min[axis].min(point[axis]);
            max[axis] = max[axis].max(point[axis]);
        }
    }
}
