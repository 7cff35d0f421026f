//! The points of an input in one box of a plan, which was made from the headers of files.

use super::passes::Passes;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Description, PointReader};
use spmesh_stream::model::bounds::{Bounds, Point, Region};

/// A file as it was planned.
#[derive(Debug, Clone)]
pub struct PlannedBox {
    /// Its name, for messages.
    pub name: String,
    /// The bounding box that its header states; `None` if it states no points.
    pub bounds: Option<Bounds>,
}

/// The points of an input that reads one window only, with a check that no file has points outside of the box that
/// it was planned with: no other job would look for them.
pub struct Windowed<'a, P: Passes + ?Sized> {
    input: &'a P,
    files: &'a [PlannedBox],
    description: Description,
}

impl<'a, P: Passes + ?Sized> Windowed<'a, P> {
    /// The points of `input`, which reads `files` and has a window of its own, the box `window`. Their elevation is
    /// as that of all points of the plan.
    pub fn new(input: &'a P, files: &'a [PlannedBox], window: &Region<3>, has_elevation: bool) -> Self {
        let mut description = input.description().clone();
        let are_whole = matches!(description.coordinates, spmesh_stream::Coordinates::I32 { .. });
        description.stated_bounds =
            description.stated_bounds.and_then(|bounds| bounds.within(window, are_whole));
        description.has_elevation = has_elevation;
        description.stated_points = None;
        Windowed { input, files, description }
    }
}

impl<P: Passes + ?Sized> Passes for Windowed<'_, P> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(WindowedReader { reader: self.input.read()?, files: self.files }))
    }

    fn is_costly(&self) -> bool {
        self.input.is_costly()
    }

    fn name(&self) -> Option<String> {
        self.input.name()
    }
}

struct WindowedReader<'a> {
    reader: Box<dyn PointReader + 'a>,
    files: &'a [PlannedBox],
}

impl PointReader for WindowedReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        self.reader.next_batch(batch)?;
        let Some(found) = Bounds::of_points(batch) else { return Ok(()) };
        let Some(file) = self.files.get(self.reader.file()) else { return Ok(()) };
        if file.bounds.is_some_and(|bounds| bounds.union(found) == bounds) {
            return Ok(());
        }
        let is_outside = |point: &&Point| !file.bounds.is_some_and(|bounds| bounds.contains(**point));
        let point = batch.iter().find(is_outside).copied().unwrap_or_default();
        let message = format!(
            "point {point:?} (stored coordinates) lies outside of the box that the header states, so that other jobs \
             do not find it: write the file again with a right header, and plan again"
        );
        Err(Error::malformed(message).of_input(&file.name))
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
