//! Reads a whole stream of configurations or of a spline.

use std::io::Read;

use crate::model::configurations::Configurations;
use crate::model::functions::Function;
use crate::model::points::Point2;
use crate::{Event, Header, StreamReader};
use spmesh_base::error::{Error, Result};

/// Knots and their configurations, as read from a stream.
#[derive(Debug, Clone, Default)]
pub struct ConfigurationSet {
    /// The knots by id, in stored coordinates.
    pub points: Vec<Point2>,
    /// The z of each knot, if knots have one.
    pub heights: Option<Vec<f64>>,
    /// Configurations, by increasing degree.
    pub degrees: Vec<Configurations>,
    /// Functions that quadratic splines are made of. If the stream lists none, the functions are all
    /// B-splines of links.
    pub functions: Vec<Function>,
    /// Coefficients of functions; empty if the stream holds no spline.
    pub coefficients: Vec<f64>,
}

impl ConfigurationSet {
    /// Reads a stream of kind [`crate::Kind::Configurations`] or [`crate::Kind::Splines`] to its end.
    ///
    /// Memory: the contents of the stream.
    ///
    /// # Errors
    /// Usage, if the stream is of another kind; otherwise as [`StreamReader::next_event`].
    pub fn read<R: Read>(reader: &mut StreamReader<R>) -> Result<Self> {
        let kind = reader.header().kind;
        if !kind.has_knots() {
            let message =
                format!("this is a stream of kind {}, expected configurations or splines", kind.name());
            return Err(Error::usage(message).of_input(reader.name()));
        }
        let mut collector = Collector::new(reader.header());
        while let Some(event) = reader.next_event()? {
            collector.event(&event).map_err(|error| error.of_input(reader.name()))?;
        }
        Ok(collector.finish())
    }
}

/// Collects the contents of events.
#[derive(Debug, Default)]
pub struct Collector {
    points: Vec<Point2>,
    heights: Option<Vec<f64>>,
    degrees: Vec<Configurations>,
    functions: Vec<Function>,
    coefficients: Vec<f64>,
}

impl Collector {
    /// An empty collector for a stream with this header.
    pub fn new(header: &Header) -> Self {
        Collector { heights: header.has_elevation.then(Vec::new), ..Collector::default() }
    }

    /// Adds the next event of a stream of configurations.
    ///
    /// # Errors
    /// Usage, if there are too many configurations.
    pub fn event(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Points(points) => {
                self.points.extend(points.iter().map(|&[x, y, _]| [x, y]));
                if let Some(heights) = &mut self.heights {
                    heights.extend(points.iter().map(|point| point[2]));
                }
            }
            Event::Configurations(block) => {
                let degree = block.degree as usize;
                if self.degrees.last().is_none_or(|last| last.degree() != degree) {
                    self.degrees.push(Configurations::new(degree, block.claim));
                }
                if let Some(last) = self.degrees.last_mut() {
                    block
                        .groups()
                        .try_for_each(|(interior, boundaries)| last.extend(interior, boundaries))?;
                }
            }
            Event::Functions(functions) => self.functions.extend_from_slice(functions),
            Event::Coefficients(coefficients) => self.coefficients.extend_from_slice(coefficients),
            _ => {}
        }
        Ok(())
    }

    /// The set collected so far.
    pub fn finish(self) -> ConfigurationSet {
        let Collector { points, heights, degrees, functions, coefficients } = self;
        ConfigurationSet { points, heights, degrees, functions, coefficients }
    }
}
