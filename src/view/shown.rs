//! What the z of a drawn point stands for: its elevation, or the value or colour of an attribute; and the
//! range of values that colours span.

use super::options::{Fill, Options};
use super::sheet::Units;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attributes, Column};
use spmesh_stream::model::bounds::Point;

/// Colours have 8 bits per component in a picture.
const LEVELS: f64 = 256.0;

/// The attribute that a picture shows instead of elevations.
#[derive(Debug)]
pub(super) enum Shown {
    Elevation,
    Value(Column),
    /// Red, green and blue, and the number that each of them is divided by.
    Colour(Box<[Column; 3]>, f64),
}

impl Shown {
    /// What the options ask for.
    pub(super) fn of(attributes: &Attributes, options: &Options) -> Result<Shown> {
        let Some(choice) = &options.colour_by else { return Ok(Shown::Elevation) };
        let column = |choice: &str| attributes.column(choice).map_err(Error::usage);
        match attributes.find(choice) {
            Some((attribute, _)) if attribute.components == 3 => {
                let parts = [1, 2, 3].map(|component| column(&format!("{choice}:{component}")));
                let [red, green, blue] = parts;
                // Colours of one byte are taken as they are, those of two as LAS has them.
                let divisor = if attribute.number.width() == 1 { 1.0 } else { LEVELS };
                Ok(Shown::Colour(Box::new([red?, green?, blue?]), divisor))
            }
            _ => column(choice).map(Shown::Value),
        }
    }

    /// What is filled with colours, if this decides it.
    pub(super) fn fill(&self) -> Option<Fill> {
        match self {
            Shown::Elevation => None,
            Shown::Value(_) => Some(Fill::Attribute),
            Shown::Colour(..) => Some(Fill::Colour),
        }
    }

    /// The label of the legend.
    pub(super) fn label(&self, units: &Units) -> String {
        match self {
            Shown::Value(column) => column.label(),
            _ => units.elevation(),
        }
    }

    /// A point of the world whose z is what is shown; NaN if it is unknown.
    pub(super) fn place(&self, world: Point, rows: &[u8], point: usize) -> Point {
        let [x, y, z] = world;
        match self {
            Shown::Elevation => [x, y, z],
            Shown::Value(column) => [x, y, column.of(rows, point)],
            Shown::Colour(parts, divisor) => {
                let levels = parts.each_ref().map(|part| part.of(rows, point) / divisor);
                [x, y, pack(levels)]
            }
        }
    }
}

/// A colour as one number.
pub(super) fn pack(levels: [f64; 3]) -> f64 {
    let level = |level: f64| level.floor().clamp(0.0, LEVELS - 1.0);
    levels.into_iter().fold(0.0, |packed, part| packed * LEVELS + level(part))
}

/// The colour of a packed number.
pub(super) fn unpack(packed: f64) -> [u8; 3] {
    let [.., red, green, blue] = (packed.round() as u32).to_be_bytes();
    [red, green, blue]
}

/// The mean of packed colours.
pub(super) fn mean(packed: [f64; 3]) -> f64 {
    let colours = packed.map(unpack);
    let part = |part: usize| colours.iter().map(|colour| f64::from(colour[part])).sum::<f64>() / 3.0;
    pack([0, 1, 2].map(|number| part(number).round()))
}

/// Most samples that percentiles are taken of.
const SAMPLES_MAX: usize = 1 << 18;

/// The percentiles of weighted values: the least values that, with all lesser ones, have these parts of the
/// weight.
/// `None` if there is no weight, or both are the same value.
pub(super) fn percentiles(values: impl Iterator<Item = (f64, f64)>, percents: [f64; 2]) -> Option<[f64; 2]> {
    let mut values: Vec<(f64, f64)> =
        values.filter(|(value, weight)| value.is_finite() && weight.is_finite()).collect();
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let at = |percent: f64| {
        let mut sum = 0.0;
        let found = values.iter().find(|(_, weight)| {
            sum += weight;
            sum >= total * percent / 100.0 && sum > 0.0
        });
        // Rounding may leave the sum below the total.
        found.or(values.last()).map(|(value, _)| *value)
    };
    let [low, high] = percents.map(at);
    low.zip(high).filter(|(low, high)| low < high).map(|(low, high)| [low, high])
}

/// Evenly spaced ones of many values.
pub(super) fn some_of(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    values.iter().copied().step_by(values.len().div_ceil(SAMPLES_MAX).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_packed_and_mixed() {
        assert_eq!(unpack(pack([1.0, 255.9, 300.0])), [1, 255, 255]);
        assert_eq!(unpack(mean([pack([0.0, 30.0, 90.0]), pack([3.0; 3]), pack([0.0; 3])])), [1, 11, 31]);
    }

    #[test]
    fn percentiles_count_weights() {
        let hundred = || (1..=100).rev().map(|value| (f64::from(value), 1.0));
        assert_eq!(percentiles(hundred(), [2.0, 98.0]), Some([2.0, 98.0]));
        assert_eq!(percentiles(hundred(), [0.0, 100.0]), Some([1.0, 100.0]));
        let heavy = [(7.0, 1.0), (5.0, 98.0), (f64::NAN, 9.0), (6.0, 1.0)];
        assert_eq!(percentiles(heavy.into_iter(), [2.0, 98.0]), None);
        assert_eq!(percentiles(heavy.into_iter(), [2.0, 98.5]), Some([5.0, 6.0]));
        assert_eq!(percentiles(std::iter::empty(), [2.0, 98.0]), None);
    }
}
