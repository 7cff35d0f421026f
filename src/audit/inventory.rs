//! Counts the content of a stream.

use super::inventory_configurations::ConfigurationInventory;
use super::inventory_constraints::ConstraintInventory;
use super::inventory4::Inventory4;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Event, Header, MemoryRules, Patch, Totals};

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
                self.totals.points += points.len() as u64;
                self.run += points.len() as u64;
            }
            Event::Cells(cells) => {
                self.totals.cells += cells.len() as u64;
                self.end_run();
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
