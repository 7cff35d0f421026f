//! What the z of a drawn point stands for: its elevation, or the value or colour of an attribute.

use super::options::{Fill, Options};
use super::units::Units;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_packed_and_mixed() {
        assert_eq!(unpack(pack([1.0, 255.9, 300.0])), [1, 255, 255]);
        assert_eq!(unpack(mean([pack([0.0, 30.0, 90.0]), pack([3.0; 3]), pack([0.0; 3])])), [1, 11, 31]);
    }
}
