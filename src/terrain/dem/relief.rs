//! The values of a cell that follow from its elevation and those of its eight neighbours.

use super::options::Quantity;
use crate::files::CELLS;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::colour_map::{BATLOW, lit};
use spmesh_formats::raster::{Gradient, Samples, Shading, TILE};
use spmesh_stream::Header;

/// What is derived, and how.
#[derive(Debug)]
pub(super) struct Derivation {
    quantity: Quantity,
    gradient: Gradient,
    colours: Option<Colours>,
}

/// The colours of a shaded relief.
#[derive(Debug)]
struct Colours {
    shading: Shading,
    /// The elevations that the colours span.
    range: [f64; 2],
    /// The brightness of level ground, which keeps its colour.
    level: f64,
}

impl Derivation {
    /// The derivation of a quantity from the mesh with this header.
    pub(super) fn new(quantity: &Quantity, gradient: Gradient, header: &Header) -> Result<Derivation> {
        let colours = match *quantity {
            Quantity::ShadedRelief(shading, range) => {
                let range = range.map_or_else(|| stated_range(header), Ok)?;
                Some(Colours { shading, range, level: shading.shade([0.0; 2]).clamp(0.05, 0.95) })
            }
            _ => None,
        };
        Ok(Derivation { quantity: quantity.clone(), gradient, colours })
    }

    /// Values of a cell.
    pub(super) fn bands(&self) -> usize {
        if self.colours.is_some() { Samples::Colours.bands() } else { 1 }
    }

    /// Derives a row of a tile from the lines of elevations above, in, and below it, with a cell more at each end. A cell
    /// has no value if it or a neighbour has none, as on the border of the raster. `values` are those of the tile, band
    /// by band.
    pub(super) fn row(&self, lines: [&[f32]; 3], values: &mut [f32], row: usize) -> Result<()> {
        let [above, here, below] = lines.map(|line| line.windows(3));
        for (((cell, above), here), below) in (row * TILE..).zip(above).zip(here).zip(below) {
            let cells: [f32; 9] =
                [above[0], above[1], above[2], here[0], here[1], here[2], below[0], below[1], below[2]];
            let is_known = !cells.iter().any(|cell| cell.is_nan());
            match &self.colours {
                None if is_known => values[cell] = self.quantity.of_cells(&self.gradient, &cells)?,
                Some(colours) if is_known => {
                    let colour = colours.of(f64::from(cells[4]), self.gradient.at(&cells));
                    for (band, value) in colour.into_iter().enumerate() {
                        values[band * CELLS + cell] = value.into();
                    }
                }
                _ => (0..self.bands()).for_each(|band| values[band * CELLS + cell] = f32::NAN),
            }
        }
        Ok(())
    }
}

impl Colours {
    /// Red, green, blue and opacity.
    fn of(&self, elevation: f64, gradient: [f64; 2]) -> [u8; 4] {
        let [low, high] = self.range;
        let part = if high > low { (elevation - low) / (high - low) } else { 0.5 };
        let shade = self.shading.shade(gradient);
        let [red, green, blue] = lit(BATLOW.at(part), shade, self.level);
        [red, green, blue, u8::MAX]
    }
}

/// The least and the greatest elevation that a header states; any, if it states that there are no points.
fn stated_range(header: &Header) -> Result<[f64; 2]> {
    let Some(bounds) = header.bounds else {
        return match header.points {
            Some(0) => Ok([0.0; 2]),
            _ => Err(Error::usage(
                "the header does not say between which elevations the mesh is: give --range",
            )),
        };
    };
    Ok([bounds.min, bounds.max].map(|corner| header.coordinates.to_world(corner)[2]))
}
