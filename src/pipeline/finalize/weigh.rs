//! Weights of points: an attribute `weight` that triangulators understand, made of another attribute.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::passes::{Observer, Pass, Passes};
use spmesh_base::error::{Error, Result};
use spmesh_formats::molecules::Radii;
use spmesh_formats::source::{AttributeChoice, Description, PointReader, SourceOptions};
use spmesh_stream::model::attributes::{Attributes, Column};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Weighted};

/// Numbers that are within so many roundings of a whole number of steps count as one.
const ROUNDINGS: f64 = 4.0;

/// What the weights of points are made of. Values are those of the world.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum WeightSource {
    /// An attribute with weights.
    Weights(String),
    /// An attribute with radii, whose squares are weights, and a length that is added to each.
    Radii {
        /// Its name.
        attribute: String,
        /// The radius of a probe.
        probe: f64,
    },
}

impl WeightSource {
    /// The name of the attribute.
    fn attribute(&self) -> &str {
        match self {
            WeightSource::Weights(attribute) | WeightSource::Radii { attribute, .. } => attribute,
        }
    }

    /// The weight in squared stored units, of which one is `step` long.
    ///
    /// Radii and coordinates that are multiples of one step have whole weights, which are exact.
    fn weight(&self, value: f64, step: f64) -> f64 {
        match self {
            WeightSource::Weights(_) => in_steps(value, step * step),
            WeightSource::Radii { probe, .. } => {
                let radius = in_steps(value, step) + in_steps(*probe, step);
                radius * radius
            }
        }
    }

    /// Whether a value can be one of the attribute.
    fn allows(&self, value: f64) -> bool {
        value.is_finite() && (value >= 0.0 || matches!(self, WeightSource::Weights(_)))
    }

    /// What a value must be, for messages.
    fn expected(&self) -> &'static str {
        match self {
            WeightSource::Weights(_) => "a weight, which is a finite number",
            WeightSource::Radii { .. } => "a radius, which is a finite number from 0 on",
        }
    }
}

/// A length as a number of steps.
fn in_steps(value: f64, step: f64) -> f64 {
    let steps = (value / step).round();
    let is_whole = (steps * step - value).abs() <= ROUNDINGS * f64::EPSILON * value.abs();
    if is_whole && step != 1.0 { steps } else { value / step }
}

/// The attribute that atoms with radii have.
const RADIUS: &str = "radius";

/// What points are weighed by.
#[derive(Debug, Clone)]
pub struct Weighing {
    pub(super) source: WeightSource,
    /// The radii of atoms, if they are looked up.
    radii: Option<Arc<Radii>>,
}

impl Weighing {
    /// By an attribute that holds weights.
    pub fn by_weights(attribute: &str) -> Weighing {
        Weighing { source: WeightSource::Weights(attribute.to_string()), radii: None }
    }

    /// By radii and that of a probe: `name` is that of a table or a file of radii of atoms, or else of an
    /// attribute.
    ///
    /// # Errors
    /// As [`Radii::load`].
    pub fn by_radii(name: &str, probe: f64) -> Result<Weighing> {
        let is_table = Radii::named(name).is_some() || Path::new(name).exists();
        let radii = is_table.then(|| Radii::load(name)).transpose()?.map(|loaded| Arc::new(loaded.radii));
        let attribute = if is_table { RADIUS } else { name }.to_string();
        Ok(Weighing { source: WeightSource::Radii { attribute, probe }, radii })
    }

    /// Lets the attribute be read, beside those that were chosen.
    pub(super) fn enter(&self, source: &mut SourceOptions) {
        source.radii.clone_from(&self.radii);
        let own = self.source.attribute().to_string();
        match &mut source.attributes {
            AttributeChoice::All => {}
            AttributeChoice::Named(names) if names.contains(&own) => {}
            AttributeChoice::Named(names) => names.push(own),
            none => *none = AttributeChoice::Named(vec![own]),
        }
    }
}

/// An input whose points get weights.
pub(super) struct Weighed<'a> {
    input: &'a dyn Passes,
    source: &'a WeightSource,
    column: Column,
    step: f64,
    /// The bytes of a row that the new rows lack: an attribute of the name of weights.
    replaced: Range<usize>,
    description: Description,
}

impl<'a> Weighed<'a> {
    /// Gives the points of `input` weights, whose attribute comes last in their rows. It may take the place
    /// of the one that it is made of.
    ///
    /// # Errors
    /// Usage, if the points lack the attribute of `source`, are points of the plane, or have another
    /// attribute of the name of weights.
    pub(super) fn new(input: &'a dyn Passes, source: &'a WeightSource) -> Result<Self> {
        let description = input.description();
        if description.dims != 3 {
            return Err(Error::usage("weights need points of space: add --octree"));
        }
        let column = description.attributes.column(source.attribute()).map_err(Error::usage)?;
        let own = Weighted::attribute();
        let existing = description.attributes.find(&own.name).map(|(_, place)| place);
        if existing.is_some() && source.attribute() != own.name {
            let remedy = format!("choose others than \"{}\" with --attributes", own.name);
            return Err(Error::usage(format!("the points have this attribute already: {remedy}")));
        }
        let others = description.attributes.iter().filter(|attribute| attribute.name != own.name);
        let all = others.cloned().chain([own.clone()]).collect();
        let attributes = Attributes::new(all).map_err(Error::usage)?;
        let step = match description.coordinates {
            Coordinates::F64 => 1.0,
            Coordinates::I32 { scale, .. } => scale[0],
        };
        let description = Description { attributes, ..description.clone() };
        Ok(Weighed { input, source, column, step, replaced: existing.unwrap_or(0..0), description })
    }

