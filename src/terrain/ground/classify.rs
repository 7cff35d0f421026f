//! The class of a point, by where it is to the surface of the ground.

use std::num::NonZeroUsize;
use std::sync::PoisonError;

use super::Found;
use super::cells::{STEPS, Z_STEPS};
use crate::height::{Heights, Outside, Slopes, Unit};
use spmesh_base::error::Result;
use spmesh_formats::source::Alignment;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// How far below the surface points are low noise, in limits of the ground.
const BELOW: f64 = 2.0;

/// The slope, as rise over run, from which on limits do not grow: points high above would be ground beside
/// cliffs and stumps of walls.
const STEEPEST: f64 = 2.0;

/// Triangles are taken to be at least so long for their slope, in steps of a cell: one and a half cells.
const LEAST_RUN: f64 = 1.5 * STEPS as f64;

/// Roundings of heights, in steps of z: points on two grids of coordinates get the same class.
const NUDGE: f64 = 1e-3;

/// A class of the LAS specification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Neither of the others.
    Other = 1,
    /// On the ground.
    Ground = 2,
    /// Below it.
    LowNoise = 7,
    /// Far above all others, or too high.
    HighNoise = 18,
}

impl Class {
    /// All classes.
    pub const ALL: [Class; 4] = [Class::Other, Class::Ground, Class::LowNoise, Class::HighNoise];

    /// Its place in [`Class::ALL`].
    pub fn number(self) -> usize {
        Class::ALL.iter().position(|other| *other == self).expect("these are all")
    }
}

/// Finds classes, batch by batch.
pub struct Classifier<'f> {
    found: &'f Found,
    alignment: Alignment,
    coordinates: Coordinates,
    heights_above: Heights<'f>,
    placed: Vec<Point>,
    heights: Vec<f64>,
    slopes: Vec<f64>,
    /// [`STEEPEST`] in the units of the points.
    steepest: f64,
}

impl Found {
    /// Prepares to find classes of points with these coordinates on some threads.
    pub fn classifier(&self, coordinates: &Coordinates, threads: NonZeroUsize) -> Classifier<'_> {
        let alignment = Alignment::between(coordinates, self.surface.coordinates());
        let outside = Outside::Within(self.reach);
        let heights_above = Heights::new(&self.surface, Unit::Stored, outside, threads);
        let (placed, heights, slopes) = (Vec::new(), Vec::new(), Vec::new());
        let steepest = STEEPEST * self.metre[1] / self.metre[0];
        Classifier {
            found: self,
            alignment,
            coordinates: *coordinates,
            heights_above,
            placed,
            heights,
            slopes,
            steepest,
        }
    }
}

impl Classifier<'_> {
    /// Replaces `classes` with those of stored points.
    ///
    /// # Errors
    /// If temporary files fail; usage, if a point is too far from the origin.
    pub fn of(&mut self, points: &[Point], classes: &mut Vec<Class>) -> Result<()> {
        self.placed.clear();
        self.placed.extend(points.iter().map(|&point| self.alignment.place(point)));
        let slopes = Slopes::AtPlaces(LEAST_RUN);
        self.heights_above.with_slopes(&self.placed, slopes, &mut self.heights, &mut self.slopes)?;
        let Found { cells, parameters, slope, noise, .. } = self.found;
        let mut noise = noise.lock().unwrap_or_else(PoisonError::into_inner);
        classes.clear();
        for ((point, &height), &stored_slope) in points.iter().zip(&self.heights).zip(&self.slopes) {
            let slope = (stored_slope * slope).min(self.steepest);
            let limit = (parameters.threshold + parameters.scaling * slope) * Z_STEPS + NUDGE;
            classes.push(if height.is_nan() {
                Class::Other
            } else if height < -BELOW * limit {
                Class::LowNoise
            } else if height <= limit {
                Class::Ground
            } else if height > parameters.highest * Z_STEPS + NUDGE
                || noise.is_noise(&cells.place(self.coordinates.to_world(*point))?, cells.size)?
            {
                Class::HighNoise
            } else {
                Class::Other
            });
        }
        Ok(())
    }
}
