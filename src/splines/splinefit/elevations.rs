//! Points of files as observations of their elevation.

use crate::fitting::{Observation, ObservationReader, Observations};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Input, PointReader};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// The points of files: the elevation is the value, and all weights are one. Units: those of the world.
#[derive(Debug, Clone, Copy)]
pub struct Elevations<'a> {
    input: &'a Input,
}

impl<'a> Elevations<'a> {
    /// Observations of an input in two dimensions.
    ///
    /// # Errors
    /// Points without an elevation.
    pub fn of(input: &'a Input) -> Result<Elevations<'a>> {
        let description = input.description();
        if !description.has_elevation {
            let what = "points have no elevation: splines are fitted to one, in the third column";
            return Err(Error::usage(what).of_input(input.name()));
        }
        Ok(Elevations { input })
    }

    /// Starts a pass that does not borrow this value.
    ///
    /// # Errors
    /// Those of [`Input::read`].
    pub fn into_reader(self) -> Result<Box<dyn ObservationReader + 'a>> {
        let coordinates = self.input.description().coordinates;
        Ok(Box::new(OfInput { reader: self.input.read()?, coordinates, batch: Vec::new() }))
    }
}

impl Observations for Elevations<'_> {
    fn read(&self) -> Result<Box<dyn ObservationReader + '_>> {
        self.into_reader()
    }
}

struct OfInput {
    reader: Box<dyn PointReader>,
    coordinates: Coordinates,
    batch: Vec<Point>,
}

impl ObservationReader for OfInput {
    fn append(&mut self, observations: &mut Vec<Observation>) -> Result<()> {
        self.reader.next_batch(&mut self.batch)?;
        observations.extend(self.batch.iter().map(|&stored| {
            let [x, y, z] = self.coordinates.to_world(stored);
            Observation::new([x, y], z)
        }));
        Ok(())
    }
}