    /// What the header says of the weights. It takes a pass over the points.
    ///
    /// # Errors
    /// Those of the input; malformed, if a value is no weight.
    pub(super) fn weighted(&self, observer: &mut dyn Observer) -> Result<Weighted> {
        let greatest = self.greatest(observer);
        let greatest = greatest.map_err(|error| match self.input.name() {
            Some(name) => error.of_input(name),
            None => error,
        })?;
        Ok(Weighted { greatest: greatest.unwrap_or(0.0) })
    }

    /// The greatest weight; `None` without points.
    fn greatest(&self, observer: &mut dyn Observer) -> Result<Option<f64>> {
        observer.pass(Pass::Weights, self.input.description().stated_points);
        let mut reader = WeighedReader::new(self)?;
        let (mut batch, mut done, mut greatest) = (Vec::new(), 0, None::<f64>);
        loop {
            reader.next_batch(&mut batch)?;
            if batch.is_empty() {
                return Ok(greatest);
            }
            done += batch.len() as u64;
            observer.done(done);
            let heaviest = reader.weights.iter().copied().reduce(f64::max);
            greatest = greatest.into_iter().chain(heaviest).reduce(f64::max);
        }
    }
}

impl Passes for Weighed<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(WeighedReader::new(self)?))
    }

    fn source(&self) -> Option<&dyn Passes> {
        Some(self.input)
    }
}

/// One pass over points that get weights.
struct WeighedReader<'a> {
    reader: Box<dyn PointReader + 'a>,
    source: &'a WeightSource,
    column: &'a Column,
    step: f64,
    row_len: usize,
    replaced: Range<usize>,
    /// Points before the batch.
    done: u64,
    weights: Vec<f64>,
    rows: Vec<u8>,
}

impl<'a> WeighedReader<'a> {
    fn new(weighed: &'a Weighed<'_>) -> Result<Self> {
        let Weighed { input, source, column, step, replaced, .. } = weighed;
        Ok(WeighedReader {
            reader: input.read()?,
            source,
            column,
            step: *step,
            row_len: input.description().attributes.row_len(),
            replaced: replaced.clone(),
            done: 0,
            weights: Vec::new(),
            rows: Vec::new(),
        })
    }
}

impl PointReader for WeighedReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        self.reader.next_batch(batch)?;
        self.weights.clear();
        self.rows.clear();
        let rows = self.reader.rows();
        for (index, row) in (0..batch.len()).zip(rows.chunks_exact(self.row_len)) {
            let value = self.column.of(rows, index);
            let weight = self.source.weight(value, self.step);
            if !(self.source.allows(value) && weight.is_finite()) {
                let message = if self.source.allows(value) {
                    format!("the weight of {value:e} in steps of {:e} is beyond the range of f64", self.step)
                } else {
                    format!("{value}, expected {}", self.source.expected())
                };
                return Err(Error::malformed(message).at(format!("point {}", self.done + index as u64 + 1)));
            }
            self.weights.push(weight);
            self.rows.extend_from_slice(&row[..self.replaced.start]);
            self.rows.extend_from_slice(&row[self.replaced.end..]);
            self.rows.extend_from_slice(&weight.to_le_bytes());
        }
        self.done += batch.len() as u64;
        Ok(())
    }

    fn rows(&self) -> &[u8] {
        &self.rows
    }

    fn invalid(&self) -> u64 {
        self.reader.invalid()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_on_the_grid_have_whole_weights() {
        let radii = |probe: f64| WeightSource::Radii { attribute: "radius".into(), probe };
        for steps in 0..=10_000 {
            // As a file writes it.
            let value: f64 = format!("{}.{:03}", steps / 1000, steps % 1000).parse().expect("a number");
            let whole = f64::from(steps);
            assert_eq!(radii(0.0).weight(value, 0.001), whole * whole);
            assert_eq!(radii(1.4).weight(value, 0.001), (whole + 1400.0) * (whole + 1400.0));
            assert_eq!(radii(0.0).weight(value, 1.0), value * value);
        }
        let weights = WeightSource::Weights("weight".into());
        assert_eq!(weights.weight(-3.5344, 0.001), -3_534_400.0);
        assert_eq!(weights.weight(0.1, 0.03), 0.1 / (0.03 * 0.03));
    }
}
