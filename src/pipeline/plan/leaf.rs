//! The points of one leaf of a plan.

use std::io::Write;

use super::{FileCount, Node, Plan, PlannedFile, Work};
use crate::finalize::{Budget, InRegions, Observer, Passes, Recipe};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{AttributeChoice, Description, PointReader, SourceOptions};
use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter};

/// What a leaf has read.
#[derive(Debug, Default)]
pub(super) struct LeafCounts {
    /// Points of each file in the box.
    pub(super) files: Vec<FileCount>,
    /// Vertices of water in the box, which became points.
    pub(super) added: u64,
    /// Points in the box that were dropped.
    pub(super) dropped: u64,
    /// Messages for the user.
    pub(super) notices: Vec<String>,
}

/// Writes the finalized points of a leaf to `output`. `recipe` is that of the plan.
pub(super) fn write_leaf(
    plan: &Plan,
    node: &Node,
    recipe: Recipe,
    work: &Work,
    mut output: impl Write,
) -> Result<LeafCounts> {
    let files = plan.files_of(node);
    let beside: Vec<&PlannedFile> = plan.beside.iter().collect();
    let check = || files.iter().chain(&beside).try_for_each(|file| file.check(&plan.roots));
    check()?;
    let header = plan.header(Kind::Points)?;
    if files.is_empty() {
        StreamWriter::new(output, Header { points: Some(0), ..header })?.end(0, 0)?;
        return Ok(LeafCounts::default());
    }
    let window = node.region.region();
    let mut recipe = recipe;
    // Polygons are those of the plan, in whatever folder the job runs.
    let polygons = recipe.clip.iter_mut().chain(&mut recipe.drop_inside).chain(&mut recipe.flatten.files);
    polygons.zip(&beside).for_each(|(path, planned)| *path = planned.path(&plan.roots));
    recipe.inputs = files.iter().map(|file| file.path(&plan.roots)).collect();
    recipe.source = SourceOptions {
        attributes: AttributeChoice::of_names(&plan.attributes),
        encoding: Some(plan.coordinates()),
        crs: Some(header.crs.clone()),
        window: Some(window),
        reach: Some(in_world(&window, &plan.coordinates())),
        threads: Some(work.threads),
        temp_dir: work.temp_dir.clone(),
        ..recipe.source
    };
    recipe.line_options.reach = Some(recipe.reach(&in_world(&window, &plan.coordinates())));
    recipe.options.budget = Budget::of_process(work.memory, work.threads.get())?;
    recipe.options.temp_dir.clone_from(&work.temp_dir);
    // A part of a mesh has a residual, which regions do not.
    recipe.options.regions = InRegions::NEVER;
    let input = recipe.open()?;
    let windowed = Windowed::new(&input, &files, &window, header.has_elevation);
    let mut watch = Watch::default();
    recipe.flatten.is_part = true;
    let outcome = recipe.finalize(&windowed, &mut watch, &mut output)?;
    // A file that changed while it was read may look whole.
    check()?;
    let in_box: u64 = input.counts().iter().sum();
    let files = files.iter().zip(input.counts());
    let files = files.map(|(file, &points)| FileCount { file: file.name(), points });
    let added = outcome.lines.points as u64;
    let dropped = in_box - (outcome.stats.points - added);
    Ok(LeafCounts { files: files.collect(), added, dropped, notices: watch.notices })
}

/// The closed box of the world that holds the points of a window.
fn in_world(window: &Region<3>, coordinates: &Coordinates) -> Bounds {
    Bounds { min: coordinates.to_world(window.min), max: coordinates.to_world(window.max) }
}

/// The points of an input that reads one window only, with a check that no file has points outside of the box
/// that it was planned with: no other job would look for them.
struct Windowed<'a> {
    input: &'a dyn Passes,
    files: &'a [&'a PlannedFile],
    description: Description,
}

impl<'a> Windowed<'a> {
    /// The points of `input`, which reads `files` and has a window of its own, the box `window`. Their
    /// elevation is as that of all points of the plan.
    fn new(
        input: &'a dyn Passes,
        files: &'a [&'a PlannedFile],
        window: &Region<3>,
        has_elevation: bool,
    ) -> Self {
        let mut description = input.description().clone();
        let are_whole = matches!(description.coordinates, Coordinates::I32 { .. });
        description.stated_bounds =
            description.stated_bounds.and_then(|bounds| bounds.within(window, are_whole));
        description.has_elevation = has_elevation;
        description.stated_points = None;
        Windowed { input, files, description }
    }
}

impl Passes for Windowed<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(WindowedReader { reader: self.input.read()?, files: self.files }))
    }

    fn source(&self) -> Option<&dyn Passes> {
        Some(self.input)
    }
}

struct WindowedReader<'a> {
    reader: Box<dyn PointReader + 'a>,
    files: &'a [&'a PlannedFile],
}

impl PointReader for WindowedReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        self.reader.next_batch(batch)?;
        let Some(found) = Bounds::of_points(batch) else { return Ok(()) };
        let Some(file) = self.files.get(self.reader.file()) else { return Ok(()) };
        if file.bounds().is_some_and(|bounds| bounds.union(found) == bounds) {
            return Ok(());
        }
        let is_outside = |point: &&Point| !file.bounds().is_some_and(|bounds| bounds.contains(**point));
        let point = batch.iter().find(is_outside).copied().unwrap_or_default();
        let message = format!(
            "point {point:?} (stored coordinates) lies outside of the box that the header states, so that other jobs \
             do not find it: write the file again with a right header, and plan again"
        );
        Err(Error::malformed(message).of_input(file.name()))
    }

    fn rows(&self) -> &[u8] {
        self.reader.rows()
    }

    fn file(&self) -> usize {
        self.reader.file()
    }

    fn invalid(&self) -> u64 {
        self.reader.invalid()
    }
}

/// Keeps notices for the caller.
#[derive(Default)]
struct Watch {
    notices: Vec<String>,
}

impl Observer for Watch {
    fn notice(&mut self, message: &str) {
        self.notices.push(message.to_string());
    }
}
